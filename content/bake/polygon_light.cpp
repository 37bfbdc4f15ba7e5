#include "content/bake/polygon_light.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace probewalk {
namespace {

// A triangle clipped twice has five corners at most.
struct Polygon {
  std::array<glm::vec3, 5> corners;
  std::size_t count = 0;
};

Polygon clip(const Polygon& polygon, glm::vec3 normal) {
  Polygon clipped;
  for (std::size_t k = 0; k < polygon.count; ++k) {
    const glm::vec3 a = polygon.corners[k], b = polygon.corners[(k + 1) % polygon.count];
    const float above_a = glm::dot(a, normal), above_b = glm::dot(b, normal);
    if (above_a > 0.0f && clipped.count < clipped.corners.size()) clipped.corners[clipped.count++] = a;
    if ((above_a > 0.0f) != (above_b > 0.0f) && clipped.count < clipped.corners.size()) {
      clipped.corners[clipped.count++] = a + (b - a) * (above_a / (above_a - above_b));
    }
  }
  return clipped;
}

}  // namespace

float triangle_cosine_integral(const std::array<glm::vec3, 3>& corners_m, glm::vec3 geometric_normal,
                               glm::vec3 normal) {
  Polygon polygon{{corners_m[0], corners_m[1], corners_m[2]}, 3};
  polygon = clip(clip(polygon, geometric_normal), normal);
  if (polygon.count < 3) return 0.0f;
  float sum = 0.0f;
  for (std::size_t k = 0; k < polygon.count; ++k) {
    const glm::vec3 a = polygon.corners[k], b = polygon.corners[(k + 1) % polygon.count];
    const float lengths = std::sqrt(glm::dot(a, a) * glm::dot(b, b));
    const glm::vec3 cross = glm::cross(a, b);
    const float sine = glm::length(cross);
    if (!(sine > 1e-7f * lengths)) continue;
    sum += std::atan2(sine, glm::dot(a, b)) * (glm::dot(cross, normal) / sine);
  }
  return std::min(0.5f * std::abs(sum), 3.14159265f);
}

}  // namespace probewalk
