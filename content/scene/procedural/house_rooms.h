// What stands in the rooms of the sample house, and its courtyard.
#pragma once

#include "content/scene/procedural/house_plan.h"

namespace probewalk::procedural {

void furnish_ground_floor(Model& model, const Palette& p);
void furnish_upper_floor(Model& model, const Palette& p);
void build_courtyard(Model& model, const Palette& p);

}  // namespace probewalk::procedural
