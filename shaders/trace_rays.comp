// A list of rays against the resident probes.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require

#include "shared/tracer_glsl.h"
#include "shared/ray_batch.h"

layout(local_size_x = 64) in;

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Batch { BatchConstants constants; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Rays { BatchRay v[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer Answers { BatchAnswer v[]; };
layout(push_constant) uniform Push { uvec2 batch_address; };

void main() {
  BatchConstants batch = Batch(batch_address).constants;
  uint index = gl_GlobalInvocationID.x;
  if (index >= batch.ray_count) return;
  BatchRay ray = Rays(batch.rays_address).v[index];
  RayAnswer answer = trace_ray(batch.grid, batch.trace, pipeline_rules(), ray.origin_hi_m, ray.origin_lo_m,
                               ray.unit_direction, kPipelineStartLevel);
  BatchAnswer result;
  result.radiance = ray_radiance(batch.grid, batch.trace, answer, ray.origin_hi_m, ray.origin_lo_m,
                                 ray.unit_direction, batch.spread_rad, result.attribute_reads);
  result.t_m = answer.t;
  result.answer = answer.cls;
  result.probe = answer.probe;
  result.lookups = answer.lookups;
  result.tries = answer.tries;
  result.reserved = 0u;
  Answers(batch.answers_address).v[index] = result;
}
