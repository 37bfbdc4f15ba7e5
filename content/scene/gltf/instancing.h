// EXT_mesh_gpu_instancing: one node that shows its mesh in many places.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "content/scene/gltf/accessors.h"

namespace probewalk::gltf {

// Node-from-instance matrices, in the order of the file; one identity for a node without the extension. Throws BadInput
// when its accessors differ in count or there are more than kMaxInstances.
std::vector<glm::dmat4> instance_matrices(const Document& document, int node, Accessors& accessors);

}  // namespace probewalk::gltf
