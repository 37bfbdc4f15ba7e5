// What the entries of a probe's pyramid say about its samples (layout: probe_layout.h). The device builds it when a
// level arrives (shaders/build_pyramid_*.comp), the host where it traces by itself (content/probe/pyramid.h): to the
// bit the same pyramid where both round to nearest, and a sound one however a device rounds.
#ifndef PROBEWALK_SHADERS_SHARED_PYRAMID_BUILD_H
#define PROBEWALK_SHADERS_SHARED_PYRAMID_BUILD_H

#include "probe_layout.h"

PW_SHARED_BEGIN

// One pass over a part of one level, as the shaders are pushed it (render/pipeline.h: PushConstants).
// `level_of`: level | n_log2 << 8 | tiled samples << 16. `first`: word of the level that the first group, or its first
// thread, makes.
PW_CONSTANT int kCellsGroup = 64;  // threads of build_pyramid_cells.comp, a word each
PW_CONSTANT int kNodesGroup = 64;  // threads of build_pyramid_nodes.comp, for one word together

// The 15-bit code of w, given by its bits (at least +0, finite), rounded up: what it decodes to is at least w. 0 for 0.
// Codes are in the order of what they stand for, so that the code of a maximum is the maximum of the codes.
PW_FUNCTION pw_uint pyramid_code(pw_uint w_bits) {
  if (w_bits == 0u) return 0u;
  pw_uint upper = (w_bits + 0x3fffu) >> 14;
  if (upper < kEntryBase + 1u) return 1u;
  return upper > kEntryBase + 32767u ? 32767u : upper - kEntryBase;
}

// How far off the float arithmetic of lies_on_plane can be, whichever neighbour its operations round to: each is off by
// 2^-23 of its result at most, and three of them enter by either slope, one by the sum; a quarter is added for the
// rounding of the bound itself.
PW_CONSTANT float kSlopeRounding = 3.874301910400390625e-7f;   // 3.25 * 2^-23
PW_CONSTANT float kSampleRounding = 1.490116119384765625e-7f;  // 1.25 * 2^-23

// Whether w = `here` of the vertex at (a, b) surely lies within kPlanarTolerance of the plane that is `corner` at (0,
// 0) and rises by `along_u` and `along_v` a step. Never for sky, which is no plane: it is skipped by its maximum.
PW_FUNCTION bool lies_on_plane(float corner, float along_u, float along_v, float a, float b, float here) {
  if (!(here > 0.0f)) return false;
  float by_u = along_u * a, by_v = along_v * b;
  float off = corner + (by_u + by_v) - here;
  float slopes = (by_u < 0.0f ? -by_u : by_u) + (by_v < 0.0f ? -by_v : by_v);
  float bound = kPlanarTolerance * here - (kSlopeRounding * slopes + kSampleRounding * here);
  return (off < 0.0f ? -off : off) <= bound;
}

PW_SHARED_END

#endif
