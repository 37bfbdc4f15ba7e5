// What the small scenes share: a few plain colours, a closed room of six faces, a lamp.
#pragma once

#include <cstdint>

#include "content/scene/procedural/brush.h"

namespace probewalk::procedural {

struct PlainColours {
  MaterialId floor, wall, red_wall, green_wall, ceiling, thing, lamp;
};

MaterialId add_plain(Model& model, const char* name, std::uint32_t color);
PlainColours add_plain_colours(Model& model);

// Inner faces of a box, one quad each: the plainest closed room.
void draw_plain_room(Brush brush, const PlainColours& c, glm::dvec3 lo, glm::dvec3 hi);

// A point light of the small scenes' warm white.
void add_point_light(Model& model, glm::dvec3 position_m, double candela);

}  // namespace probewalk::procedural
