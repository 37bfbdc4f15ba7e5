// What guides.vert and guides.frag share.
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require

#include "shared/guides.h"
#include "shared/view_ray.h"

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Frame { FrameConstants constants; };
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer GuideBuffer { GuideConstants constants; };
layout(push_constant) uniform Push {
  uvec2 frame_address;
  uint view;
  uint reserved;
  uvec2 guides_address;
};

const int kWay = 0, kMarker = 1, kVignette = 2;  // what a quad is part of
