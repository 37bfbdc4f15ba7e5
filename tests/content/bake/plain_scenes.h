// Scenes of boxes and sheets, filled by hand, for tests of the bake.
#pragma once

#include <glm/glm.hpp>

#include "content/scene/scene.h"

namespace probewalk::plain {

inline std::uint32_t add_material(Scene& scene, glm::vec3 albedo, glm::vec3 emission = glm::vec3(0.0f)) {
  Material material;
  material.base_color_factor = glm::vec4(albedo, 1.0f);
  material.emissive_cd_m2 = emission;
  scene.materials.push_back(material);
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

// Corners in order around; the front is where they run counter-clockwise.
inline void add_quad(Scene& scene, glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d, std::uint32_t material) {
  const auto first = static_cast<std::uint32_t>(scene.positions_m.size());
  const glm::vec3 normal = glm::normalize(glm::cross(b - a, c - a));
  for (glm::vec3 p : {a, b, c, d}) {
    scene.positions_m.push_back(p);
    scene.normals.push_back(normal);
    scene.bounds.lower_m = glm::min(scene.bounds.lower_m, glm::dvec3(p));
    scene.bounds.upper_m = glm::max(scene.bounds.upper_m, glm::dvec3(p));
  }
  const std::uint32_t object = scene.triangle_object.empty() ? 0 : scene.triangle_object.back() + 1;
  for (glm::uvec3 t : {glm::uvec3(0, 1, 2), glm::uvec3(0, 2, 3)}) {
    scene.triangles.push_back(t + first);
    scene.triangle_material.push_back(material);
    scene.triangle_object.push_back(object);
  }
}

inline void add_box(Scene& scene, glm::vec3 low, glm::vec3 high, std::uint32_t material) {
  const glm::vec3 l = low, h = high;
  add_quad(scene, {l.x, l.y, l.z}, {h.x, l.y, l.z}, {h.x, l.y, h.z}, {l.x, l.y, h.z}, material);
  add_quad(scene, {l.x, h.y, l.z}, {l.x, h.y, h.z}, {h.x, h.y, h.z}, {h.x, h.y, l.z}, material);
  add_quad(scene, {l.x, l.y, l.z}, {l.x, h.y, l.z}, {h.x, h.y, l.z}, {h.x, l.y, l.z}, material);
  add_quad(scene, {l.x, l.y, h.z}, {h.x, l.y, h.z}, {h.x, h.y, h.z}, {l.x, h.y, h.z}, material);
  add_quad(scene, {l.x, l.y, l.z}, {l.x, l.y, h.z}, {l.x, h.y, h.z}, {l.x, h.y, l.z}, material);
  add_quad(scene, {h.x, l.y, l.z}, {h.x, h.y, l.z}, {h.x, h.y, h.z}, {h.x, l.y, h.z}, material);
}

inline Light point_light(glm::vec3 position, float candela) {
  Light light;
  light.position_m = position;
  light.intensity = glm::vec3(candela);
  return light;
}

}  // namespace probewalk::plain
