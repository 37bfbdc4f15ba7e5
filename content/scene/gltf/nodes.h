// The node tree, flattened.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "content/scene/gltf/document.h"

namespace probewalk::gltf {

struct NodeInstance {
  int node = 0;                       // index into model.nodes
  glm::dmat4 world_from_node{1.0};    // file units
};

// All nodes of the default scene (else the first, else all roots), parents before children, in document order.
// Throws BadInput when nodes form a loop, share a child, refer to what does not exist, or lie deeper than
// kMaxNodeDepth.
std::vector<NodeInstance> flatten_nodes(const Document& document);

// The JSON of the scene that flatten_nodes walks, or nullptr.
const nlohmann::json* scene_json(const Document& document);

}  // namespace probewalk::gltf
