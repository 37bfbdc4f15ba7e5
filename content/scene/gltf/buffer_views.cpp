#include "content/scene/gltf/buffer_views.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <cmath>

#include "content/error.h"
#include "content/scene/gltf/limits.h"

namespace probewalk::gltf {
namespace {

constexpr const char* kMeshopt = "EXT_meshopt_compression";
// The codecs spend at least one byte on 64 bytes of output; more is a lie about the size.
constexpr std::uint64_t kMaxExpansion = 256;

enum class Mode { kAttributes, kTriangles, kIndices };

// Non-negative integer member of an extension object, or `fallback` when absent.
std::uint64_t integer(const std::string& where, const tinygltf::Value& object, const char* key,
                      std::optional<std::uint64_t> fallback = std::nullopt) {
  if (!object.Has(key) && fallback) return *fallback;
  const double value = object.Has(key) && object.Get(key).IsNumber() ? object.Get(key).GetNumberAsDouble() : -1.0;
  if (!(value >= 0.0 && value < 9e15) || std::floor(value) != value) {
    throw BadInput(fmt::format("{}: {}.{} is not a valid number", where, kMeshopt, key));
  }
  return static_cast<std::uint64_t>(value);
}

std::string text(const tinygltf::Value& object, const char* key, const char* fallback) {
  return object.Has(key) && object.Get(key).IsString() ? object.Get(key).Get<std::string>() : fallback;
}

Mode parse_mode(const std::string& where, const std::string& name) {
  if (name == "ATTRIBUTES") return Mode::kAttributes;
  if (name == "TRIANGLES") return Mode::kTriangles;
  if (name == "INDICES") return Mode::kIndices;
  throw BadInput(fmt::format("{}: {} mode '{}' is unknown", where, kMeshopt, name));
}

// The decoders assert what the extension demands of strides and counts, so it is checked before.
void check_layout(const std::string& where, Mode mode, const std::string& filter, std::uint64_t count,
                  std::uint64_t stride) {
  bool valid = stride > 0;
  if (mode == Mode::kAttributes) valid = valid && stride % 4 == 0 && stride <= 256;
  if (mode == Mode::kTriangles) valid = (stride == 2 || stride == 4) && count % 3 == 0;
  if (mode == Mode::kIndices) valid = stride == 2 || stride == 4;
  if (filter == "OCTAHEDRAL") valid = valid && (stride == 4 || stride == 8);
  if (filter == "QUATERNION") valid = valid && stride == 8;
  if (filter != "NONE" && mode != Mode::kAttributes) valid = false;
  if (!valid) {
    throw BadInput(fmt::format("{}: {} with stride {}, count {}, filter {} is not allowed", where, kMeshopt, stride,
                               count, filter));
  }
}

void apply_filter(const std::string& where, const std::string& filter, Bytes& bytes, std::size_t count,
                  std::size_t stride) {
  if (filter == "OCTAHEDRAL") {
    meshopt_decodeFilterOct(bytes.data(), count, stride);
  } else if (filter == "QUATERNION") {
    meshopt_decodeFilterQuat(bytes.data(), count, stride);
  } else if (filter == "EXPONENTIAL") {
    meshopt_decodeFilterExp(bytes.data(), count, stride);
  } else if (filter != "NONE") {
    throw BadInput(fmt::format("{}: {} filter '{}' is unknown", where, kMeshopt, filter));
  }
}

}  // namespace

std::span<const std::uint8_t> BufferViews::slice(int view, int buffer, std::uint64_t offset,
                                                 std::uint64_t length) const {
  if (buffer < 0 || static_cast<std::size_t>(buffer) >= document_.buffers.size()) {
    throw BadInput(fmt::format("{}: bufferView {} refers to buffer {}, which does not exist", document_.file, view,
                               buffer));
  }
  if (document_.buffer_is_placeholder[buffer]) {
    throw BadInput(
        fmt::format("{}: bufferView {} refers to buffer {}, which has no data", document_.file, view, buffer));
  }
  const Bytes& bytes = document_.buffers[buffer];
  if (offset > bytes.size() || length > bytes.size() - offset) {
    throw BadInput(fmt::format("{}: bufferView {} (offset {}, {} bytes) leaves buffer {} of {} bytes", document_.file,
                               view, offset, length, buffer, bytes.size()));
  }
  return std::span(bytes).subspan(offset, length);
}

std::span<const std::uint8_t> BufferViews::bytes(int view) {
  if (view < 0 || static_cast<std::size_t>(view) >= document_.model.bufferViews.size()) {
    throw BadInput(fmt::format("{}: bufferView {} does not exist", document_.file, view));
  }
  const tinygltf::BufferView& description = document_.model.bufferViews[view];
  const auto extension = description.extensions.find(kMeshopt);
  if (extension == description.extensions.end() || !extension->second.IsObject()) {
    return slice(view, description.buffer, description.byteOffset, description.byteLength);
  }
  const auto known = decoded_.find(view);
  if (known != decoded_.end()) return known->second;
  return decoded_.emplace(view, decode(view, extension->second)).first->second;
}

Bytes BufferViews::decode(int view, const tinygltf::Value& extension) {
  const std::string where = fmt::format("{}: bufferView {}", document_.file, view);
  const std::uint64_t count = integer(where, extension, "count");
  const std::uint64_t stride = integer(where, extension, "byteStride");
  const Mode mode = parse_mode(where, text(extension, "mode", ""));
  const std::string filter = text(extension, "filter", "NONE");
  check_layout(where, mode, filter, count, stride);

  const std::span<const std::uint8_t> packed =
      slice(view, static_cast<int>(std::min<std::uint64_t>(integer(where, extension, "buffer"), kMaxArrayEntries)),
            integer(where, extension, "byteOffset", 0), integer(where, extension, "byteLength"));
  if (count > kMaxAccessorElements || count * stride > packed.size() * kMaxExpansion) {
    throw BadInput(fmt::format("{}: {} announces {} x {} bytes from {}; the file is damaged", where, kMeshopt, count,
                               stride, packed.size()));
  }
  decoded_bytes_ += count * stride;
  if (decoded_bytes_ > kMaxDecodedBytes) {
    throw BadInput(fmt::format("{}: more than {} bytes decoded", where, kMaxDecodedBytes));
  }

  Bytes bytes(count * stride);
  int result = 0;
  switch (mode) {
    case Mode::kAttributes:
      result = meshopt_decodeVertexBuffer(bytes.data(), count, stride, packed.data(), packed.size());
      break;
    case Mode::kTriangles:
      result = meshopt_decodeIndexBuffer(bytes.data(), count, stride, packed.data(), packed.size());
      break;
    case Mode::kIndices:
      result = meshopt_decodeIndexSequence(bytes.data(), count, stride, packed.data(), packed.size());
      break;
  }
  if (result != 0) throw BadInput(fmt::format("{}: damaged {} data; fetch or export it again", where, kMeshopt));
  apply_filter(where, filter, bytes, count, stride);
  return bytes;
}

}  // namespace probewalk::gltf
