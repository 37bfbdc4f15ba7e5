// The second eye's rays, answered by what the first eye has seen (first_eye.glsl); those that cannot be are listed for
// trace_rest.comp. z = pair of eyes.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require

#include "shared/seen_surface.h"
#include "shared/tracer_glsl.h"
#include "shared/view_ray.h"

layout(local_size_x = 8, local_size_y = 8) in;

// As in trace_stereo.glsl.
layout(constant_id = 0) const bool kWithAov = false;
layout(constant_id = 1) const int kInterleave = 1;
layout(constant_id = 2) const bool kMasked = false;

layout(binding = 0, rgba16f) writeonly uniform image2DArray radiance_image;
layout(binding = 1, r32f) writeonly uniform image2DArray distance_image;
layout(binding = 2, rgba32ui) writeonly uniform uimage2DArray aov_image;

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Frame { FrameConstants constants; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer RestList {
  PixelListHead head;
  RestRay ray[];
};
layout(push_constant) uniform Push {
  uvec2 frame_address;
  uvec2 unused;
  uvec2 list_address;
  uvec2 openings_address;
  uvec2 surfaces_address;
  uvec2 depths_address;
};

#include "first_eye.glsl"
#include "hidden_tiles.glsl"
#include "store_ray.glsl"

shared uint tile_count, tile_start;

// Where a ray meets what the first eye has seen, in metres; not above 0: nowhere.
float seen_distance(GridConstants grid, SeenSurface surface, ViewConstants second, vec3 direction) {
  ProbeRecord probe = pw_probe(grid, int(surface.answer));
  vec3 x = relative_origin(probe, second.origin_hi_m, second.origin_lo_m);
  float height = 1.0 - dot(surface.plane, x), fall = dot(surface.plane, direction);
  return abs(fall) > 1e-12 ? height / fall : -1.0;
}

// False where the ray has to be traced, from t_free on.
bool answer_of_first_eye(FrameConstants constants, int view_index, ivec2 pixel, vec3 direction,
                         inout RayAnswer answer, inout float t_free) {
  ViewConstants first = constants.view[view_index - 1], second = constants.view[view_index];
  ivec2 size_px = constants.size_px;
  float pixels_m = eye_pixels_m(first, second, size_px);
  if (!(pixels_m > 0.0)) return false;
  float x_far = far_column(first, second, float(pixel.x), size_px);
  int last = size_px.x - 1, columns = seen_columns(size_px), pair = view_index / 2;
  float edge = float((columns + seen_margin(columns)) * kSeenTile);
  if (!(x_far >= 0.0 && x_far < float(last) && pixels_m < kUnseen_m * (edge - x_far))) return false;

  int row = seen_row(pair, pixel.y / kSeenTile, size_px);
  float near_m = SeenDepths(depths_address).v[row + pixel.x / kSeenTile];
  answer.lookups += 1u;
  int at = int(ceil(x_far + min(pixels_m / abs(near_m), float(size_px.x))));
  if (at > last && near_m < 0.0) return false;
  at = min(at, last);
  // From pixel to pixel, as long as the ray is in front of what both sides of the step have seen, or of the one plane that
  // both are of.
  SeenSurfaces surfaces = SeenSurfaces(surfaces_address);
  int row_begin = seen_pixel(ivec3(0, pixel.y, view_index), size_px);
  float depth_m = at < last ? surfaces.v[row_begin + at + 1].depth_m : 0.0;
  for (;; --at) {
    float right = float(at) - x_far, before_m = depth_m;
    bool reached = right <= 0.0;
    if (!reached) {
      answer.lookups += 1u;
      depth_m = surfaces.v[row_begin + at].depth_m;
      reached = right * depth_m <= pixels_m;
    }
    if (!reached && right * before_m > pixels_m) continue;
    if (at == last) return false;
    // Free as far as the pixel before was seen through, less a part of it.
    t_free = pixels_m / ((right + kFreeFrom_px) * view_ray_cosine(second, pixel, size_px));
    SeenSurface here = surfaces.v[row_begin + at], before = surfaces.v[row_begin + at + 1];
    answer.lookups += 2u;
    if (here.answer == kSeenNothing || before.answer == kSeenNothing) return false;
    if (((here.answer ^ before.answer) & kSeenFlags) != 0u) return false;
    answer.tries = 0u;
    answer.environment = (here.answer & kSeenEnvironment) != 0u;
    answer.plane = vec3(0.0);
    answer.probe = int(here.answer & ~kSeenFlags);
    if ((here.answer & kSeenMiss) != 0u) {
      answer.cls = kClassMiss;
      answer.t = PW_NEVER;
      return true;
    }
    if ((here.answer & kSeenUnknown) != 0u) {
      if (here.answer != before.answer) return false;
      answer.cls = kClassUnknown;
      answer.t = (reached ? depth_m : before_m) / view_ray_cosine(second, pixel, size_px);
      return true;
    }
    float t_here = seen_distance(constants.grid, here, second, direction);
    float t_before = seen_distance(constants.grid, before, second, direction);
    if (!(t_here > 0.0 && abs(t_here - t_before) <= kSamePlane * t_here)) return false;
    float hit_px = pixels_m / (t_here * view_ray_cosine(second, pixel, size_px)) - right;
    if (!reached && hit_px <= 0.0) continue;
    if (!(hit_px > -kBeside_px && hit_px < 1.0 + kBeside_px)) return false;
    bool of_here = hit_px < 0.5;
    answer.cls = kClassHit;
    answer.t = of_here ? t_here : t_before;
    answer.probe = int(of_here ? here.answer : before.answer);
    answer.plane = of_here ? here.plane : before.plane;
    return true;
  }
  return false;
}

void main() {
  FrameConstants constants = Frame(frame_address).constants;
  ivec2 size_px = constants.size_px;
  int view_index = 2 * int(gl_WorkGroupID.z) + 1;
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  ivec3 texel = ivec3(pixel, view_index);
  bool inside = all(lessThan(pixel, size_px));
  if (kMasked && inside && is_hidden_tile(constants.hidden_tiles_address, view_index, pixel / 8, size_px)) {
    store_hidden(texel);
    inside = false;
  }
  if (gl_LocalInvocationIndex == 0u) tile_count = 0u;
  barrier();

  float t_free_m = 0.0;
  uint place = 0u;
  bool rest = false;
  if (inside) {
    ViewConstants view = constants.view[view_index];
    vec3 direction = view_ray(view, pixel, size_px);
    RayAnswer answer;
    answer.lookups = 0u;
    rest = !answer_of_first_eye(constants, view_index, pixel, direction, answer, t_free_m);
    if (rest) {
      place = atomicAdd(tile_count, 1u);
      if (kWithAov) imageStore(aov_image, texel, uvec4(0u, 0u, answer.lookups, 0u));
    } else {
      uint reads;
      vec3 radiance = pipeline_radiance(constants.grid, constants.trace, answer, view.origin_hi_m, view.origin_lo_m,
                                        direction, view.pixel_angle_rad, reads);
      store_ray(texel, answer, radiance, constants.trace.radiance_scale, reads);
    }
  }
  // One reservation a tile keeps the list's neighbours neighbours in the picture.
  barrier();
  RestList list = RestList(list_address);
  if (gl_LocalInvocationIndex == 0u && tile_count > 0u) {
    tile_start = atomicAdd(list.head.count, tile_count);
    atomicMax(list.head.groups_x, list_groups(tile_start + tile_count, kInterleave));
  }
  barrier();
  if (!rest) return;
  list.ray[tile_start + place] = RestRay(listed_pixel(texel), t_free_m);
}
