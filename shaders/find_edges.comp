// Lists the pixels whose surroundings show an edge, of all views; z = view.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require

#include "shared/display_transform.h"
#include "shared/pixel_list.h"
#include "shared/foveation.h"
#include "shared/probe_layout.h"

layout(local_size_x = 8, local_size_y = 8) in;

// Groups of sample_edges.comp come in multiples of this (see kInterleave there).
layout(constant_id = 0) const int kInterleave = 1;
// Where a ray stands for several pixels none gets another.
layout(constant_id = 1) const bool kFoveated = false;
// Where the headset's optics hide a tile none gets one.
layout(constant_id = 2) const bool kMasked = false;

layout(binding = 0, rgba16f) readonly uniform image2DArray radiance_image;
layout(binding = 1, r32f) readonly uniform image2DArray distance_image;

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Frame { FrameConstants constants; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer EdgeList {
  PixelListHead head;
  uint pixel[];
};
layout(push_constant) uniform Push {
  uvec2 frame_address;
  uvec2 unused;
  uvec2 list_address;
};

#include "hidden_tiles.glsl"

// Inverse depth along a row or column of pixels that see one plane is affine; a bend beyond this share of the nearest
// one's is another surface, or a crease.
const float kBend = 0.01;
// Differences of what is shown, in any channel, roughly as the eye spaces them (square root of display light, 0 to 1).
const float kSeen = 0.025;   // across a bend: smaller ones need no smoothing
const float kStrong = 0.1;    // on one surface: shadows, where probes meet, textures coarser than their pixel

const int kSide = 10;  // the tile and a pixel around it
shared vec4 tile[kSide * kSide];  // shown colour, inverse depth; inverse depth -1: beyond the picture
shared uint tile_count, tile_start;

vec4 neighbour(ivec2 pixel, int view_index, FrameConstants constants) {
  ivec2 size_px = constants.size_px;
  if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, size_px))) return vec4(0.0, 0.0, 0.0, -1.0);
  vec4 tangents = constants.view[view_index].tan_angles;
  vec2 at = (vec2(pixel) + 0.5) / vec2(size_px);
  vec2 slope = mix(tangents.xz, tangents.yw, at);
  float distance_m = max(imageLoad(distance_image, ivec3(pixel, view_index)).x, 1e-6);
  vec3 radiance = imageLoad(radiance_image, ivec3(pixel, view_index)).rgb;
  vec3 shown = tone_curve(radiance * (constants.exposure / constants.trace.radiance_scale));
  return vec4(sqrt(clamp(shown, 0.0, 1.0)), sqrt(dot(slope, slope) + 1.0) / distance_m);
}

float contrast(vec4 a, vec4 b) {
  vec3 difference = b.w < 0.0 ? vec3(0.0) : abs(a.rgb - b.rgb);
  return max(difference.x, max(difference.y, difference.z));
}

bool bends(vec4 before, vec4 here, vec4 after) {
  if (before.w < 0.0 || after.w < 0.0) return false;
  return abs(before.w - 2.0 * here.w + after.w) > kBend * max(here.w, max(before.w, after.w));
}

void main() {
  FrameConstants constants = Frame(frame_address).constants;
  EdgeList list = EdgeList(list_address);
  int view_index = int(gl_WorkGroupID.z);
  if (kMasked && is_hidden_tile(constants.hidden_tiles_address, view_index, ivec2(gl_WorkGroupID.xy),
                                constants.size_px)) {
    return;
  }
  ivec2 corner = ivec2(gl_WorkGroupID.xy) * 8 - 1;
  int lane = int(gl_LocalInvocationIndex);
  if (lane == 0) tile_count = 0u;
  for (int k = lane; k < kSide * kSide; k += 64) {
    tile[k] = neighbour(corner + ivec2(k % kSide, k / kSide), view_index, constants);
  }
  barrier();

  ivec2 pixel = ivec2(gl_WorkGroupID.xy) * 8 + ivec2(gl_LocalInvocationID.xy);
  int at = (int(gl_LocalInvocationID.y) + 1) * kSide + int(gl_LocalInvocationID.x) + 1;
  vec4 here = tile[at], left = tile[at - 1], right = tile[at + 1], up = tile[at - kSide], down = tile[at + kSide];
  float most = max(max(contrast(here, left), contrast(here, right)), max(contrast(here, up), contrast(here, down)));
  bool is_edge = here.w >= 0.0 &&
                 (most > kStrong || (most > kSeen && (bends(left, here, right) || bends(up, here, down))));
  is_edge = is_edge && (!kFoveated || foveation_rate(constants.view[view_index], pixel, constants) == 1);

  // One reservation a tile keeps the list's neighbours neighbours in the picture.
  uint place = is_edge ? atomicAdd(tile_count, 1u) : 0u;
  barrier();
  if (lane == 0 && tile_count > 0u) {
    tile_start = atomicAdd(list.head.count, tile_count);
    atomicMax(list.head.groups_x, list_groups(tile_start + tile_count, kInterleave));
  }
  barrier();
  if (!is_edge) return;
  list.pixel[tile_start + place] =
      listed_pixel(ivec3(pixel, view_index));
}
