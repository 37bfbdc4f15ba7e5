// The sample house's materials, by what they are used for.
#pragma once

#include <array>

#include "content/scene/procedural/model.h"
#include "content/scene/procedural/textures.h"

namespace probewalk::procedural {

struct Palette {
  // Shell
  MaterialId plaster_white, plaster_sand, plaster_sage, plaster_blue, plaster_clay, plaster_outside, ceiling;
  MaterialId oak_floor, stone_floor, bath_floor, bath_wall, kitchen_wall, paving, grass, brick, earth, water;
  // Woodwork and metal
  MaterialId oak, walnut, walnut_glossy, trim, window_frame, door, black_metal, brass, chrome;
  // Cloth
  MaterialId linen, cushion_rust, cushion_teal, sofa_cloth, armchair_cloth, bedding, blanket_blue,
      blanket_check, curtain, leather;
  MaterialId rug_living, rug_library, rug_bedroom, rug_hall;
  // Things
  MaterialId ceramic, ceramic_dark, terracotta, marble, counter_front, counter_top, black_glass, books, paper,
      fruit_orange, fruit_green;
  MaterialId leaf, leaf_dark, leaf_olive, bark, toy_red, toy_yellow, toy_blue;
  // Light
  MaterialId lamp_shade, lamp_globe, ceiling_lamp, embers;
  std::array<MaterialId, kPaintings> paintings;
};

Palette make_palette(Model& model);

}  // namespace probewalk::procedural
