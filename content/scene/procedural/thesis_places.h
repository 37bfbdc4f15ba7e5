// Where things are in the scenes after the thesis's schematic figures: for the scenes, and for tests that
// check that they show what they are for. Metres, y up.
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace probewalk::procedural {

// Figure 4.3: closed cells. Every ray is known to one probe only: that of its own cell.
namespace cells {
inline constexpr int kColumns = 3, kRows = 2;
inline constexpr double kCell_m = 2.4, kWall_m = 0.2;
// The probe's place in a cell, 0 to kColumns * kRows - 1.
inline glm::dvec3 middle_m(int number) {
  const double step_m = kCell_m + kWall_m;
  return {step_m * (number % kColumns - 0.5 * (kColumns - 1)), 1.4,
          step_m * (number / kColumns - 0.5 * (kRows - 1))};
}
}  // namespace cells

// Figure 4.4: a ray from the hall down the corridor. Probes beside the ray lose it; one behind its origin
// keeps it.
namespace corridor {
inline constexpr double kHalfWidth_m = 0.6, kEnd_m = -8.0;  // the corridor runs from z = 0 to kEnd_m
inline constexpr glm::dvec3 kOrigin_m{0.0, 1.5, 1.0}, kTarget_m{0.0, 1.5, kEnd_m};
inline constexpr glm::dvec3 kBehind_m{0.0, 1.5, 3.0};                          // sees all of the ray
inline constexpr glm::dvec3 kLeft_m{-2.0, 1.5, 1.0}, kRight_m{2.0, 1.5, 1.0};  // as near, see its beginning
}  // namespace corridor

// Figure 4.5: a five-pointed star: not convex, and yet all of it is seen from its middle.
namespace star {
inline constexpr double kOuterRadius_m = 4.0;
inline constexpr double kInnerRadius_m =
    0.381966 * kOuterRadius_m;  // of a pentagram: its edges are straight lines
inline constexpr glm::dvec3 kMiddle_m{0.0, 1.4, 0.0};
}  // namespace star

// Figure 5.4: neither probe sees the whole ray, the first its beginning, the second its end, both its middle.
namespace hand_over {
inline constexpr glm::dvec3 kOrigin_m{-3.5, 1.4, 0.0}, kTarget_m{4.0, 1.4, 0.0};
inline constexpr glm::dvec3 kFirst_m{-2.4, 1.4, 1.5}, kSecond_m{2.4, 1.4, -1.5};
}  // namespace hand_over

// Figure 8.2: a box around every point of the lattice.
namespace boxes {
inline constexpr glm::dvec3 kLower_m{-3.05, 0.0, -2.3}, kSize_m{6.1, 2.8, 4.6};
inline constexpr double kHalfBox_m = 0.2;
inline constexpr double kSpacing_m = 1.5;
std::vector<glm::dvec3> points_m();
}  // namespace boxes

}  // namespace probewalk::procedural
