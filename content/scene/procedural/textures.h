// The pictures on the surfaces of the test scenes: woods, stones, cloths, leaves.
#pragma once

#include <cstdint>
#include <string>

#include "content/scene/procedural/model.h"

namespace probewalk::procedural {

// All tile in both directions unless said otherwise. Colours are given as sRGB, 0xRRGGBB.
ModelTexture plank_floor_texture(std::uint32_t light, std::uint32_t dark);  // 10 planks across, u along them
ModelTexture wood_texture(const std::string& name, std::uint32_t light, std::uint32_t dark);  // grain along u
ModelTexture plaster_texture();  // near white, to be tinted
ModelTexture cloth_texture();    // near white weave, to be tinted
ModelTexture tile_texture(const std::string& name, std::uint32_t glaze, std::uint32_t grout, int columns,
                          int rows);
ModelTexture stone_floor_texture();  // 2 x 2 large flags
ModelTexture paving_texture();       // rows of slabs of different length
ModelTexture brick_texture();        // 4 x 12 bricks, running bond
ModelTexture grass_texture();
ModelTexture bark_texture();
ModelTexture marble_texture();
ModelTexture knot_rug_texture(const std::string& name, std::uint32_t ground, std::uint32_t figure,
                              std::uint32_t accent);  // one whole rug
ModelTexture stripe_rug_texture();                    // one whole rug
ModelTexture blanket_texture(std::uint32_t ground, std::uint32_t line);
ModelTexture leaf_texture();         // a twig of leaves with alpha; one whole picture
ModelTexture book_spines_texture();  // a row of kBookColours colours, to be picked by box_of_colour
inline constexpr int kBookColours = 16;

// Four paintings: hills at dusk, blocks of colour, a plant study, a sea with a low sun. Each a whole picture.
inline constexpr int kPaintings = 4;
ModelTexture painting_texture(int which);

}  // namespace probewalk::procedural
