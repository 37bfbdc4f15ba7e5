// The second eye's rays that the first eye could not answer (ask_first_eye.comp), side by side.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require

#include "shared/seen_surface.h"
#include "shared/tracer_glsl.h"
#include "shared/view_ray.h"
#include "openings.glsl"

layout(local_size_x = kListGroup) in;

// As in trace_stereo.glsl.
layout(constant_id = 0) const bool kWithAov = false;
layout(constant_id = 1) const int kInterleave = 1;

layout(binding = 0, rgba16f) writeonly uniform image2DArray radiance_image;
layout(binding = 1, r32f) writeonly uniform image2DArray distance_image;
layout(binding = 2, rgba32ui) uniform uimage2DArray aov_image;

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Frame { FrameConstants constants; };
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer RestList {
  PixelListHead head;
  RestRay ray[];
};
layout(push_constant) uniform Push {
  uvec2 frame_address;
  uvec2 unused;
  uvec2 list_address;
  uvec2 openings_address;
};

#include "store_ray.glsl"

void main() {
  FrameConstants constants = Frame(frame_address).constants;
  RestList list = RestList(list_address);
  uint groups = gl_NumWorkGroups.x, part = groups / uint(kInterleave);
  uint group = gl_WorkGroupID.x % part * uint(kInterleave) + gl_WorkGroupID.x / part;
  uint stride = groups * uint(kListGroup);
  for (uint k = group * uint(kListGroup) + gl_LocalInvocationIndex; k < list.head.count; k += stride) {
    RestRay ray = list.ray[k];
    ivec3 texel = texel_of(ray.pixel);
    ViewConstants view = constants.view[texel.z];
    vec3 direction = view_ray(view, texel.xy, constants.size_px);
    RayHint hint = opening_hint(openings_address, texel.z, direction);
    hint.t_free = ray.t_free_m;
    RayAnswer answer = pipeline_trace(constants.baseline_address, constants.grid, constants.trace, view.origin_hi_m,
                                      view.origin_lo_m, direction, choice_shift(view), hint);
    uint reads;
    vec3 radiance = pipeline_radiance(constants.grid, constants.trace, answer, view.origin_hi_m, view.origin_lo_m,
                                      direction, view.pixel_angle_rad, reads);
    if (kWithAov) answer.lookups += imageLoad(aov_image, texel).z;  // of what the first eye was asked
    store_ray(texel, answer, radiance, constants.trace.radiance_scale, reads);
  }
}
