// The body of trace_rays.comp and trace_rays_baseline.comp.
#include "shared/tracer_glsl.h"
#include "shared/ray_batch.h"

layout(local_size_x = 64) in;

// 1: groups take rays in order. T > 1: T equal parts of the dispatch take groups of rays in turn (see trace_stereo.glsl).
// The number of groups must be a multiple of T.
layout(constant_id = 1) const int kInterleave = 1;

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Batch { BatchConstants constants; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Rays { BatchRay v[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer Answers { BatchAnswer v[]; };
layout(push_constant) uniform Push { uvec2 batch_address; };

void main() {
  BatchConstants batch = Batch(batch_address).constants;
  uint part = gl_NumWorkGroups.x / uint(kInterleave);
  uint group = gl_WorkGroupID.x % part * uint(kInterleave) + gl_WorkGroupID.x / part;
  uint index = group * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
  if (index >= batch.ray_count) return;
  BatchRay ray = Rays(batch.rays_address).v[index];
  RayAnswer answer = pipeline_trace(batch.baseline_address, batch.grid, batch.trace, ray.origin_hi_m, ray.origin_lo_m,
                                    ray.unit_direction, vec3(0.0), no_hint());
  BatchAnswer result;
  result.radiance = pipeline_radiance(batch.grid, batch.trace, answer, ray.origin_hi_m, ray.origin_lo_m,
                                      ray.unit_direction, batch.spread_rad, result.attribute_reads);
  result.t_m = answer.t;
  result.answer = answer.cls;
  result.probe = answer.probe;
  result.lookups = answer.lookups;
  result.tries = answer.tries;
  result.reserved = 0u;
  Answers(batch.answers_address).v[index] = result;
}
