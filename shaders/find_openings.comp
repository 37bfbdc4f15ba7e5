// What the first probe of each view's rays is chosen from (openings.glsl): a group a view, a lane a corner.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require

#include "shared/tracer_glsl.h"
#include "shared/view_ray.h"

layout(local_size_x = PW_CANDIDATES) in;

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Frame { FrameConstants constants; };
layout(buffer_reference, scalar, buffer_reference_align = 16) writeonly buffer Openings { CandidatePlace v[]; };
layout(push_constant) uniform Push {
  uvec2 frame_address;
  uvec2 unused[2];
  uvec2 openings_address;
};

void main() {
  Frame frame = Frame(frame_address);
  GridConstants grid = frame.constants.grid;
  int view_index = int(gl_WorkGroupID.x), corner = int(gl_LocalInvocationID.x);
  ViewConstants view = frame.constants.view[view_index];
  vec3 from = view.origin_hi_m + choice_shift(view);
  Openings(openings_address).v[view_index * PW_CANDIDATES + corner] =
      candidate_place(grid, frame.constants.trace, kRuleFirst, cell_of_point(grid, from), from, corner);
}
