// Where depth begins and ends, for displays that take a depth image.
#pragma once

#include <glm/glm.hpp>

#include "content/scene/scene.h"

namespace probewalk {

struct DepthRange {
  // Nearer than eyes can meet, or a head stays from a wall; yet far enough for 16-bit depth (steps of 3 cm at 10 m).
  float near_m = 0.05f;
  float far_m = 100.0f;
};

// A far plane behind everything that can be seen from within `bounds` and from as far again around them; reversed float
// depth loses nothing by the margin.
inline DepthRange depth_range_of(const Bounds& bounds) {
  constexpr double kLeastFar_m = 10.0, kMostFar_m = 1e6;  // of a thing on a table, of a landscape
  DepthRange range;
  const double diagonal_m = glm::distance(bounds.lower_m, bounds.upper_m);
  range.far_m = static_cast<float>(glm::clamp(2.0 * diagonal_m, kLeastFar_m, kMostFar_m));
  return range;
}

}  // namespace probewalk
