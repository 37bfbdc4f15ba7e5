// The body of trace_stereo.comp and trace_stereo_baseline.comp.
#include "shared/foveation.h"
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

layout(binding = 0, rgba16f) writeonly uniform image2DArray radiance_image;
layout(binding = 1, r32f) writeonly uniform image2DArray distance_image;
layout(binding = 2, rgba32ui) writeonly uniform uimage2DArray aov_image;

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Frame { FrameConstants constants; };
layout(push_constant) uniform Push {
  uvec2 frame_address;
  uvec2 unused[2];
  uvec2 openings_address;
};

#include "hidden_tiles.glsl"

const float kHiddenDistance_m = 1e30;  // as of a miss

void main() {
  Frame frame = Frame(frame_address);
  int rows = int(gl_NumWorkGroups.y), row = int(gl_WorkGroupID.z) * rows + int(gl_WorkGroupID.y);
  int part = rows * int(gl_NumWorkGroups.z) / kInterleave;
  row = row % part * kInterleave + row / part;
  int view_index = row / rows;
  ivec2 tile_px = ivec2(int(gl_WorkGroupID.x), row % rows) * 8;
  ivec2 size_px = frame.constants.size_px;
  ViewConstants view = frame.constants.view[view_index];
  if (kMasked && tile_px.y < size_px.y &&
      is_hidden_tile(frame.constants.hidden_tiles_address, view_index, tile_px / 8, size_px)) {
    ivec3 texel = ivec3(tile_px + ivec2(gl_LocalInvocationID.xy), view_index);
    if (texel.x >= size_px.x || texel.y >= size_px.y) return;
    imageStore(radiance_image, texel, vec4(0.0, 0.0, 0.0, 1.0));
    imageStore(distance_image, texel, vec4(kHiddenDistance_m));
    if (kWithAov) imageStore(aov_image, texel, uvec4(uint(kClassMiss), 0xffffffffu, 0u, 0u));
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
                                    opening_probe(openings_address, view_index, direction));
  uint reads;
  vec3 radiance = pipeline_radiance(grid, dials, answer, view.origin_hi_m, view.origin_lo_m, direction,
                                    view.pixel_angle_rad * float(rate), reads);

  ivec3 texel = ivec3(block_keeper(pixel, rate, size_px), view_index);
  imageStore(radiance_image, texel, vec4(min(radiance * dials.radiance_scale, vec3(kPictureMax)), 1.0));
  imageStore(distance_image, texel, vec4(answer.t));
  if (kWithAov) {
    imageStore(aov_image, texel,
               uvec4(uint(answer.cls), uint(answer.probe), answer.lookups, answer.tries | 1u << 8 | reads << 16));
  }
}
