// The shared tracer on the device. The including shader enables GL_EXT_buffer_reference, GL_EXT_buffer_reference_uvec2
// and GL_EXT_scalar_block_layout. Every float operation of the module is decorated NoContraction when it is built
// (shaders/CMakeLists.txt), so the arithmetic is the C++ one's. With PW_BASELINES defined the module traces by the methods
// that the product is measured against.
#ifndef PROBEWALK_SHADERS_SHARED_TRACER_GLSL_H
#define PROBEWALK_SHADERS_SHARED_TRACER_GLSL_H

#include "baseline_layout.h"
#include "probe_layout.h"
#include "selection_rules.h"

#define real float
#define real2 vec2
#define real3 vec3
#define PW_OUT(type) out type
#define PW_INOUT(type) inout type

layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer PwWords { uint v[]; };
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer PwProbes { ProbeRecord v[]; };

uint pw_word(uvec2 address, int index) { return PwWords(address).v[index]; }
float pw_word_real(uvec2 address, int index) { return uintBitsToFloat(PwWords(address).v[index]); }
float pw_float_from_bits(uint bits) { return uintBitsToFloat(bits); }
ProbeRecord pw_probe(GridConstants grid, int index) { return PwProbes(grid.probes_address).v[index]; }

#ifdef PW_BASELINES
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer PwBaselines { BaselineRecord v[]; };
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer PwBaselineDials { BaselineConstants v; };
BaselineRecord pw_baseline(BaselineConstants constants, int index) {
  return PwBaselines(constants.records_address).v[index];
}
#endif

// Whether any probe can have its samples in tiles; fixed when a pipeline is made, so that floats alone cost nothing
// more.
layout(constant_id = 17) const int kTiledSamples = 1;
#define PW_MAY_TILE (kTiledSamples != 0)

#include "tracer.h"
#include "tracer_radiance.h"
#ifdef PW_BASELINES
#include "baseline_radiance.h"
#endif

// What a pipeline traces with is fixed when it is made (render/tracer_choice.h): pyramid level of the first look, 0 = cell
// by cell, and the rules of selection. Lower numbers are each shader's own.
layout(constant_id = 4) const int kPipelineStartLevel = kStartLevel;
layout(constant_id = 5) const int kRuleFirst = kFirstSignedLessDistance;
layout(constant_id = 6) const int kRuleOrder = kOrderSorted;
layout(constant_id = 7) const int kRuleAdvance = 1;
layout(constant_id = 8) const int kRuleRetry = 1;
layout(constant_id = 9) const int kRuleStartTest = 1;
layout(constant_id = 10) const int kRuleHandOn = 1;
layout(constant_id = 11) const int kRuleLastResort = kLastResortStopPoint;

// choice_shift_m: see SelectionRules.
SelectionRules pipeline_rules(vec3 choice_shift_m) {
  SelectionRules rules;
  rules.first = kRuleFirst;
  rules.order = kRuleOrder;
  rules.advance = kRuleAdvance;
  rules.retry = kRuleRetry;
  rules.start_test = kRuleStartTest;
  rules.hand_on = kRuleHandOn;
  rules.last_resort = kRuleLastResort;
  rules.choice_shift_m = choice_shift_m;
  return rules;
}

// A ray's answer and its radiance as the pipeline traces. baseline_address: of BaselineConstants. hint: see trace_ray.
#ifdef PW_BASELINES
layout(constant_id = 12) const int kBaselineMethod = kMethodEnvironment;
layout(constant_id = 13) const int kBaselineEpsilonRule = kEpsilonFixed;
layout(constant_id = 14) const int kBaselineRejectBackfaces = 0;
layout(constant_id = 15) const int kBaselineBackwardTrace = 0;

RayAnswer pipeline_trace(uvec2 baseline_address, GridConstants grid, TraceConstants dials, vec3 origin_hi,
                         vec3 origin_lo, vec3 direction, vec3 choice_shift_m, RayHint hint) {
  BaselineContext context;
  context.method = kBaselineMethod;
  context.epsilon_rule = kBaselineEpsilonRule;
  context.reject_backfaces = kBaselineRejectBackfaces;
  context.backward_trace = kBaselineBackwardTrace;
  // An environment map needs no constants, and may be given none.
  if (kBaselineMethod != kMethodEnvironment) context.constants = PwBaselineDials(baseline_address).v;
  return trace_ray(context, grid, dials, pipeline_rules(choice_shift_m), origin_hi, origin_lo, direction, kPipelineStartLevel,
                   hint);
}

vec3 pipeline_radiance(GridConstants grid, TraceConstants dials, RayAnswer answer, vec3 origin_hi, vec3 origin_lo,
                       vec3 direction, float pixel_angle, out uint reads) {
  return baseline_radiance(kBaselineMethod, grid, dials, answer, origin_hi, origin_lo, direction, pixel_angle, reads);
}
#else
RayAnswer pipeline_trace(uvec2 baseline_address, GridConstants grid, TraceConstants dials, vec3 origin_hi,
                         vec3 origin_lo, vec3 direction, vec3 choice_shift_m, RayHint hint) {
  return trace_ray(grid, dials, pipeline_rules(choice_shift_m), origin_hi, origin_lo, direction, kPipelineStartLevel,
                   hint);
}

vec3 pipeline_radiance(GridConstants grid, TraceConstants dials, RayAnswer answer, vec3 origin_hi, vec3 origin_lo,
                       vec3 direction, float pixel_angle, out uint reads) {
  return ray_radiance(grid, dials, answer, origin_hi, origin_lo, direction, pixel_angle, reads);
}
#endif

#endif
