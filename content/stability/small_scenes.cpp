#include "content/stability/small_scenes.h"

#include <cmath>

#include "content/stability/low_discrepancy.h"

namespace probewalk::stability {

Scene furnished_room() {
  SceneBuilder b;
  // Walls one by one: the east wall has a window from 1 to 2 m.
  const float x0 = -3, x1 = 3, y1 = 2.6f, z0 = -2.5f, z1 = 2.5f;
  b.quad({x0, 0, z1}, {x1, 0, z1}, {x1, 0, z0}, {x0, 0, z0});
  b.quad({x0, y1, z0}, {x1, y1, z0}, {x1, y1, z1}, {x0, y1, z1});
  b.quad({x0, 0, z0}, {x1, 0, z0}, {x1, y1, z0}, {x0, y1, z0});
  b.quad({x1, 0, z1}, {x0, 0, z1}, {x0, y1, z1}, {x1, y1, z1});
  b.quad({x0, 0, z1}, {x0, 0, z0}, {x0, y1, z0}, {x0, y1, z1});
  b.quad({x1, 0, z0}, {x1, 0, z1}, {x1, 1, z1}, {x1, 1, z0});
  b.quad({x1, 2, z0}, {x1, 2, z1}, {x1, y1, z1}, {x1, y1, z0});
  b.quad({x1, 1, z0}, {x1, 1, -1}, {x1, 2, -1}, {x1, 2, z0});
  b.quad({x1, 1, 1}, {x1, 1, z1}, {x1, 2, z1}, {x1, 2, 1});
  b.table(0.2f, 0.1f, 1.4f, 0.8f, 0.74f, 0.05f);
  for (int k = 0; k < 4; ++k) {
    b.table(-0.4f + 0.9f * static_cast<float>(k % 2), k < 2 ? 0.85f : -0.7f, 0.45f, 0.45f, 0.45f, 0.025f);
  }
  b.box({-2.0f, 0, -1.8f}, {-1.6f, y1, -1.4f});
  return b.build();
}

Scene grille_room() {
  SceneBuilder b;
  b.box({-3, 0, -3}, {3, 2.5f, 3}, true);
  for (int k = 0; k < 40; ++k) {
    const float x = -2.4f + 0.12f * static_cast<float>(k);
    b.box({x - 0.01f, 0, -0.01f}, {x + 0.01f, 2.5f, 0.01f});
  }
  return b.build();
}

Scene leafy_room() {
  SceneBuilder b;
  b.box({-3, 0, -3}, {3, 2.5f, 3}, true);
  Random random(23);
  for (int k = 0; k < 900; ++k) {
    const glm::dvec3 out = random.direction();
    const double distance_m = 0.06 * std::pow(40.0, random());
    const glm::dvec3 centre = glm::dvec3(0, 1.25, 0) + distance_m * out * glm::dvec3(1, 0.45, 1);
    const glm::dvec3 u = 0.02 * random.direction(), v = 0.02 * glm::normalize(glm::cross(u, random.direction()));
    b.quad(glm::vec3(centre - u - v), glm::vec3(centre + u - v), glm::vec3(centre + u + v), glm::vec3(centre - u + v));
  }
  return b.build();
}

Scene wide_plain() {
  SceneBuilder b;
  b.box({-1e4f, 0, -1e4f}, {1e4f, 3e3f, 1e4f}, true);
  b.table(0.9f, 0.4f, 1.4f, 0.8f, 0.74f, 0.05f);
  for (int k = 0; k < 24; ++k) {
    const float angle = 0.7f + 2.4f * static_cast<float>(k), far_m = std::pow(1.5f, static_cast<float>(k));
    const glm::vec3 foot(far_m * std::cos(angle), 0, far_m * std::sin(angle));
    b.box(foot - glm::vec3(0.05f * far_m, 0, 0.05f * far_m),
          foot + glm::vec3(0.05f * far_m, 0.6f * far_m, 0.05f * far_m));
  }
  return b.build();
}

}  // namespace probewalk::stability
