// A ribbon along a teleport's way, turned to the eye; a marker where it ends; a ring around what the vignette leaves
// clear. Six vertices a quad; what is not there has no area.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "guides.glsl"

layout(location = 0) flat out int part;
layout(location = 1) out vec3 from_eye_m;  // in the world's directions
// The way: along it, 0 to 1, and across, -1 to 1. The marker: (-1, -1) to (1, 1).
layout(location = 2) out vec2 place;

const float kNear_m = 0.02;
const float kLeastHalfWidth_px = 1.0;
const float kVignetteRim = 16.0;  // a tangent beyond every view's

vec3 along_the_way(GuideBuffer guides, vec3 eye_m, float pixel_angle_rad, int at, float side) {
  int last = guides.constants.points - 1;
  vec3 point = guides.constants.point_m[at];
  vec3 across = cross(guides.constants.point_m[min(at + 1, last)] - guides.constants.point_m[max(at - 1, 0)],
                      eye_m - point);
  float size = length(across);
  float half_width_m =
      max(guides.constants.half_width_m, kLeastHalfWidth_px * pixel_angle_rad * distance(eye_m, point));
  return point + (size > 1e-9 ? across / size : vec3(0.0)) * (side * half_width_m);
}

vec3 on_the_marker(GuideBuffer guides, ViewConstants eye, vec2 corner) {
  vec2 at = corner * guides.constants.marker_radius_m;
  vec3 offset = guides.constants.marker_lies != 0 ? vec3(at.x, 0.0, at.y)
                                                  : eye.world_from_eye_x.xyz * at.x + eye.world_from_eye_y.xyz * at.y;
  return guides.constants.marker_m + offset;
}

void main() {
  const int kCorners[6] = int[6](0, 1, 2, 2, 1, 3);
  int quad = gl_VertexIndex / 6, corner = kCorners[gl_VertexIndex % 6];
  vec2 corners = vec2((corner & 1) != 0 ? 1.0 : -1.0, (corner & 2) != 0 ? 1.0 : -1.0);
  Frame frame = Frame(frame_address);
  GuideBuffer guides = GuideBuffer(guides_address);
  ViewConstants eye = frame.constants.view[view];
  vec4 tangents = eye.tan_angles;  // left, right, up, down
  // High parts first: their difference is exact where the two are near each other.
  vec3 eye_m = (eye.origin_hi_m - guides.constants.origin_hi_m) + (eye.origin_lo_m - guides.constants.origin_lo_m);
  place = corners;
  from_eye_m = vec3(0.0);
  part = quad >= kGuideVignetteQuad ? kVignette : quad == kGuideMarkerQuad ? kMarker : kWay;
  vec3 p;  // in the eye's space
  if (part == kVignette) {
    float turn = 6.28318531 / float(kGuideVignetteSides);
    float angle = float(quad - kGuideVignetteQuad + (corner & 1)) * turn;
    // Its sides run inside the circle that is left clear.
    float radius = (corner & 2) != 0 ? kVignetteRim : guides.constants.vignette_clear * cos(0.5 * turn);
    p = vec3(cos(angle) * radius, sin(angle) * radius, -1.0);
  } else if (part == kMarker) {
    from_eye_m = on_the_marker(guides, eye, corners) - eye_m;
  } else if (quad + 1 < guides.constants.points) {
    int at = quad + (corner & 1);
    from_eye_m = along_the_way(guides, eye_m, eye.pixel_angle_rad, at, corners.y) - eye_m;
    place.x = float(at) / float(guides.constants.points - 1);
  }
  if (part != kVignette) {
    p = vec3(dot(from_eye_m, eye.world_from_eye_x.xyz), dot(from_eye_m, eye.world_from_eye_y.xyz),
             dot(from_eye_m, eye.world_from_eye_z.xyz));
  }
  float w = -p.z;
  float x = (2.0 * p.x - (tangents.x + tangents.y) * w) / (tangents.y - tangents.x);
  float y = (2.0 * p.y - (tangents.z + tangents.w) * w) / (tangents.w - tangents.z);
  gl_Position = vec4(x, y, w - kNear_m, w);
}
