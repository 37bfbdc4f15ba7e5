// One ray against one probe by a method that the product is measured against, each as its source describes it. Included by
// tracer.h where PW_BASELINES is defined; same dialect, no include guard.
#include "baseline_marches.h"

// Iterations of the impostor's secant search. Planes need one; the paper finds that two or three do elsewhere.
#define PW_IMPOSTOR_SECANTS 4

// Distance stored in the texel that the direction of q falls into.
PW_FUNCTION real baseline_distance(BaselineRecord map, real3 q) {
  int n = 1 << int(map.n_log2);
  real2 uv = (octahedral_uv(q) + real2(1, 1)) * (real(n) * real(0.5));
  int i = min(max(int(uv.x), 0), n - 1), j = min(max(int(uv.y), 0), n - 1);
  return pw_word_real(map.distance_address, j * n + i);
}

PW_FUNCTION real baseline_texel_nearness(BaselineRecord map, int i, int j) {
  real distance = pw_word_real(map.distance_address, folded_texel(i, j, 1 << int(map.n_log2)));
  return distance < real(kBaselineSky_m) ? real(1) / distance : real(0);
}

// Reciprocal of the stored distance in the direction of q, filtered between the four texels around; 0 = sky.
PW_FUNCTION real baseline_nearness(BaselineRecord map, real3 q) {
  int n = 1 << int(map.n_log2);
  real2 at = (octahedral_uv(q) + real2(1, 1)) * (real(n) * real(0.5)) - real2(0.5, 0.5);
  real2 corner = floor(at);
  real2 part = at - corner;
  int i = int(corner.x), j = int(corner.y);
  real low = baseline_texel_nearness(map, i, j) * (real(1) - part.x) + baseline_texel_nearness(map, i + 1, j) * part.x;
  real high =
      baseline_texel_nearness(map, i, j + 1) * (real(1) - part.x) + baseline_texel_nearness(map, i + 1, j + 1) * part.x;
  return low * (real(1) - part.y) + high * part.y;
}

// The probe as an environment map (Blinn and Newell 1976): what it sees in the ray's direction is the answer, as if all
// were infinitely far. The distance is the one that the probe itself sees there. Reads the pack's own samples.
PW_FUNCTION WalkState walk_environment(ProbeRecord probe, real3 d, real t_start) {
  real w = nearest_vertex_w(probe, d);
  WalkState state = walk_state(w > real(0) ? kClassHit : kClassMiss, PW_NEVER, t_start);
  if (w > real(0)) state.t = real(1) / (w * (abs(d.x) + abs(d.y) + abs(d.z)));
  state.lookups = 1u;
  return state;
}

// The answer of a proxy that the ray leaves at t: sky where the probe sees sky there. A proxy is seen from inside: of rays
// that start elsewhere it says nothing.
PW_FUNCTION WalkState proxy_answer(BaselineRecord map, real3 x, real3 d, real t, real t_start) {
  if (!(t > t_start)) return walk_state(kClassUnknown, t_start, t_start);
  real3 q = x + d * t;
  bool sky = !(baseline_distance(map, q) < real(kBaselineSky_m));
  WalkState state = walk_state(sky ? kClassMiss : kClassHit, sky ? PW_NEVER : t, t_start);
  state.lookups = 1u;
  return state;
}

// The probe as a sphere around it (Bjorke 2004), of its mean distance.
PW_FUNCTION WalkState walk_sphere_proxy(BaselineRecord map, real3 x, real3 d, real t_start) {
  real radius = real(map.mean_m);
  if (!(radius > real(0))) return walk_state(kClassMiss, PW_NEVER, t_start);
  real along = x.x * d.x + x.y * d.y + x.z * d.z;
  real beyond = x.x * x.x + x.y * x.y + x.z * x.z - radius * radius;
  if (beyond > real(0)) return walk_state(kClassUnknown, t_start, t_start);
  // The farther root, by the form in which nothing cancels.
  real root = sqrt(along * along - beyond);
  real t = along > real(0) ? -beyond / (along + root) : root - along;
  return proxy_answer(map, x, d, t, t_start);
}

// The probe as the box of its room (Bjorke 2004): the ray is followed to the box's inside, and that point looked at from
// the probe.
PW_FUNCTION WalkState walk_box_proxy(BaselineRecord map, real3 x, real3 d, real t_start) {
  if (!(map.mean_m > 0.0f)) return walk_state(kClassMiss, PW_NEVER, t_start);
  real3 low = real3(map.box_min_m), high = real3(map.box_max_m);
  real leave = PW_NEVER;
  for (int axis = 0; axis < 3; ++axis) {
    real at = axis == 0 ? x.x : axis == 1 ? x.y : x.z, slope = axis == 0 ? d.x : axis == 1 ? d.y : d.z;
    real from = axis == 0 ? low.x : axis == 1 ? low.y : low.z, to = axis == 0 ? high.x : axis == 1 ? high.y : high.z;
    if (at < from || at > to) return walk_state(kClassUnknown, t_start, t_start);
    if (abs(slope) < real(1e-20)) continue;
    leave = min(leave, ((slope > real(0) ? to : from) - at) / slope);
  }
  return proxy_answer(map, x, d, leave, t_start);
}

// The probe as a distance impostor (Szirmay-Kalos, Aszodi, Lazanyi, Premecz 2005): a linear search for two points of the
// ray, one in front of the stored surface, one behind, then the secant through them, again and again. The ray's points are
// r = q / (1 - s) with q = (1 - s) x + s L d, s from 0 at its start to 1 at infinity; there the surface's equation
// |r| = distance(r), times 1 - s, is |q| / distance(q) = 1 - s, of which both sides are linear in s where the surface is a
// plane: a secant meets planes exactly. What it converges to at an outline is anybody's guess, as its source says.
PW_FUNCTION WalkState walk_impostor(BaselineRecord map, real3 x, real3 d, real t_start, int steps) {
  WalkState state = walk_state(kClassMiss, PW_NEVER, t_start);
  const real scale = real(map.mean_m);
  if (!(scale > real(0))) return state;
  const real3 first = x + d * t_start;
  real in_front = real(0), behind = real(1);     // s of the bracket's ends
  real f_in_front = real(-1), f_behind = real(0);  // |q| / distance(q) - (1 - s) there: negative in front
  bool found = false;
  // k = 0 is the start itself; the last step is infinity.
  for (int k = 0; k <= steps + PW_IMPOSTOR_SECANTS; ++k) {
    if (k > steps && !found) break;
    real s = found ? in_front + (behind - in_front) * (f_in_front / (f_in_front - f_behind)) : real(k) / real(steps);
    real3 q = first * (real(1) - s) + d * (scale * s);
    real len1 = abs(q.x) + abs(q.y) + abs(q.z);
    real nearness = real(0);
    if (len1 > real(1e-15)) {
      nearness = baseline_nearness(map, q);
      state.lookups += 1u;
    }
    real f = sqrt(q.x * q.x + q.y * q.y + q.z * q.z) * nearness - (real(1) - s);
    if (k == 0 && f > real(0)) {
      state.status = PW_CLASS_BEHIND;
      state.t = t_start;
      return state;
    }
    bool is_behind = f > real(0);
    if (is_behind) {
      behind = s;
      f_behind = f;
    } else {
      in_front = s;
      f_in_front = f;
    }
    // Once both ends are known the linear search is over: what is left of k counts secants.
    if (is_behind && !found) {
      found = true;
      k = steps;
    }
  }
  if (!found) return state;
  real s = in_front + (behind - in_front) * (f_in_front / (f_in_front - f_behind));
  state.status = kClassHit;
  state.t = min(t_start + scale * s / max(real(1) - s, real(1e-12)), PW_NEVER);
  return state;
}

// The thickness grows with every probe that has failed (thesis 7.1: for a better chance of some hit).
PW_FUNCTION MarchRules march_rules(BaselineContext context, int failures) {
  MarchRules rules;
  rules.epsilon_rule = context.epsilon_rule;
  rules.reject_backfaces = context.reject_backfaces != 0;
  rules.backward_trace = context.backward_trace != 0;
  rules.epsilon_m = real(context.constants.epsilon_m);
  for (int k = 0; k < failures; ++k) rules.epsilon_m = rules.epsilon_m * real(context.constants.epsilon_growth);
  rules.step_m = real(context.constants.step_m);
  rules.farthest_m = real(context.constants.farthest_m);
  rules.max_steps = context.constants.max_steps;
  return rules;
}

// The walk that trace_ray makes of a ray x + t d, t >= t_start, through the probe of number `id`, `failures` probes after
// the first. Statuses as walk_probe's.
PW_FUNCTION WalkState walk_baseline(BaselineContext context, ProbeRecord probe, int id, real3 x, real3 d, real t_start,
                                    int failures) {
  if (context.method == kMethodEnvironment) return walk_environment(probe, d, t_start);
  BaselineRecord map = pw_baseline(context.constants, id);
  if (context.method == kMethodSphereProxy) return walk_sphere_proxy(map, x, d, t_start);
  if (context.method == kMethodBoxProxy) return walk_box_proxy(map, x, d, t_start);
  if (context.method == kMethodImpostor) return walk_impostor(map, x, d, t_start, context.constants.max_steps);
  MarchRules rules = march_rules(context, failures);
  if (context.method == kMethodMarch3d) return march_3d(map, rules, x, d, t_start);
  if (context.method == kMethodTwoLevel) return march_two_level(map, rules, x, d, t_start);
  return march_2d(map, rules, x, d, t_start, context.method == kMethodMarch2dHierarchical);
}
