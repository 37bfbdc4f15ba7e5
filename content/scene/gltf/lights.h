// KHR_lights_punctual.
#pragma once

#include <vector>

#include "content/scene/gltf/nodes.h"
#include "content/scene/scene.h"

namespace probewalk::gltf {

// Appends to scene.lights, in file units.
void import_lights(const Document& document, const std::vector<NodeInstance>& nodes, Scene& scene);

}  // namespace probewalk::gltf
