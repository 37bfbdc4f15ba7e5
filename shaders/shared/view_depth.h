// Depth as a display's compositor takes it: of the distance along the view's axis, reversed, so that floats are finest
// where things are far. 1 at near_m and nearer, 0 at far_m and farther, misses included.
#ifndef PROBEWALK_SHADERS_SHARED_VIEW_DEPTH_H
#define PROBEWALK_SHADERS_SHARED_VIEW_DEPTH_H

#include "dialect.h"

#ifdef __cplusplus
#include <algorithm>
#endif

PW_SHARED_BEGIN

// What a projection matrix with these planes swapped would give. 0 < near_m < far_m.
PW_FUNCTION float view_depth(float along_axis_m, float near_m, float far_m) {
#ifdef __cplusplus
  using std::max;
  using std::min;
#endif
  float z_m = max(near_m, min(along_axis_m, far_m));
  return min(near_m * (far_m - z_m) / (z_m * (far_m - near_m)), 1.0f);
}

PW_SHARED_END

#endif
