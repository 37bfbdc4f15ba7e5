// The guides' colours where nothing that the trace met lies in front of them, and the dark of the vignette.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "guides.glsl"

layout(binding = 0, r32f) readonly uniform image2DArray distance_image;
layout(location = 0) flat in int part;
layout(location = 1) in vec3 from_eye_m;
layout(location = 2) in vec2 place;
layout(location = 0) out vec4 color;

const float kWayAlpha = 0.85, kRingAlpha = 0.95, kFillAlpha = 0.3;
const float kFadesIn = 0.12;        // of the way: it does not begin in the wearer's face
const float kDistanceError = 0.02;  // of what the trace met

// 1 within the edge, 0 beyond it, a pixel wide in between.
float within(float edge, float at, float pixel) {
  return clamp((edge - at) / pixel + 0.5, 0.0, 1.0);
}

float way_alpha() {
  return kWayAlpha * smoothstep(0.0, kFadesIn, place.x) * within(1.0, abs(place.y), fwidth(place.y));
}

float marker_alpha(bool lies) {
  float r = length(place), pixel = fwidth(r);
  float rim = within(1.0, r, pixel) - within(0.84, r, pixel);
  if (lies) return max(kRingAlpha * (rim + within(0.16, r, pixel)), kFillAlpha * within(1.0, r, pixel));
  float bar = abs(abs(place.x) - abs(place.y));
  return kRingAlpha * max(rim, within(0.2, bar, fwidth(place.x) * 1.5) * within(0.84, r, pixel));
}

void main() {
  Frame frame = Frame(frame_address);
  GuideBuffer guides = GuideBuffer(guides_address);
  if (part == kVignette) {
    float off_axis = length(view_plane_m(frame.constants.view[view], gl_FragCoord.xy, frame.constants.size_px));
    color = vec4(0.0, 0.0, 0.0,
                 smoothstep(guides.constants.vignette_clear, guides.constants.vignette_black, off_axis));
    return;
  }
  bool is_marker = part == kMarker;
  float alpha = is_marker ? marker_alpha(guides.constants.marker_lies != 0) : way_alpha();
  float met_m = imageLoad(distance_image, ivec3(ivec2(gl_FragCoord.xy), view)).r;
  float slack_m = is_marker ? guides.constants.marker_slack_m : guides.constants.slack_m;
  if (length(from_eye_m) > met_m * (1.0 + kDistanceError) + slack_m) alpha = 0.0;
  color = vec4(guides.constants.color, alpha * (1.0 - frame.constants.fade));
}
