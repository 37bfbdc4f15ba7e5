// Rays in, answers out, of trace_rays.comp.
#ifndef PROBEWALK_SHADERS_SHARED_RAY_BATCH_H
#define PROBEWALK_SHADERS_SHARED_RAY_BATCH_H

#include "dialect.h"
#include "probe_layout.h"

PW_SHARED_BEGIN

struct BatchRay {
  pw_vec3 origin_hi_m;
  float reserved0;
  pw_vec3 origin_lo_m;
  float reserved1;
  pw_vec3 unit_direction;
  float reserved2;
};

struct BatchAnswer {
  pw_vec3 radiance;  // cd/m^2
  float t_m;         // of a hit; of an unknown the distance to which the ray is known to be free; 1e30 of a miss
  pw_int answer;     // kClassHit, kClassMiss, kClassUnknown
  pw_int probe;      // that answered; -1 = none
  pw_uint lookups;
  pw_uint tries;
  pw_uint attribute_reads;
  pw_uint reserved;
};

// What trace_rays.comp and trace_rays_baseline.comp are given, by address.
struct BatchConstants {
  GridConstants grid;
  TraceConstants trace;
  pw_uvec2 rays_address;
  pw_uvec2 answers_address;
  pw_uint ray_count;
  float spread_rad;
  pw_uvec2 baseline_address;  // of BaselineConstants, for trace_rays_baseline.comp
};

PW_SHARED_END

#ifdef __cplusplus
namespace probewalk {
static_assert(sizeof(BatchRay) == 48 && sizeof(BatchAnswer) == 40 && sizeof(BatchConstants) == 64 + 16 + 32);
}  // namespace probewalk
#endif

#endif
