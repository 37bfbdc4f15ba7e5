// How far along the view's axis each pixel's ray went, as depth for the display's compositor.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require

#include "shared/view_depth.h"
#include "shared/view_ray.h"

layout(binding = 0, r32f) readonly uniform image2DArray distance_image;
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Frame { FrameConstants constants; };
layout(push_constant) uniform Push {
  uvec2 frame_address;
  uint view;
};

void main() {
  Frame frame = Frame(frame_address);
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float along_ray_m = imageLoad(distance_image, ivec3(pixel, view)).r;
  float cosine = view_ray_cosine(frame.constants.view[view], pixel, frame.constants.size_px);
  gl_FragDepth = view_depth(along_ray_m * cosine, frame.constants.near_m, frame.constants.far_m);
}
