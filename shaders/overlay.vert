// The overlay's triangles, fetched by index.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require

#include "shared/display_transform.h"
#include "shared/overlay_layout.h"

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Indices { uint index[]; };
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Overlay {
  OverlayHead head;
  OverlayVertex vertex[];
};
layout(push_constant) uniform Push { uvec2 overlay_address; };
layout(location = 0) out vec4 color;
layout(location = 1) out vec2 place_in_atlas;

void main() {
  Overlay overlay = Overlay(overlay_address);
  OverlayVertex vertex = overlay.vertex[Indices(overlay.head.index_address).index[gl_VertexIndex]];
  vec4 encoded = unpackUnorm4x8(vertex.rgba);
  color = vec4(srgb_decode(encoded.r), srgb_decode(encoded.g), srgb_decode(encoded.b), encoded.a);
  place_in_atlas = vertex.place_in_atlas;
  gl_Position = vec4(vertex.place_px / vec2(overlay.head.screen_px) * 2.0 - 1.0, 0.0, 1.0);
}
