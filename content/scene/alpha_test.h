// Which points of a triangle exist: the alpha test that rays and the importer's warning share.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "content/scene/scene.h"

namespace probewalk {

// What the alpha test says about a material, whatever the point.
enum class AlphaClass {
  kAlways,  // every point exists: no test is needed
  kNever,   // no point exists
  kTested,  // depends on the texture
};

// Alpha below which a point of the material does not exist: alpha_cutoff (MASK), 0.5 (BLEND), 0 (OPAQUE).
float alpha_threshold(const Material& material);

// One class per material of the scene, from the factor and the texture's range of alpha.
std::vector<AlphaClass> classify_alpha(const Scene& scene);

// Texture coordinates of a point of a triangle; `barycentric` weighs vertices 1 and 2. (0, 0) without that set.
glm::vec2 interpolate_uv(const Scene& scene, std::uint32_t triangle, glm::vec2 barycentric, int uv_set);

// Whether the point exists. The texture is read at its full resolution.
bool point_exists(const Scene& scene, std::uint32_t triangle, glm::vec2 barycentric);

}  // namespace probewalk
