// Scenes built in code: small, known, hard where they should be.
#pragma once

#include <glm/glm.hpp>

#include "content/scene/scene.h"

namespace probewalk::stability {

class SceneBuilder {
 public:
  SceneBuilder() {
    scene_.name = "test";
    scene_.materials.push_back({});
  }
  int material(const Material& m) {
    scene_.materials.push_back(m);
    return static_cast<int>(scene_.materials.size()) - 1;
  }
  // Counter-clockwise seen from the front.
  SceneBuilder& quad(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d, int material = 0) {
    const auto first = static_cast<std::uint32_t>(scene_.positions_m.size());
    const glm::vec3 normal = glm::normalize(glm::cross(b - a, c - a));
    for (const glm::vec3& p : {a, b, c, d}) {
      scene_.positions_m.push_back(p);
      scene_.normals.push_back(normal);
      scene_.bounds.lower_m = glm::min(scene_.bounds.lower_m, glm::dvec3(p));
      scene_.bounds.upper_m = glm::max(scene_.bounds.upper_m, glm::dvec3(p));
    }
    for (const glm::uvec3& t : {glm::uvec3(0, 1, 2), glm::uvec3(0, 2, 3)}) {
      scene_.triangles.push_back(t + first);
      scene_.triangle_material.push_back(static_cast<std::uint32_t>(material));
      scene_.triangle_object.push_back(object_);
    }
    return *this;
  }
  // Faces outwards, or inwards for a room.
  SceneBuilder& box(glm::vec3 lower, glm::vec3 upper, bool inwards = false, int material = 0) {
    ++object_;
    const auto corner = [&](int k) {
      return glm::vec3(k & 1 ? upper.x : lower.x, k & 2 ? upper.y : lower.y, k & 4 ? upper.z : lower.z);
    };
    constexpr int faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& f : faces) {
      if (inwards) {
        quad(corner(f[3]), corner(f[2]), corner(f[1]), corner(f[0]), material);
      } else {
        quad(corner(f[0]), corner(f[1]), corner(f[2]), corner(f[3]), material);
      }
    }
    return *this;
  }
  SceneBuilder& table(float x, float z, float width, float depth, float height, float leg) {
    box({x - width / 2, height - 0.04f, z - depth / 2}, {x + width / 2, height, z + depth / 2});
    for (int k = 0; k < 4; ++k) {
      const float lx = x + (k & 1 ? 0.5f : -0.5f) * (width - 0.16f), lz = z + (k & 2 ? 0.5f : -0.5f) * (depth - 0.16f);
      box({lx - leg / 2, 0, lz - leg / 2}, {lx + leg / 2, height - 0.04f, lz + leg / 2});
    }
    return *this;
  }
  Scene build() const { return scene_; }
  Scene& scene() { return scene_; }

 private:
  Scene scene_;
  std::uint32_t object_ = 0;
};

// 6 x 2.6 x 5 m, a table, four chairs with 25 mm legs, a pillar, an opening to the sky.
Scene furnished_room();
// A closed room with a grille of 2 cm bars every 12 cm across its middle.
Scene grille_room();
// A closed room around a cloud of small leaves at every distance from 6 cm to 2.5 m of (0, 1.25, 0).
Scene leafy_room();
// Tables and pillars on a plain that walls end ten kilometres away.
Scene wide_plain();

}  // namespace probewalk::stability
