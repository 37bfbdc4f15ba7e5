#include "content/scene/gltf/document.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "content/error.h"
#include "content/json_limits.h"
#include "content/scene/gltf/limits.h"

namespace probewalk::gltf {
namespace {

using nlohmann::json;

constexpr std::array<std::string_view, 9> kKnownExtensions{
    "EXT_mesh_gpu_instancing",    "EXT_meshopt_compression", "EXT_texture_webp",
    "KHR_draco_mesh_compression", "KHR_lights_punctual",     "KHR_materials_emissive_strength",
    "KHR_materials_unlit",        "KHR_mesh_quantization",   "KHR_texture_transform"};

// The JSON text and the binary chunk of either form of file.
struct Container {
  std::string_view text;
  std::optional<Bytes> binary_chunk;
};

std::uint32_t little_endian32(const Bytes& bytes, std::size_t offset) {
  return bytes[offset] | bytes[offset + 1] << 8 | bytes[offset + 2] << 16 |
         static_cast<std::uint32_t>(bytes[offset + 3]) << 24;
}

Container split_glb(const std::string& file, const Bytes& bytes) {
  constexpr std::size_t kHeaderBytes = 12;
  constexpr std::size_t kChunkHeaderBytes = 8;
  constexpr std::uint32_t kJsonChunk = 0x4E4F534A;
  constexpr std::uint32_t kBinaryChunk = 0x004E4942;
  const auto truncated = [&](std::size_t wanted) {
    return BadInput(fmt::format("{}: cut off, {} bytes where {} are announced; fetch or export it again", file,
                                bytes.size(), wanted));
  };
  if (bytes.size() < kHeaderBytes) throw truncated(kHeaderBytes);
  const std::uint32_t version = little_endian32(bytes, 4);
  if (version != 2)
    throw BadInput(fmt::format("{}: binary glTF version {}; only version 2 can be read", file, version));
  const std::size_t length = little_endian32(bytes, 8);
  if (length > bytes.size()) throw truncated(length);

  Container container;
  std::size_t offset = kHeaderBytes;
  for (int chunk = 0; offset < length; ++chunk) {
    if (length - offset < kChunkHeaderBytes) throw truncated(offset + kChunkHeaderBytes);
    const std::size_t chunk_bytes = little_endian32(bytes, offset);
    const std::uint32_t type = little_endian32(bytes, offset + 4);
    offset += kChunkHeaderBytes;
    if (chunk_bytes > length - offset) throw truncated(offset + chunk_bytes);
    if (chunk == 0 && type != kJsonChunk) throw BadInput(file + ": the first chunk is not JSON; not a glTF file");
    if (chunk == 0) {
      container.text = {reinterpret_cast<const char*>(bytes.data()) + offset, chunk_bytes};
    } else if (type == kBinaryChunk && !container.binary_chunk) {
      container.binary_chunk.emplace(bytes.begin() + static_cast<std::ptrdiff_t>(offset),
                                     bytes.begin() + static_cast<std::ptrdiff_t>(offset + chunk_bytes));
    }
    offset += chunk_bytes;
  }
  return container;
}

Container split(const std::string& file, const Bytes& bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with("glTF")) return split_glb(file, bytes);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos || text[first] != '{') {
    throw BadInput(file + ": neither JSON nor binary glTF; give a .gltf or .glb file");
  }
  return {text, std::nullopt};
}

json parse(const std::string& file, std::string_view text) {
  if (text.size() > kMaxJsonBytes) {
    throw BadInput(fmt::format("{}: {} bytes of JSON, more than the limit of {}", file, text.size(), kMaxJsonBytes));
  }
  const std::string beyond = beyond_json_limits(text, {kMaxJsonValues, kMaxJsonValues, kMaxJsonDepth});
  if (!beyond.empty()) throw BadInput(fmt::format("{}: {}; simplify the scene", file, beyond));
  try {
    json document = json::parse(text);
    if (!document.is_object()) throw BadInput(file + ": the JSON is not an object; not a glTF file");
    return document;
  } catch (const json::exception& error) {
    throw BadInput(fmt::format("{}: damaged JSON ({}); fetch or export it again", file, error.what()));
  }
}

void check_version(const std::string& file, const json& document) {
  const json* asset = find_object(document, "asset");
  const std::string version = asset ? string_member(*asset, "version") : "";
  const std::string needed = asset ? string_member(*asset, "minVersion") : "";
  if (version.empty()) throw BadInput(file + ": no asset.version; not a glTF file");
  if (!version.starts_with("2.") || !(needed.empty() || needed == "2.0")) {
    throw BadInput(fmt::format("{}: glTF version {}; only 2.0 can be read, convert it", file,
                               needed.empty() ? version : needed));
  }
}

std::vector<std::string> unknown_extensions(const json& document, const char* key) {
  std::vector<std::string> unknown;
  const json* names = find_array(document, key);
  if (!names) return unknown;
  for (const json& name : *names) {
    const std::string text = name.is_string() ? name.get<std::string>() : name.dump();
    if (std::find(kKnownExtensions.begin(), kKnownExtensions.end(), text) == kKnownExtensions.end()) {
      unknown.push_back(text);
    }
  }
  return unknown;
}

void check_extensions(Document& document) {
  const std::vector<std::string> required = unknown_extensions(document.json, "extensionsRequired");
  if (!required.empty()) {
    throw BadInput(fmt::format("{}: needs the extension {}, which is not supported; export without it", document.file,
                               fmt::join(required, ", ")));
  }
  const std::vector<std::string> used = unknown_extensions(document.json, "extensionsUsed");
  if (!used.empty()) {
    document.warnings.push_back(fmt::format("extensions without effect here: {}", fmt::join(used, ", ")));
  }
}

void check_counts(const std::string& file, const json& document) {
  const auto check = [&](const char* what, std::size_t count) {
    if (count > kMaxArrayEntries) {
      throw BadInput(fmt::format("{}: {} {}, more than the limit of {}", file, count, what, kMaxArrayEntries));
    }
  };
  for (const char* key : {"accessors", "bufferViews", "buffers", "images", "materials", "meshes", "nodes", "samplers",
                          "scenes", "textures"}) {
    if (const json* array = find_array(document, key)) check(key, array->size());
  }
  std::size_t primitives = 0;
  std::size_t targets = 0;
  if (const json* meshes = find_array(document, "meshes")) {
    for (const json& mesh : *meshes) {
      const json* list = find_array(mesh, "primitives");
      if (!list) continue;
      primitives += list->size();
      for (const json& primitive : *list) {
        if (const json* morph = find_array(primitive, "targets")) targets += morph->size();
      }
    }
  }
  check("primitives", primitives);
  check("morph targets", targets);
}

// A fallback buffer of EXT_meshopt_compression stands for data that only a reader without the extension needs.
bool is_fallback(const json& buffer) {
  const json* extensions = find_object(buffer, "extensions");
  const json* meshopt = extensions ? find_object(*extensions, "EXT_meshopt_compression") : nullptr;
  return meshopt && meshopt->value("fallback", json(false)) == json(true);
}

void read_buffers(Document& document, SourceFiles& files, std::optional<Bytes> binary_chunk) {
  const json* buffers = find_array(document.json, "buffers");
  if (!buffers) return;
  for (std::size_t i = 0; i < buffers->size(); ++i) {
    const json& buffer = (*buffers)[i];
    const std::string uri = string_member(buffer, "uri");
    const auto length = buffer.is_object() ? buffer.find("byteLength") : buffer.end();
    if (!buffer.is_object() || length == buffer.end() || !length->is_number_unsigned()) {
      throw BadInput(fmt::format("{}: buffer {} has no valid byteLength", document.file, i));
    }
    Bytes bytes;
    bool placeholder = false;
    if (!uri.empty()) {
      bytes = files.resolve(uri);
    } else if (i == 0 && binary_chunk) {
      bytes = *std::move(binary_chunk);
    } else if (is_fallback(buffer)) {
      placeholder = true;
    } else {
      throw BadInput(fmt::format("{}: buffer {} has neither a URI nor a binary chunk", document.file, i));
    }
    const auto announced = length->get<std::uint64_t>();
    if (!placeholder && announced > bytes.size()) {
      throw BadInput(fmt::format("{}: buffer {} announces {} bytes but has {}; fetch or export it again", document.file,
                                 i, announced, bytes.size()));
    }
    if (!placeholder) bytes.resize(announced);
    document.buffers.push_back(std::move(bytes));
    document.buffer_is_placeholder.push_back(placeholder);
  }
}

// A missing picture costs its colour, not the scene; what a hostile URI asks for is never opened.
void read_images(Document& document, SourceFiles& files) {
  const json* images = find_array(document.json, "images");
  if (!images) return;
  for (std::size_t i = 0; i < images->size(); ++i) {
    const json& image = (*images)[i];
    const std::string uri = string_member(image, "uri");
    EncodedImage encoded;
    encoded.name = string_member(image, "name");
    if (encoded.name.empty()) encoded.name = uri.starts_with("data:") || uri.empty() ? fmt::format("image {}", i) : uri;
    if (!uri.empty()) {
      const bool refused = !uri.starts_with("data:") && !unsafe_path_reason(uri).empty();
      try {
        encoded.bytes = files.resolve(uri);
      } catch (const BadInput& error) {
        if (refused) throw;
        encoded.problem = error.what();
      }
    } else if (image.is_object() && image.contains("bufferView") && image["bufferView"].is_number_unsigned()) {
      const auto view = image["bufferView"].get<std::uint64_t>();
      encoded.buffer_view = view < kMaxArrayEntries ? static_cast<int>(view) : static_cast<int>(kMaxArrayEntries);
    } else {
      throw BadInput(fmt::format("{}: image {} has neither a URI nor a bufferView", document.file, i));
    }
    document.images.push_back(std::move(encoded));
  }
}

// tinygltf gets what describes the scene and nothing that names a file or that we do not use.
void parse_model(Document& document) {
  json reduced = document.json;
  for (const char* key : {"buffers", "images", "animations", "skins", "cameras"}) reduced.erase(key);
  const std::string text = reduced.dump(-1, ' ', false, json::error_handler_t::replace);
  tinygltf::TinyGLTF loader;
  std::string error;
  std::string warning;
  bool parsed = false;
  try {
    parsed = loader.LoadASCIIFromString(&document.model, &error, &warning, text.data(),
                                        static_cast<unsigned>(text.size()), "", tinygltf::NO_REQUIRE);
  } catch (const std::exception& exception) {
    error = exception.what();
  }
  std::replace(error.begin(), error.end(), '\n', ' ');
  if (!parsed) throw BadInput(fmt::format("{}: not valid glTF: {}", document.file, error));
}

}  // namespace

const json* find_object(const json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto member = object.find(key);
  return member != object.end() && member->is_object() ? &*member : nullptr;
}

const json* find_array(const json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto member = object.find(key);
  return member != object.end() && member->is_array() ? &*member : nullptr;
}

std::string string_member(const json& object, const char* key) {
  if (!object.is_object()) return "";
  const auto member = object.find(key);
  return member != object.end() && member->is_string() ? member->get<std::string>() : "";
}

Document read_document(SourceFiles& files) {
  Document document;
  document.file = files.scene_file().string();
  const Bytes bytes = files.read(files.scene_file(), kMaxFileBytes);
  Container container = split(document.file, bytes);
  document.json = parse(document.file, container.text);
  check_version(document.file, document.json);
  check_extensions(document);
  check_counts(document.file, document.json);
  parse_model(document);
  read_buffers(document, files, std::move(container.binary_chunk));
  read_images(document, files);
  return document;
}

}  // namespace probewalk::gltf
