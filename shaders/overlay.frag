// The overlay's colours, letters by their coverage. Letters are drawn texel on pixel: nothing is filtered.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require

#include "shared/overlay_layout.h"

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Atlas { uint coverage[]; };
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Overlay { OverlayHead head; };
layout(push_constant) uniform Push { uvec2 overlay_address; };
layout(location = 0) in vec4 color;
layout(location = 1) in vec2 place_in_atlas;
layout(location = 0) out vec4 shown;

void main() {
  OverlayHead head = Overlay(overlay_address).head;
  ivec2 texel = clamp(ivec2(place_in_atlas * vec2(head.atlas_px)), ivec2(0), head.atlas_px - 1);
  uint at = uint(texel.y * head.atlas_px.x + texel.x);
  uint coverage = (Atlas(head.atlas_address).coverage[at >> 2] >> ((at & 3u) * 8u)) & 255u;
  shown = vec4(color.rgb, color.a * float(coverage) * (1.0 / 255.0));
}
