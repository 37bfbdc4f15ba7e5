// Writes a Model as one glTF 2.0 binary file, pictures inside.
#pragma once

#include <cstddef>
#include <vector>

#include "content/scene/procedural/model.h"

namespace probewalk::procedural {

// One node per object, light and room. Sky and start are `extras` of the scene (probewalk_sky,
// probewalk_start), rooms are `extras` of their nodes (probewalk_room, probewalk_room_min,
// probewalk_room_max).
std::vector<std::byte> write_glb(const Model& model);

}  // namespace probewalk::procedural
