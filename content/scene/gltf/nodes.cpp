#include "content/scene/gltf/nodes.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>

#include "content/error.h"
#include "content/scene/gltf/limits.h"

namespace probewalk::gltf {
namespace {

glm::dmat4 local_matrix(const std::string& file, int index, const tinygltf::Node& node) {
  const auto check = [&](const std::vector<double>& values, std::size_t size, const char* what) {
    if (!values.empty() && values.size() != size) {
      throw BadInput(fmt::format("{}: node {} has a {} of {} numbers instead of {}", file, index, what, values.size(),
                                 size));
    }
    return !values.empty();
  };
  if (check(node.matrix, 16, "matrix")) return glm::make_mat4(node.matrix.data());
  glm::dmat4 matrix(1.0);
  if (check(node.translation, 3, "translation")) matrix[3] = glm::dvec4(glm::make_vec3(node.translation.data()), 1.0);
  if (check(node.rotation, 4, "rotation")) {
    const glm::dquat rotation(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
    const double length = glm::length(rotation);
    if (length > 0.0) matrix *= glm::mat4_cast(rotation / length);
  }
  if (check(node.scale, 3, "scale")) {
    for (int c = 0; c < 3; ++c) matrix[c] *= node.scale[c];
  }
  return matrix;
}

int default_scene(const Document& document) {
  const int count = static_cast<int>(document.model.scenes.size());
  if (count == 0) return -1;
  const int chosen = std::max(document.model.defaultScene, 0);
  if (chosen >= count) {
    throw BadInput(fmt::format("{}: scene {} does not exist, there are {}", document.file, chosen, count));
  }
  return chosen;
}

std::vector<int> root_nodes(const Document& document) {
  const int scene = default_scene(document);
  if (scene >= 0) return document.model.scenes[scene].nodes;
  std::vector<bool> is_child(document.model.nodes.size(), false);
  for (const tinygltf::Node& node : document.model.nodes) {
    for (const int child : node.children) {
      if (child >= 0 && static_cast<std::size_t>(child) < is_child.size()) is_child[child] = true;
    }
  }
  std::vector<int> roots;
  for (std::size_t i = 0; i < is_child.size(); ++i) {
    if (!is_child[i]) roots.push_back(static_cast<int>(i));
  }
  return roots;
}

}  // namespace

std::vector<NodeInstance> flatten_nodes(const Document& document) {
  const std::vector<tinygltf::Node>& nodes = document.model.nodes;
  std::vector<NodeInstance> result;
  struct Pending {
    NodeInstance instance;
    std::size_t depth;
  };
  std::vector<Pending> pending;
  std::vector<bool> reached(nodes.size(), false);
  const auto push = [&](const std::vector<int>& children, const glm::dmat4& world_from_parent, std::size_t depth) {
    if (!children.empty() && depth > kMaxNodeDepth) {
      throw BadInput(fmt::format("{}: node {} lies more than {} nodes below a root; flatten its hierarchy",
                                 document.file, children.front(), kMaxNodeDepth));
    }
    for (auto child = children.rbegin(); child != children.rend(); ++child) {
      if (*child < 0 || static_cast<std::size_t>(*child) >= nodes.size()) {
        throw BadInput(fmt::format("{}: node {} does not exist, there are {}", document.file, *child, nodes.size()));
      }
      if (reached[*child]) {
        throw BadInput(fmt::format("{}: node {} is reached twice; nodes must form trees", document.file, *child));
      }
      reached[*child] = true;
      pending.push_back({{*child, world_from_parent * local_matrix(document.file, *child, nodes[*child])}, depth});
    }
  };
  push(root_nodes(document), glm::dmat4(1.0), 0);
  while (!pending.empty()) {
    const Pending next = pending.back();
    pending.pop_back();
    result.push_back(next.instance);
    push(nodes[next.instance.node].children, next.instance.world_from_node, next.depth + 1);
  }
  return result;
}

const nlohmann::json* scene_json(const Document& document) {
  const int scene = default_scene(document);
  const nlohmann::json* scenes = find_array(document.json, "scenes");
  return scenes && scene >= 0 && static_cast<std::size_t>(scene) < scenes->size() ? &(*scenes)[scene] : nullptr;
}

}  // namespace probewalk::gltf
