#include "content/scene/gltf/primitives.h"

#include <fmt/format.h>

#include <algorithm>

#include "content/error.h"
#include "content/scene/gltf/limits.h"

namespace probewalk::gltf {
namespace {

constexpr const char* kDraco = "KHR_draco_mesh_compression";

// The extension's object of a primitive, or nullptr.
const tinygltf::Value* draco_extension(const tinygltf::Primitive& primitive) {
  const auto extension = primitive.extensions.find(kDraco);
  return extension != primitive.extensions.end() && extension->second.IsObject() ? &extension->second : nullptr;
}

// Corners of strips and fans as those of single triangles; odd ones of a strip turn, so that all face the same way.
std::vector<std::uint32_t> triangle_list(int mode, std::vector<std::uint32_t> corners) {
  if (mode < 0 || mode == TINYGLTF_MODE_TRIANGLES) {
    corners.resize(corners.size() / 3 * 3);
    return corners;
  }
  std::vector<std::uint32_t> list;
  for (std::size_t i = 2; i < corners.size(); ++i) {
    if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
      list.insert(list.end(), {corners[0], corners[i - 1], corners[i]});
    } else if (i % 2 == 0) {
      list.insert(list.end(), {corners[i - 2], corners[i - 1], corners[i]});
    } else {
      list.insert(list.end(), {corners[i - 1], corners[i - 2], corners[i]});
    }
  }
  return list;
}

void transform_uvs(std::vector<float>& uvs, const glm::dmat3& transform) {
  if (transform == glm::dmat3(1.0)) return;
  for (std::size_t i = 0; i + 1 < uvs.size(); i += 2) {
    const glm::dvec3 uv = transform * glm::dvec3(uvs[i], uvs[i + 1], 1.0);
    uvs[i] = static_cast<float>(uv.x);
    uvs[i + 1] = static_cast<float>(uv.y);
  }
}

}  // namespace

int attribute(const tinygltf::Primitive& primitive, const std::string& name) {
  const auto found = primitive.attributes.find(name);
  return found == primitive.attributes.end() ? -1 : found->second;
}

PrimitiveReader::PrimitiveReader(const Document& document, BufferViews& views, Accessors& accessors,
                                 std::vector<std::string>& warnings)
    : document_(document), accessors_(accessors), draco_(document, views), warnings_(warnings) {
  const std::vector<std::string>& required = document.model.extensionsRequired;
  draco_required_ = std::find(required.begin(), required.end(), kDraco) != required.end();
}

bool PrimitiveReader::has_fallback(const tinygltf::Primitive& primitive) const {
  if (draco_required_) return false;
  std::vector<int> needed{attribute(primitive, "POSITION")};
  if (primitive.indices >= 0) needed.push_back(primitive.indices);
  return std::all_of(needed.begin(), needed.end(), [&](int accessor) { return accessors_.has_data(accessor); });
}

// The decoded mesh of a primitive, nullptr when its accessors are to be read.
const DracoMesh* PrimitiveReader::compressed(const std::string& where, const tinygltf::Primitive& primitive) {
  const tinygltf::Value* extension = draco_extension(primitive);
  if (!extension) return nullptr;
  const tinygltf::Value& view = extension->Get("bufferView");
  if (!view.IsInt() || !extension->Get("attributes").IsObject()) {
    throw BadInput(fmt::format("{}: {} lacks its bufferView or attributes", where, kDraco));
  }
  try {
    return &draco_.mesh(view.GetNumberAsInt());
  } catch (const BadInput& error) {
    if (!has_fallback(primitive)) throw;
    if (damaged_views_.insert(view.GetNumberAsInt()).second) {
      warnings_.push_back(fmt::format("{}; its uncompressed form is used", error.what()));
    }
    return nullptr;
  }
}

// Values of an attribute from where they are; empty when the primitive has no such attribute.
std::vector<float> PrimitiveReader::floats(const std::string& where, const tinygltf::Primitive& primitive,
                                           const DracoMesh* mesh, const std::string& name, int components) {
  const int accessor = attribute(primitive, name);
  if (accessor < 0) return {};
  const tinygltf::Value* ids = mesh ? &draco_extension(primitive)->Get("attributes") : nullptr;
  if (!ids || !ids->Has(name)) return accessors_.floats(accessor, components);
  const tinygltf::Value& id = ids->Get(name);
  std::string problem = "has an id that is no number";
  std::vector<float> values;
  if (id.IsInt() && id.GetNumberAsInt() >= 0) {
    problem.clear();
    values = mesh->floats(static_cast<std::uint32_t>(id.GetNumberAsInt()), components, accessors_.normalized(accessor),
                          problem);
  }
  if (!problem.empty()) throw BadInput(fmt::format("{}: the Draco stream of {} {}", where, name, problem));
  return values;
}

std::vector<std::uint32_t> PrimitiveReader::corners(const std::string& where, const tinygltf::Primitive& primitive,
                                                    const DracoMesh* mesh, std::size_t vertex_count) {
  // A stream holds single triangles whatever the mode says, and its decoder has checked them.
  if (mesh) return mesh->corners;
  std::vector<std::uint32_t> corners;
  if (primitive.indices >= 0) {
    corners = accessors_.indices(primitive.indices);
  } else {
    corners.resize(vertex_count);
    for (std::size_t i = 0; i < vertex_count; ++i) corners[i] = static_cast<std::uint32_t>(i);
  }
  for (const std::uint32_t corner : corners) {
    if (corner >= vertex_count) {
      throw BadInput(
          fmt::format("{}: an index refers to vertex {} of {}; export it again", where, corner, vertex_count));
    }
  }
  return triangle_list(primitive.mode, std::move(corners));
}

PrimitiveData PrimitiveReader::read(const std::string& where, const tinygltf::Primitive& primitive,
                                    const UvSources& sources) {
  const DracoMesh* mesh = compressed(where, primitive);
  PrimitiveData data;
  Vertices& vertices = data.vertices;
  vertices.positions = floats(where, primitive, mesh, "POSITION", 3);
  const auto read_equal = [&](const std::string& name, int components) {
    std::vector<float> values = floats(where, primitive, mesh, name, components);
    const std::size_t count = values.size() / static_cast<std::size_t>(components);
    if (attribute(primitive, name) >= 0 && count != vertices.count()) {
      throw BadInput(
          fmt::format("{}: {} positions but {} of {}; export it again", where, vertices.count(), count, name));
    }
    return values;
  };
  vertices.normals = read_equal("NORMAL", 3);
  for (int slot = 0; slot < 2; ++slot) {
    // The second slot exists for emission that is mapped differently; without that it would only cost memory.
    if (slot == 1 && sources[1] == sources[0]) continue;
    vertices.uvs[slot] = read_equal(fmt::format("TEXCOORD_{}", sources[slot].set), 2);
    transform_uvs(vertices.uvs[slot], sources[slot].transform);
  }
  data.corners = corners(where, primitive, mesh, vertices.count());
  return data;
}

}  // namespace probewalk::gltf
