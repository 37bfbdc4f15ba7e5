// Trees, potted plants and hedges: alpha-tested leaves on real wood.
#pragma once

#include <cstdint>

#include "content/scene/procedural/brush.h"
#include "content/scene/procedural/palette.h"

namespace probewalk::procedural {

struct TreeShape {
  double height_m = 5.0;
  double trunk_radius_m = 0.13;
  int leaves = 3000;     // quads, each a twig of several leaves
  double leaf_m = 0.22;  // edge of a quad
  std::uint32_t seed = 1;
};

// Standing on y = 0 of the brush's frame.
void draw_tree(Brush brush, const Palette& p, MaterialId leaf, const TreeShape& shape);
void draw_potted_plant(Brush brush, const Palette& p, MaterialId pot, double height_m, std::uint32_t seed);
void draw_bush(Brush brush, const Palette& p, MaterialId leaf, glm::dvec3 size_m, int leaves,
               std::uint32_t seed);
void draw_grass_tufts(Brush brush, const Palette& p, double width_m, double depth_m, int tufts,
                      std::uint32_t seed);

}  // namespace probewalk::procedural
