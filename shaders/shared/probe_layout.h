// How probes lie in device memory. The loader builds these words from a pack (content/probe/device_probe.h), so every
// index in them is our own: nothing that a pack says is used as an address.
//
// Geometry block of a probe of n = 2^n_log2 cells a side, in 32-bit words:
//   samples            w at the vertices; exactly 0 = sky. As floats:
//     (n+1)^2            float bits, row-major
//     (padding)          up to a multiple of 8 words
//                      or, where flags bit 1 is set, tile by tile in fewer bits:
//     (n/8+1)^2 * 12     tiles of 8 x 8 cells, row-major; a tile holds all its cells' 9 x 9 vertices. Of those in the
//                        last row and column there is only the first vertex:
//       [0]                w at its first vertex, float bits
//       [1]                key: bits 0..3 how many octaves finer than the last place of [0] the unit is; the rest:
//                          slope along x, in 1/8 unit a vertex. Or bits 0..3 are kTileOfFloats; the rest: word of the block
//                          where the tile's samples lie as floats
//       [2]                slope along y
//       [3..11]            rows: for each of the 9 vertices 3 bits, low ones first; bits 27..31 are signed and
//                          common to all
//                      w = ([0] in units + ((slope_x x + slope_y y) >> 3) + common + own) * unit
//     (padding)          up to a multiple of 8 words
//   pyramid            levels 1, 3, 5 .. up to n_log2-3, level l has (n >> l)^2 entries of 16 bits, in nodes of 4 x 4
//                      entries (8 words, so that one read of 32 aligned bytes serves two levels of a binary pyramid);
//                      nodes row-major, entries row-major in their node, the even one in the low half. An entry stands
//                      for 2^l x 2^l cells:
//                        bits 0..14  code of the maximum of w over it, rounded up (pyramid_build.h), cut cells counted
//                                    with their extension (1 + 2 kSlopeClamp); 0 = nothing but sky
//                        bit 15      planar: no cut, the entries below planar too, and w at all its vertices lies
//                                    within kPlanarTolerance of the plane through its corners next to the map's centre:
//                                    the ray meets that instead of the cells
//   n^2/32 * 2         per 32 cells: mask of cells with a cut, number of such cells before
//   5 per cut cell     cut record, quadrant-local (cell corner nearest the map's centre is (0, 0)):
//     [0] the edges (0,0)-(1,0), (0,0)-(0,1), (1,0)-(0,1), (1,0)-(1,1), (0,1)-(1,1) as digits to base kEdgeCodes,
//         lowest first: 0 = connected, else 1 + the fraction of the cut in 1/64, rounded down
//     [1..4] corners (0,0), (1,0), (0,1), (1,1): the surface's slopes dw per cell step along U and V, snorm16 pair in
//         units of kSlopeClamp * w(corner). A cell on the fold, whose two triangles are in octants of their own, has in
//         [4] how many words behind [0] those of (1,0), (0,1) and (1,1) in the high triangle's octant are instead
//   3 per cut cell on the fold: those
//   81 per tile of floats: w at its vertices, float bits, row-major
//
// Radiance block of a probe of r = 2^r_log2 texels a side:
//   mip chain          E5B9G9R9 words, finest first, down to 1x1
//   r^2/2              log-coded w of the surface that each texel's centre sees, two a word, even texel in the low half
#ifndef PROBEWALK_SHADERS_SHARED_PROBE_LAYOUT_H
#define PROBEWALK_SHADERS_SHARED_PROBE_LAYOUT_H

#include "dialect.h"

PW_SHARED_BEGIN

// Largest slope of a cut triangle's plane, as a fraction of w a cell step. Beyond it a vertex's normal extrapolates
// worse than a flat piece does (design: tracer, 3.1).
PW_CONSTANT float kSlopeClamp = 0.05f;
// kSlopeClamp / 32767, one snorm16 step. Written out: GLSL compilers fold constants in double, C++ in float.
PW_CONSTANT float kSlopeStep = 1.52592547e-6f;
// A cut cell's maximum counts this much more, so that no extended piece sticks out of its pyramid node.
PW_CONSTANT float kCutExtension = 1.1001f;
// Highest level of the pyramid that a walk looks at (odd).
PW_CONSTANT int kStartLevel = 5;
// Added to a walk's level: planar entries are gone through cell by cell all the same, which gives the very bits of a
// walk without a pyramid.
PW_CONSTANT int kWithoutPlanes = 16;
PW_CONSTANT int kCutRecordWords = 5;
PW_CONSTANT int kFoldRecordWords = 3;
PW_CONSTANT pw_uint kEdgeCodes = 65u;
// Flags of a ProbeRecord.
PW_CONSTANT pw_uint kFlagCuts = 1u;
PW_CONSTANT pw_uint kFlagTiledSamples = 2u;
// Cells along the side of a tile of samples: as many as an entry of the pyramid's level 3 stands for.
PW_CONSTANT int kDeviceTileLog2 = 3;
PW_CONSTANT int kDeviceTileSide = 8;
PW_CONSTANT int kDeviceTileWords = 12;
PW_CONSTANT pw_uint kTileOfFloats = 15u;
// Largest half float, which pictures are made of. Radiance is stored times radiance_scale, so that only a source
// brighter than any texel meets it.
PW_CONSTANT float kPictureMax = 65504.0f;
// Relative to w. Beyond what floats hold of it, so that walls are planar.
PW_CONSTANT float kPlanarTolerance = 2e-6f;
// By how much of itself a distance may change when one plane stands for many cells; where a ray comes so flatly that it
// could be more, or so close that it could be a hit or none, the cells decide.
PW_CONSTANT float kPlaneError = 1e-5f;
PW_CONSTANT pw_uint kEntryPlanar = 0x8000u;
// Entries hold w from 2^-32 on, 512 steps an octave: code + kEntryBase are the upper 18 bits of the float.
PW_CONSTANT pw_uint kEntryBase = 48640u;

// Answers of a ray.
PW_CONSTANT int kClassHit = 0;
PW_CONSTANT int kClassMiss = 1;
PW_CONSTANT int kClassUnknown = 2;

struct ProbeRecord {
  pw_vec3 position_hi_m;  // position rounded to float
  float l_min_m;          // the octahedron of this L1 radius around the probe is empty; 0 = no limit known
  pw_vec3 position_lo_m;  // what the rounding left, so that differences to nearby points are exact to one ulp
  pw_uint n_log2;         // 0 = not resident
  pw_uvec2 geometry_address;
  pw_uvec2 radiance_address;
  pw_uvec2 coarse_radiance_address;  // of the level that this one replaces, while coarse_share > 0
  pw_uint r_log2;                    // bits 0..7; bits 8..15: that of the coarse radiance
  pw_uint flags;  // bit 0: has cuts; bit 1: samples in tiles; bits 16..31: coarse_share, in 1/65535 of the radiance
};

// The building's probe grid: vertex (x, y, z) at origin + spacing * (x, y, z) is served by probe table[(z dy + y) dx +
// x].
struct GridConstants {
  pw_vec3 origin_m;
  float spacing_mean_m;  // geometric mean of the three spacings
  pw_vec3 spacing_m;
  float inverse_diagonal;  // 1 / |spacing|
  pw_ivec3 dims;
  pw_uint probe_count;
  pw_uvec2 table_address;   // pw_uint per vertex
  pw_uvec2 probes_address;  // ProbeRecord per probe
};

// Dials of the tracer that change at run time.
struct TraceConstants {
  float distance_weight;  // score = cosine - distance_weight * distance / diagonal: 1 in rooms, 4 in clutter
  float start_margin;     // a start within this fraction behind the nearest vertex still counts as in front
  pw_int max_tries;       // walks a ray, then the stop point is the answer
  float radiance_scale;   // stored radiance = cd/m^2 * radiance_scale
};

// One eye. Pixel (x, y) of a view looks along world_from_eye * (left + (x+.5)/width (right-left), ..., -1).
struct ViewConstants {
  pw_vec3 origin_hi_m;
  float pixel_angle_rad;  // angular width of the centre pixel
  pw_vec3 origin_lo_m;
  float choice_shift_m;      // along the eye's x axis to where its rays' probes are chosen (SelectionRules): the head's
                             // middle
  pw_vec4 world_from_eye_x;  // columns of the rotation
  pw_vec4 world_from_eye_y;
  pw_vec4 world_from_eye_z;
  pw_vec4 tan_angles;  // tangents of fov: left, right, up, down (left and down negative)
};

PW_CONSTANT int kMaxViews = 4;

// Written just before submit (late pose), read by trace_stereo.glsl, resolve.frag and depth.frag.
struct FrameConstants {
  GridConstants grid;
  TraceConstants trace;
  pw_ivec2 size_px;  // of each view
  pw_int view_count;
  float exposure;  // 2^-ev-like factor: cd/m^2 * exposure = 1 is display white before the tone curve
  float fade;      // 0 = picture, 1 = black
  pw_uint frame_index;
  float near_m;  // planes of the depth written, see view_depth.h
  float far_m;
  ViewConstants view[4];
  pw_uvec2 baseline_address;  // of BaselineConstants, for trace_stereo_baseline.comp and sample_edges_baseline.comp
  // Rays at an angle from the view's axis of at least this cosine are one a pixel; at least the next, one of 2 x 2
  // pixels; the rest one of 4 x 4 (foveation.h). Without foveation both are 0.
  float full_rate_cosine;
  float half_rate_cosine;
  pw_uvec2 hidden_tiles_address;  // of what shaders/hidden_tiles.glsl reads; with a visibility mask only
};

PW_SHARED_END

#ifdef __cplusplus
namespace probewalk {
static_assert(sizeof(ProbeRecord) == 64 && sizeof(GridConstants) == 64 && sizeof(ViewConstants) == 96);
static_assert(sizeof(FrameConstants) == 64 + 16 + 32 + 4 * 96 + 24);
}  // namespace probewalk
#endif

#endif
