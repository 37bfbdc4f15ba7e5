#include "content/scene/gltf/instancing.h"

#include <fmt/format.h>

#include <glm/gtc/quaternion.hpp>

#include "content/error.h"
#include "content/scene/gltf/limits.h"

namespace probewalk::gltf {
namespace {

constexpr const char* kInstancing = "EXT_mesh_gpu_instancing";

// The accessor of an attribute, -1 when the extension does without it.
int attribute(const std::string& where, const tinygltf::Value& attributes, const char* name) {
  if (!attributes.Has(name)) return -1;
  const tinygltf::Value& index = attributes.Get(name);
  if (!index.IsInt() || index.GetNumberAsInt() < 0) {
    throw BadInput(fmt::format("{}: {} of {} is no accessor", where, name, kInstancing));
  }
  return index.GetNumberAsInt();
}

}  // namespace

std::vector<glm::dmat4> instance_matrices(const Document& document, int node, Accessors& accessors) {
  const tinygltf::ExtensionMap& extensions = document.model.nodes[node].extensions;
  const auto extension = extensions.find(kInstancing);
  if (extension == extensions.end()) return {glm::dmat4(1.0)};
  const std::string where = fmt::format("{}: node {}", document.file, node);
  if (!extension->second.IsObject() || !extension->second.Get("attributes").IsObject()) {
    throw BadInput(fmt::format("{}: {} has no attributes", where, kInstancing));
  }
  const tinygltf::Value& attributes = extension->second.Get("attributes");
  const int translation = attribute(where, attributes, "TRANSLATION");
  const int rotation = attribute(where, attributes, "ROTATION");
  const int scale = attribute(where, attributes, "SCALE");

  // Attributes of other names (_ID, ...) place nothing: without these three all instances lie on each other.
  std::size_t count = 1;
  bool known = false;
  for (const int accessor : {translation, rotation, scale}) {
    if (accessor < 0) continue;
    if (known && accessors.count(accessor) != count) {
      throw BadInput(fmt::format("{}: {} has {} and {} instances in its attributes", where, kInstancing, count,
                                 accessors.count(accessor)));
    }
    count = accessors.count(accessor);
    known = true;
  }
  if (count > kMaxInstances) {
    throw BadInput(fmt::format("{}: {} instances, more than the limit of {}", where, count, kMaxInstances));
  }

  std::vector<glm::dmat4> matrices(count, glm::dmat4(1.0));
  if (translation >= 0) {
    const std::vector<float> values = accessors.floats(translation, 3);
    for (std::size_t i = 0; i < count; ++i) {
      matrices[i][3] = glm::dvec4(values[3 * i], values[3 * i + 1], values[3 * i + 2], 1.0);
    }
  }
  if (rotation >= 0) {
    const std::vector<float> values = accessors.floats(rotation, 4);
    for (std::size_t i = 0; i < count; ++i) {
      const float* q = &values[4 * i];
      const glm::dquat turn(q[3], q[0], q[1], q[2]);
      // Quantised quaternions are not of unit length.
      const double length = glm::length(turn);
      if (length > 0.0) matrices[i] *= glm::mat4_cast(turn / length);
    }
  }
  if (scale >= 0) {
    const std::vector<float> values = accessors.floats(scale, 3);
    for (std::size_t i = 0; i < count; ++i) {
      for (int c = 0; c < 3; ++c) matrices[i][c] *= static_cast<double>(values[3 * i + static_cast<std::size_t>(c)]);
    }
  }
  return matrices;
}

}  // namespace probewalk::gltf
