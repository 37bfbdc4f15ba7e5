#include "content/scene/scene.h"

namespace probewalk {
namespace {

// Sine of the depression below the horizon at which the ground has replaced it.
constexpr float kGroundFade = 0.1f;

}  // namespace

// Smoothstep has no slope at its ends, so the gradient has no crease at the horizon.
glm::vec3 Sky::radiance(glm::vec3 unit_direction) const {
  const float height = unit_direction.y;
  if (height >= 0.0f) return glm::mix(horizon_cd_m2, zenith_cd_m2, glm::smoothstep(0.0f, 1.0f, height));
  return glm::mix(horizon_cd_m2, ground_cd_m2, glm::smoothstep(0.0f, kGroundFade, -height));
}

}  // namespace probewalk
