// Floors made of numbers, for tests of how one moves on them.
#pragma once

#include <cmath>
#include <functional>
#include <glm/glm.hpp>

#include "content/scene/space.h"

namespace probewalk::test {

// A floor of 0.05 m columns over [0, size) m; `height` gives the floor's y, NaN = no floor there.
inline FloorMap make_floor(glm::dvec2 size_m, const std::function<double(double x, double z)>& height,
                           float headroom_m = 2.5f) {
  FloorMap floor;
  floor.cell_m = 0.05;
  floor.columns = glm::ivec2(glm::round(size_m / floor.cell_m));
  for (int iz = 0; iz < floor.columns.y; ++iz) {
    for (int ix = 0; ix < floor.columns.x; ++ix) {
      const double y = height((ix + 0.5) * floor.cell_m, (iz + 0.5) * floor.cell_m);
      if (std::isnan(y)) continue;
      FloorNode node;
      node.ix = ix;
      node.iz = iz;
      node.floor_m = static_cast<float>(y);
      node.headroom_m = headroom_m;
      floor.nodes.push_back(node);
    }
  }
  return floor;
}

inline Pose eye_at(double x, double z, double yaw_rad = 0.0, double floor_m = 0.0) {
  Pose pose;
  pose.position_m = {x, floor_m + kEyeHeight_m, z};
  pose.yaw_rad = yaw_rad;
  return pose;
}

// Evenly over the unit square.
inline glm::dvec2 r2_point(int i) {
  // Roberts, The Unreasonable Effectiveness of Quasirandom Sequences (2018): steps of the plastic number.
  return glm::fract(glm::dvec2(0.5) + static_cast<double>(i) * glm::dvec2(0.7548776662466927, 0.5698402909980532));
}

// Two rooms of 4 m x 2 m, z in [0, 2) and [2.15, 4), with a wall of 0.15 m between them and a door at x in [3, 3.8).
inline double two_rooms(double x, double z) {
  return z > 2.0 && z < 2.15 && !(x >= 3.0 && x < 3.8) ? NAN : 0.0;
}
// The same without a door.
inline double two_cells(double, double z) {
  return z > 2.0 && z < 2.15 ? NAN : 0.0;
}

}  // namespace probewalk::test
