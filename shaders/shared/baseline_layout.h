// What the baselines of the report of speed against error read beside a pack's probes: texel-centred radial distance,
// normals and conservative pyramids, as the thesis and its successor store them. Made from the scene for a measurement and
// cached (content/baseline/); packs never carry them, and nothing of this is resident unless such a method is asked for.
//
// Maps of a probe of n = 2^n_log2 texels a side; texel (i, j) is centred at u = (2 i + 1) / n - 1, v likewise:
//   distance           n^2 floats: Euclidean distance of the surface seen through the texel's centre; kBaselineSky_m = sky
//   minimum            levels 1 .. n_log2, level l has (n >> l)^2 floats: least distance of the node's texels, each
//                      dilated by its neighbours (one texel around), so that it bounds the surface between the centres
//   normal             n^2 words: unit normal of that surface turned to the probe, octahedral snorm 16 + 16; 0 = sky
#ifndef PROBEWALK_SHADERS_SHARED_BASELINE_LAYOUT_H
#define PROBEWALK_SHADERS_SHARED_BASELINE_LAYOUT_H

#include "dialect.h"

PW_SHARED_BEGIN

// Ways to answer a ray by --method. The numbers are specialisation constants; names: content/baseline/method.h.
PW_CONSTANT int kMethodOat = 0;      // octant-affine, pyramid of w
PW_CONSTANT int kMethodOatFlat = 1;  // the same cell by cell
PW_CONSTANT int kMethodEnvironment = 2;
PW_CONSTANT int kMethodSphereProxy = 3;
PW_CONSTANT int kMethodBoxProxy = 4;
PW_CONSTANT int kMethodImpostor = 5;
PW_CONSTANT int kMethodMarch3d = 6;
PW_CONSTANT int kMethodMarch2d = 7;
PW_CONSTANT int kMethodMarch2dHierarchical = 8;
PW_CONSTANT int kMethodTwoLevel = 9;

// How thick a surface is taken to be by the marches (thesis chapter 7).
PW_CONSTANT int kEpsilonFixed = 0;    // epsilon_m
PW_CONSTANT int kEpsilonDynamic = 1;  // d tan(theta) k: what a texel spans at the surface, as 7.1 should have it
PW_CONSTANT int kEpsilonAngle = 2;    // by the angle between the ray's point and the surface as the probe sees them
PW_CONSTANT float kBaselineSky_m = 1e30f;

struct BaselineRecord {
  pw_uvec2 distance_address;
  pw_uvec2 minimum_address;
  pw_uvec2 normal_address;
  pw_uint n_log2;  // 0 = none
  float mean_m;    // mean of the distances by solid angle: the sphere proxy's radius; 0 = the probe sees sky alone
  pw_vec3 box_min_m;  // of the box proxy, relative to the probe, which is inside
  float reserved0;
  pw_vec3 box_max_m;
  float reserved1;
};

// Dials of the baselines, beside TraceConstants.
struct BaselineConstants {
  pw_uvec2 records_address;  // a BaselineRecord a probe
  float step_m;              // march-3d: length of a step
  float epsilon_m;           // kEpsilonFixed; for kEpsilonDynamic and kEpsilonAngle the factor k
  float epsilon_growth;      // epsilon is multiplied by this for every probe that has failed (1 = never)
  float farthest_m;          // rays end here: a march-3d has no other end; 0 = as far as any probe sees, see baseline_constants_for
  pw_int max_steps;          // of one march through one probe; of the impostor's search for a first bracket
  pw_uint reserved;
};

// What walk_baseline is told beside the ray. On the device all but the constants are specialisation constants.
struct BaselineContext {
  pw_int method;          // kMethodEnvironment and on
  pw_int epsilon_rule;    // kEpsilon...
  pw_int reject_backfaces;
  pw_int backward_trace;
  BaselineConstants constants;
};

PW_SHARED_END

#ifdef __cplusplus
namespace probewalk {
static_assert(sizeof(BaselineRecord) == 64 && sizeof(BaselineConstants) == 32 && sizeof(BaselineContext) == 48);
}  // namespace probewalk
#endif

#endif
