// The models behind the names in procedural.h.
#pragma once

#include "content/scene/procedural/model.h"

namespace probewalk::procedural {

Model make_house();
Model make_box_room();
Model make_two_rooms();
Model make_lattice();
Model make_grove();

}  // namespace probewalk::procedural
