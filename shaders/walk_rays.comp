// A list of rays against one probe: the walk alone, without selection and hand-off.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require

#include "shared/tracer_glsl.h"
#include "shared/walk_batch.h"

layout(local_size_x = 64) in;

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Batch { WalkConstants constants; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Rays { WalkRay v[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer Ends { WalkEnd v[]; };
layout(push_constant) uniform Push { uvec2 batch_address; };

void main() {
  WalkConstants batch = Batch(batch_address).constants;
  uint index = gl_GlobalInvocationID.x;
  if (index >= batch.ray_count) return;
  WalkRay ray = Rays(batch.rays_address).v[index];
  vec3 x = relative_origin(batch.probe, ray.origin_hi_m, ray.origin_lo_m);
  WalkState state = walk_probe(batch.probe, x, ray.direction, ray.t_start, batch.start_level);
  WalkEnd end;
  end.plane = state.plane;
  end.t = state.t;
  end.t_safe = state.t_safe;
  end.status = state.status;
  end.lookups = state.lookups;
  end.reserved = 0u;
  Ends(batch.ends_address).v[index] = end;
}
