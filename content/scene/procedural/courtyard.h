// The parts of the courtyard scene: the building around it, and what stands in it.
#pragma once

#include "content/scene/procedural/palette.h"

namespace probewalk::procedural::courtyard {

// The open yard in the middle; around it an arcade, above that a gallery under a roof. x runs east, z south.
inline constexpr double kYardX_m = 6.0, kYardZ_m = 5.0;    // half its sides
inline constexpr double kWalk_m = 2.6;                     // depth of the arcade
inline constexpr double kBay_m = 2.0;                      // from column to column
inline constexpr double kSpring_m = 2.15, kBand_m = 3.35;  // arches spring here, their wall ends there
inline constexpr double kGallery_m = 3.6;                  // the gallery's floor
inline constexpr double kEaves_m = 6.1, kRoofTop_m = 7.3;

void build(Model& model, const Palette& p);
void furnish(Model& model, const Palette& p);

}  // namespace probewalk::procedural::courtyard
