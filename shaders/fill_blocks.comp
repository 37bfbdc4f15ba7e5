// Where foveation let a ray stand for a block of pixels: fills in the others between the blocks' rays; z = view.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require

#include "shared/display_transform.h"
#include "shared/foveation.h"

layout(local_size_x = 8, local_size_y = 8) in;

// Also fill in class and probe.
layout(constant_id = 0) const bool kWithAov = false;

layout(binding = 0, rgba16f) uniform image2DArray radiance_image;
layout(binding = 1, r32f) uniform image2DArray distance_image;
layout(binding = 2, rgba32ui) uniform uimage2DArray aov_image;

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Frame { FrameConstants constants; };
layout(push_constant) uniform Push { uvec2 frame_address; };

// What the ray shows that is nearest to a point of the picture. Only pixels that keep rays are read: others are being
// written.
vec3 shown_at(FrameConstants frame, int view_index, ivec2 pixel, float exposure) {
  pixel = clamp(pixel, ivec2(0), frame.size_px - 1);
  ivec2 keeper = block_keeper(pixel, foveation_rate(frame.view[view_index], pixel, frame), frame.size_px);
  return tone_curve(imageLoad(radiance_image, ivec3(keeper, view_index)).rgb * exposure);
}

void main() {
  FrameConstants frame = Frame(frame_address).constants;
  int view_index = int(gl_WorkGroupID.z);
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, frame.size_px))) return;
  int rate = foveation_rate(frame.view[view_index], pixel, frame);
  if (rate == 1) return;
  ivec2 keeper = block_keeper(pixel, rate, frame.size_px);
  if (pixel == keeper) return;

  // Between the rays of the four nearest blocks, in what is shown: in radiance a bright window would outshine its frame.
  vec2 at = (vec2(pixel) + 0.5) / float(rate) - 0.5;
  ivec2 first = ivec2(floor(at));
  vec2 share = at - vec2(first);
  ivec2 low = first * rate + rate / 2, high = low + rate;
  float exposure = frame.exposure / frame.trace.radiance_scale;
  vec3 upper = mix(shown_at(frame, view_index, low, exposure),
                   shown_at(frame, view_index, ivec2(high.x, low.y), exposure), share.x);
  vec3 lower = mix(shown_at(frame, view_index, ivec2(low.x, high.y), exposure),
                   shown_at(frame, view_index, high, exposure), share.x);
  vec3 radiance = tone_curve_inverse(mix(upper, lower, share.y)) / exposure;
  imageStore(radiance_image, ivec3(pixel, view_index), vec4(min(radiance, vec3(kPictureMax)), 1.0));
  // Distances are not mixed: between two surfaces there is nothing.
  imageStore(distance_image, ivec3(pixel, view_index), imageLoad(distance_image, ivec3(keeper, view_index)));
  if (kWithAov) {
    uvec4 counts = imageLoad(aov_image, ivec3(keeper, view_index));
    imageStore(aov_image, ivec3(pixel, view_index), uvec4(counts.xy, 0u, 0u));
  }
}
