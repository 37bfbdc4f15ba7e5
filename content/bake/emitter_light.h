// What one emitter sends to one receiver: how much, at most how much anywhere in a ball, and what of it arrives.
// Emitters have one numbering: first the punctual lights, then the patches.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "content/bake/emitters.h"
#include "content/scene/ray_scene.h"

namespace probewalk {

struct Receiver {
  glm::vec3 position_m{0.0f}, geometric_normal{0.0f}, normal{0.0f};  // unit normals
  // Cosine at the surface for a unit direction towards light; 0 behind either normal.
  float cosine(glm::vec3 to_light) const {
    return glm::dot(geometric_normal, to_light) > 0.0f ? glm::max(glm::dot(normal, to_light), 0.0f) : 0.0f;
  }
};

class EmitterLight {
 public:
  EmitterLight(const Emitters& emitters, const RayScene& rays) : emitters_(emitters), rays_(rays) {}

  std::uint32_t count() const { return std::uint32_t(emitters_.lights.size() + emitters_.patches.size()); }
  bool is_patch(std::uint32_t emitter) const { return emitter >= emitters_.lights.size(); }

  // Irradiance (lux) as if nothing stood between.
  glm::vec3 unshadowed(std::uint32_t emitter, const Receiver& receiver) const;
  // About what arrives in a ball at most, whichever way a surface there faces (lux, strongest channel); 0 only where
  // none does.
  float strength_near(std::uint32_t emitter, glm::vec3 centre_m, float radius_m) const;
  // Intensity (cd) or, of a directional light, illuminance (lux); strongest channel.
  float power(std::uint32_t emitter) const;
  // Share in [0, 1] of the unshadowed light that arrives; `ray_count` rays for a patch, one for a light.
  float visible_fraction(std::uint32_t emitter, int ray_count, const Receiver& receiver,
                         std::uint64_t& rays_cast) const;

  // Irradiance (lux) by a single ray to a place of the emitter that the word chooses: right on average over words.
  glm::vec3 irradiance_by_one(std::uint32_t emitter, std::uint32_t word, const Receiver& receiver,
                              std::uint64_t& rays_cast) const;

 private:
  const Emitters& emitters_;
  const RayScene& rays_;
};

inline float strongest_channel(glm::vec3 rgb) {
  return glm::max(rgb.r, glm::max(rgb.g, rgb.b));
}

}  // namespace probewalk
