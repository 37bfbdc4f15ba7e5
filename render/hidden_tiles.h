// Which tiles of a view nobody can see through a headset's optics. Numbers only, no device.
#pragma once

#include <volk.h>

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace probewalk {

// What is hidden of a view: triangles on the plane one metre along its axis, x to the right, y up. Without triangles
// nothing is hidden.
struct HiddenMesh {
  std::vector<glm::vec2> vertices;
  std::vector<std::uint32_t> indices;  // three a triangle, whichever way round; those beyond the vertices are ignored
};

inline constexpr int kHiddenTile_px = 8;

// One entry a tile, row-major, 1 = hidden: wholly, with so many pixels around it (what visible pixels are made of lies
// that near). tan_angles: left, right, up, down, as in ViewConstants.
std::vector<std::uint8_t> hidden_tiles(const HiddenMesh& mesh, glm::vec4 tan_angles, VkExtent2D extent_px,
                                       int margin_px);

// As the shaders read them (shaders/hidden_tiles.glsl).
std::vector<std::uint32_t> hidden_tile_words(std::span<const std::vector<std::uint8_t>> views);

}  // namespace probewalk
