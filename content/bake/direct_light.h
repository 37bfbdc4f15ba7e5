// Light that arrives straight from the emitters, by next-event estimation with a fixed pattern: the same point always
// gets the same answer, so there is no noise. Where more lights matter than there are rays, the weaker ones' rays fade, and
// their light counts as visible as that of the others is on average: no light is lost, and shadows stay those of the
// strongest.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "content/bake/emitters.h"
#include "content/scene/ray_scene.h"

namespace probewalk {

inline constexpr int kShadowRays = 8;  // at most, per shading point

class DirectLight {
 public:
  DirectLight(const Scene& scene, const RayScene& rays) : rays_(rays), emitters_(find_emitters(scene, rays)) {}

  // Irradiance (lux) on a surface at position with the given unit normals. Adds to rays_cast. Thread-safe.
  glm::vec3 irradiance(glm::vec3 position_m, glm::vec3 geometric_normal, glm::vec3 normal,
                       std::uint64_t& rays_cast) const;

  const Emitters& emitters() const { return emitters_; }

 private:
  const RayScene& rays_;
  Emitters emitters_;
};

}  // namespace probewalk
