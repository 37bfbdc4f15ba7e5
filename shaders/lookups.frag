// How many look-ups each pixel's rays took, in place of the picture (lookup_colors.h).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require

#include "shared/lookup_colors.h"
#include "shared/probe_layout.h"

layout(binding = 0, rgba32ui) readonly uniform uimage2DArray aov_image;
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Frame { FrameConstants constants; };
layout(push_constant) uniform Push {
  uvec2 frame_address;
  uint view;
};
layout(location = 0) out vec4 color;

void main() {
  Frame frame = Frame(frame_address);
  uint lookups = imageLoad(aov_image, ivec3(ivec2(gl_FragCoord.xy), view)).z;
  color = vec4(lookup_color(float(lookups)) * (1.0 - frame.constants.fade), 1.0);
}
