// The ray of a pixel of an eye's view: the same in the shader, in tools and in tests, to the bit.
#ifndef PROBEWALK_SHADERS_SHARED_VIEW_RAY_H
#define PROBEWALK_SHADERS_SHARED_VIEW_RAY_H

#include "dialect.h"
#include "probe_layout.h"

#ifdef __cplusplus
#include <cmath>
#endif

PW_SHARED_BEGIN

// Unit direction through a point of the picture, in pixels from its upper left corner. Written out by component, so that
// no compiler sums in another order.
PW_FUNCTION pw_vec3 view_ray_through(ViewConstants view, pw_vec2 point_px, pw_ivec2 size_px) {
#ifdef __cplusplus
  using std::sqrt;
#endif
  float across = point_px.x / float(size_px.x), down = point_px.y / float(size_px.y);
  float x = view.tan_angles.x + across * (view.tan_angles.y - view.tan_angles.x);
  float y = view.tan_angles.z + down * (view.tan_angles.w - view.tan_angles.z);
  float scale = 1.0f / sqrt(x * x + y * y + 1.0f);
  return pw_vec3((view.world_from_eye_x.x * x + view.world_from_eye_y.x * y - view.world_from_eye_z.x) * scale,
                 (view.world_from_eye_x.y * x + view.world_from_eye_y.y * y - view.world_from_eye_z.y) * scale,
                 (view.world_from_eye_x.z * x + view.world_from_eye_y.z * y - view.world_from_eye_z.z) * scale);
}

// Unit direction through the centre of pixel (x, y), row 0 at the top.
PW_FUNCTION pw_vec3 view_ray(ViewConstants view, pw_ivec2 pixel, pw_ivec2 size_px) {
  return view_ray_through(view, pw_vec2(float(pixel.x) + 0.5f, float(pixel.y) + 0.5f), size_px);
}

PW_SHARED_END

#endif
