// How many look-ups each pixel's rays took, in place of the picture: from black (none) by blue, green and yellow to
// white (kMost and more).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require

#include "shared/probe_layout.h"

layout(binding = 0, rgba32ui) readonly uniform uimage2DArray aov_image;
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Frame { FrameConstants constants; };
layout(push_constant) uniform Push {
  uvec2 frame_address;
  uint view;
};
layout(location = 0) out vec4 color;

const float kMost = 64.0;
const int kStops = 6;
const vec3 kStop[kStops] = vec3[](vec3(0.0), vec3(0.01, 0.05, 0.35), vec3(0.02, 0.40, 0.30), vec3(0.75, 0.65, 0.05),
                                  vec3(0.80, 0.08, 0.03), vec3(1.0));

void main() {
  Frame frame = Frame(frame_address);
  uint lookups = imageLoad(aov_image, ivec3(ivec2(gl_FragCoord.xy), view)).z;
  float at = clamp(float(lookups) / kMost, 0.0, 1.0) * float(kStops - 1);
  int stop = min(int(at), kStops - 2);
  color = vec4(mix(kStop[stop], kStop[stop + 1], at - float(stop)) * (1.0 - frame.constants.fade), 1.0);
}
