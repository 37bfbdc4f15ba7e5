// The ray of a pixel of an eye's view: the same in the shader, in tools and in tests, to the bit.
#ifndef PROBEWALK_SHADERS_SHARED_VIEW_RAY_H
#define PROBEWALK_SHADERS_SHARED_VIEW_RAY_H

#include "dialect.h"
#include "probe_layout.h"

#ifdef __cplusplus
#include <cmath>
#endif

PW_SHARED_BEGIN

// The view's plane one metre along its axis, at a point of the picture in pixels from its upper left corner.
PW_FUNCTION pw_vec2 view_plane_m(ViewConstants view, pw_vec2 point_px, pw_ivec2 size_px) {
  float across = point_px.x / float(size_px.x), down = point_px.y / float(size_px.y);
  return pw_vec2(view.tan_angles.x + across * (view.tan_angles.y - view.tan_angles.x),
                 view.tan_angles.z + down * (view.tan_angles.w - view.tan_angles.z));
}

// Metres along the view's axis for each metre along the ray through the point.
PW_FUNCTION float view_cosine_through(ViewConstants view, pw_vec2 point_px, pw_ivec2 size_px) {
#ifdef __cplusplus
  using std::sqrt;
#endif
  pw_vec2 p = view_plane_m(view, point_px, size_px);
  return 1.0f / sqrt(p.x * p.x + p.y * p.y + 1.0f);
}

PW_FUNCTION pw_vec2 pixel_centre(pw_ivec2 pixel) { return pw_vec2(float(pixel.x) + 0.5f, float(pixel.y) + 0.5f); }

PW_FUNCTION float view_ray_cosine(ViewConstants view, pw_ivec2 pixel, pw_ivec2 size_px) {
  return view_cosine_through(view, pixel_centre(pixel), size_px);
}

// Unit direction through a point of the picture. Written out by component, so that no compiler sums in another order.
PW_FUNCTION pw_vec3 view_ray_through(ViewConstants view, pw_vec2 point_px, pw_ivec2 size_px) {
  pw_vec2 p = view_plane_m(view, point_px, size_px);
  float x = p.x, y = p.y, scale = view_cosine_through(view, point_px, size_px);
  return pw_vec3((view.world_from_eye_x.x * x + view.world_from_eye_y.x * y - view.world_from_eye_z.x) * scale,
                 (view.world_from_eye_x.y * x + view.world_from_eye_y.y * y - view.world_from_eye_z.y) * scale,
                 (view.world_from_eye_x.z * x + view.world_from_eye_y.z * y - view.world_from_eye_z.z) * scale);
}

// From the eye to where its rays' probes are chosen.
PW_FUNCTION pw_vec3 choice_shift(ViewConstants view) {
  return pw_vec3(view.world_from_eye_x.x, view.world_from_eye_x.y, view.world_from_eye_x.z) * view.choice_shift_m;
}

// Unit direction through the centre of pixel (x, y), row 0 at the top.
PW_FUNCTION pw_vec3 view_ray(ViewConstants view, pw_ivec2 pixel, pw_ivec2 size_px) {
  return view_ray_through(view, pixel_centre(pixel), size_px);
}

PW_SHARED_END

#endif
