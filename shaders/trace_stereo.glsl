// The body of trace_stereo.comp and trace_stereo_baseline.comp.
#include "shared/foveation.h"
#include "shared/seen_surface.h"
#include "shared/tracer_glsl.h"
#include "shared/view_ray.h"
#include "openings.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

// Also write class, probe and counts.
layout(constant_id = 0) const bool kWithAov = false;
// 1: groups take tiles in order. T > 1: T equal parts of the dispatch take rows of tiles in turn, for software devices
// that give each of their threads one contiguous part. The number of rows must be a multiple of T.
layout(constant_id = 1) const int kInterleave = 1;
// Tiles may have one ray for several pixels (foveation.h); fill_blocks.comp fills in the others.
layout(constant_id = 2) const bool kFoveated = false;

// Some tiles are hidden by the headset's optics: black, without rays.
layout(constant_id = 3) const bool kMasked = false;

// Only the first of each pair of views is traced, and what it sees kept for the second (first_eye.glsl).
layout(constant_id = 18) const bool kFirstEyes = false;

layout(binding = 0, rgba16f) writeonly uniform image2DArray radiance_image;
layout(binding = 1, r32f) writeonly uniform image2DArray distance_image;
layout(binding = 2, rgba32ui) writeonly uniform uimage2DArray aov_image;

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Frame { FrameConstants constants; };
layout(push_constant) uniform Push {
  uvec2 frame_address;
  uvec2 unused[2];
  uvec2 openings_address;
  uvec2 surfaces_address;
  uvec2 depths_address;
};

#include "first_eye.glsl"
#include "hidden_tiles.glsl"
#include "store_ray.glsl"

void keep_surface(ivec3 texel, ivec2 size_px, RayAnswer answer, float cosine) {
  SeenSurface surface;
  surface.plane = answer.plane;
  surface.answer = answer.probe < 0 ? kSeenNothing : uint(answer.probe);
  if (answer.cls == kClassMiss) surface.answer |= kSeenMiss;
  if (answer.cls == kClassUnknown) surface.answer |= kSeenUnknown;
  if (answer.environment) surface.answer |= kSeenEnvironment;
  surface.depth_m = answer.cls == kClassMiss ? kSeenFar_m : max(answer.t * cosine, kSeenNear_m);
  SeenSurfaces(surfaces_address).v[seen_pixel(texel, size_px)] = surface;
}

// A ray for each tile of the margin (seen_surface.h). Groups beyond the picture, in every eighth row of them, have eight
// columns of tiles each.
void look_beyond(FrameConstants constants, int view_index, ivec2 group) {
  ivec2 size_px = constants.size_px;
  int columns = seen_columns(size_px), lane = int(gl_LocalInvocationIndex);
  ivec2 tile = ivec2((group.x - columns) * 8 + lane % 8, group.y + lane / 8);
  if (group.y % 8 != 0 || tile.x >= seen_margin(columns) || tile.y * kSeenTile >= size_px.y) return;
  ViewConstants view = constants.view[view_index];
  float pixels_m = eye_pixels_m(view, constants.view[view_index + 1], size_px);
  float depth_m = kSeenFar_m;
  // Not where only what is closer than expected could matter.
  if (float(tile.x * kSeenTile) * kUnseen_m <= pixels_m) {
    vec2 centre_px = (vec2(tile) + 0.5) * float(kSeenTile) + vec2(float(columns * kSeenTile), 0.0);
    RayAnswer answer = pipeline_trace(constants.baseline_address, constants.grid, constants.trace, view.origin_hi_m,
                                      view.origin_lo_m, view_ray_through(view, centre_px, size_px), choice_shift(view),
                                      no_hint());
    if (answer.cls != kClassMiss) depth_m = max(answer.t * view_cosine_through(view, centre_px, size_px), kSeenNear_m);
  }
  SeenDepths(depths_address).v[seen_row(view_index / 2, tile.y, size_px) + columns + tile.x] = depth_m;
}

void main() {
  Frame frame = Frame(frame_address);
  int rows = int(gl_NumWorkGroups.y), row = int(gl_WorkGroupID.z) * rows + int(gl_WorkGroupID.y);
  int part = rows * int(gl_NumWorkGroups.z) / kInterleave;
  row = row % part * kInterleave + row / part;
  int view_index = row / rows * (kFirstEyes ? 2 : 1);
  ivec2 tile_px = ivec2(int(gl_WorkGroupID.x), row % rows) * 8;
  ivec2 size_px = frame.constants.size_px;
  ViewConstants view = frame.constants.view[view_index];
  if (kFirstEyes && tile_px.x >= size_px.x) {
    look_beyond(frame.constants, view_index, tile_px / 8);
    return;
  }
  if (kMasked && tile_px.y < size_px.y &&
      is_hidden_tile(frame.constants.hidden_tiles_address, view_index, tile_px / 8, size_px)) {
    ivec3 texel = ivec3(tile_px + ivec2(gl_LocalInvocationID.xy), view_index);
    if (texel.x >= size_px.x || texel.y >= size_px.y) return;
    store_hidden(texel);
    if (kFirstEyes) {
      SeenSurfaces(surfaces_address).v[seen_pixel(texel, size_px)] = SeenSurface(vec3(0.0), kSeenNothing, kUnseen_m);
    }
    return;
  }
  // A coarse tile's rays are its first lanes', so that the others' parts of the group end at once.
  int rate = kFoveated ? foveation_rate(view, tile_px, frame.constants) : 1;
  int side = kFoveationTile / rate, lane = int(gl_LocalInvocationIndex);
  if (lane >= side * side) return;
  ivec2 pixel = tile_px + ivec2(lane % side, lane / side) * rate;
  if (pixel.x >= size_px.x || pixel.y >= size_px.y) return;

  GridConstants grid = frame.constants.grid;
  TraceConstants dials = frame.constants.trace;
  vec3 direction = view_ray_through(view, vec2(pixel) + 0.5 * float(rate), size_px);
  RayAnswer answer = pipeline_trace(frame.constants.baseline_address, grid, dials, view.origin_hi_m, view.origin_lo_m,
                                    direction, choice_shift(view),
                                    opening_hint(openings_address, view_index, direction));
  uint reads;
  vec3 radiance = pipeline_radiance(grid, dials, answer, view.origin_hi_m, view.origin_lo_m, direction,
                                    view.pixel_angle_rad * float(rate), reads);

  ivec3 texel = ivec3(block_keeper(pixel, rate, size_px), view_index);
  store_ray(texel, answer, radiance, dials.radiance_scale, reads);
  if (kFirstEyes) keep_surface(texel, size_px, answer, view_ray_cosine(view, pixel, size_px));
}
