// The light that a cache point holds: what arrives at its surface, and how that changes as the surface turns.
#pragma once

#include <glm/glm.hpp>

namespace probewalk {

struct CachedLight {
  glm::vec3 lux{0.0f};
  // Column by channel, along the surface: the rotational gradient of irradiance caching (Ward and Heckbert 1992), in
  // lux a radian.
  glm::mat3 turn{0.0f};

  // Irradiance on a surface that faces `turned` (the difference of unit normals) otherwise. Never negative, and at most
  // kMostTurned times what arrives here: it is a first-order guess.
  glm::vec3 at(glm::vec3 turned) const {
    return glm::clamp(lux + turned * turn, glm::vec3(0.0f), kMostTurned * glm::max(lux, glm::vec3(0.0f)));
  }

  // Adds the light of one of many cosine-distributed directions.
  void add(glm::vec3 radiance, glm::vec3 direction, glm::vec3 normal) {
    const float cosine = glm::dot(direction, normal);
    const glm::vec3 across = (direction - cosine * normal) / glm::max(cosine, kGrazing);
    lux += radiance;
    for (int c = 0; c < 3; ++c) turn[c] += radiance[c] * across;
  }
  CachedLight& operator+=(const CachedLight& other) {
    lux += other.lux;
    turn += other.turn;
    return *this;
  }
  CachedLight operator*(float scale) const { return {lux * scale, turn * scale}; }
  bool operator==(const CachedLight&) const = default;

 private:
  static constexpr float kMostTurned = 3.0f;
  static constexpr float kGrazing = 0.1f;  // directions nearer to the horizon would be all noise
};

}  // namespace probewalk
