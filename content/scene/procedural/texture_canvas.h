// A picture that is filled by a function of the texture coordinate, and the tileable noise to fill it with.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <string>

#include "content/scene/procedural/model.h"

namespace probewalk::procedural {

// A pseudo-random number in [0, 1) of two integers and a seed; the same everywhere.
double hash01(std::int64_t x, std::int64_t y, std::uint32_t seed);

// Smooth value noise in [0, 1] with one random value per integer point, repeating after `period` points.
double value_noise(glm::dvec2 p, glm::ivec2 period, std::uint32_t seed);
// Octaves of value noise, each twice as fine and half as strong; in [0, 1]. Repeats like its first octave.
double fractal_noise(glm::dvec2 p, glm::ivec2 period, int octaves, std::uint32_t seed);

// Colour as painters name it, sRGB-encoded, components in [0, 1].
glm::dvec3 paint(std::uint32_t rgb);

// Fills a picture: colour (sRGB-encoded, clamped) at the texel centre uv in [0, 1]^2, v downwards.
ModelTexture fill(const std::string& name, int width_px, int height_px,
                  const std::function<glm::dvec3(glm::dvec2)>& colour);
// The same with alpha in the fourth component.
ModelTexture fill_rgba(const std::string& name, int width_px, int height_px,
                       const std::function<glm::dvec4(glm::dvec2)>& colour);

}  // namespace probewalk::procedural
