// What a hit means for light: where it is, which side was met, and what the material does there.
#pragma once

#include <glm/glm.hpp>

#include "content/scene/ray_scene.h"
#include "content/scene/scene.h"

namespace probewalk {

struct SurfacePoint {
  glm::vec3 position_m{0.0f};
  glm::vec3 geometric_normal{0.0f};  // unit, on the side that the ray came from
  glm::vec3 normal{0.0f};            // unit, interpolated over the mesh where it has such normals, same side
  glm::vec3 albedo{0.0f};            // diffuse reflectance, at most kMaxAlbedo; metals count as diffuse
  glm::vec3 emission_cd_m2{0.0f};    // both sides
  bool unlit = false;                // emission_cd_m2 is what is seen; nothing is received, nothing lights others
};

inline constexpr float kMaxAlbedo = 0.95f;  // more would keep light in a closed room for ever

// direction: unit, of the ray that hit. footprint_m: width of the ray's footprint facing it, for texture filtering.
SurfacePoint surface_at(const Scene& scene, const SurfaceHit& hit, glm::vec3 direction, float footprint_m);

// The material's emission (not unlit colour) at a point of a triangle, textures filtered over footprint_m.
glm::vec3 emission_at(const Scene& scene, std::uint32_t triangle, glm::vec2 barycentric, float footprint_m);

// How far a ray must start from a surface at this position so that it does not meet that surface again.
float ray_offset_m(glm::vec3 position_m);

}  // namespace probewalk
