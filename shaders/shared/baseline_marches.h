// The marches that the octant-affine walk is measured against, each as its source describes it: one ray against one
// probe's map of radial distances (baseline_layout.h).
//   march_3d         points at a fixed step along the ray (Donow 2016, 4.2, algorithms 1 to 3)
//   march_2d         every texel of the octahedral map that the ray crosses (5.6); or, with the same answers, past whole
//                    nodes of the pyramid of minima (5.6, 9.1)
//   march_two_level  texels of a map of minima, 16 times coarser, and where one may hold a hit, its fine texels
//                    (McGuire, Mara, Nowrouzezahrai, Luebke 2017, Precomputed light field probes)
// Included after tracer_walk.h, whose WalkState, first_octant and next_octant it uses. No include guard: C++
// includes it once a type.
//
// A texel is taken for a piece of the sphere of its distance. A line between two texels is a plane through the probe,
// so the ray crosses it at one t, which is computed from the line's number alone: it is the same whichever nodes were
// skipped, and nothing needs a clip near the probe. From finite rays the marches form no NaN; each turn moves on by a
// texel or down a level, and max_steps and farthest_m end what data or dials would not.

struct MarchRules {
  int epsilon_rule;       // kEpsilon...
  bool reject_backfaces;  // a surface whose stored normal faces along the ray is no hit (thesis 7.2)
  bool backward_trace;    // after such a surface the next probe takes up the ray epsilon before it, not at its start
  real epsilon_m;         // kEpsilonFixed: metres; else the factor k. Already grown for the probes that have failed
  real step_m;            // march_3d
  real farthest_m;        // a ray that is free to here is a miss
  int max_steps;          // of one march; beyond, the rest of the ray is unknown
};

// Farthest end that can be squared in single precision.
#define PW_FARTHEST real(1e15)
// What a mean texel's diagonal spans at unit distance, times the texels a side: sqrt(8 pi). The thesis's theta is a
// picture element's angle (figure 7.2); the maps' own is the finest that they can keep.
#define PW_TEXEL_DIAGONAL real(5.0132565)
// Level of the coarse map of march_two_level: a factor of 16.
#define PW_COARSE_LEVEL 4
// march_2d's nodes are at most the map's side over 16, where it first looks: fewest look-ups in rooms, at 128 to 2048
// texels a side alike, and what makes their number grow with the logarithm of the side.
#define PW_TOP_BELOW_MAP 4

// Offset of level l >= 1 of the pyramid of minima, in words: the levels before it have n^2/4 + n^2/16 + ...
PW_FUNCTION int minimum_level_offset(int n, int level) {
  int finer = n >> (level - 1);
  return (n * n - finer * finer) / 3;
}

PW_FUNCTION real length_of(real3 v) {
  return sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
}
PW_FUNCTION real dot_of(real3 a, real3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

// Unit normal from its word: octahedral, two snorm 16, u in the low half.
PW_FUNCTION real3 stored_normal(BaselineRecord map, int texel, PW_INOUT(pw_uint) lookups) {
  pw_uint word = pw_word(map.normal_address, texel);
  lookups += 1u;
  real u = max(real(int(word << 16) >> 16) / real(32767), real(-1));
  real v = max(real(int(word) >> 16) / real(32767), real(-1));
  real z = real(1) - abs(u) - abs(v);
  real fold = max(-z, real(0));
  real3 normal = real3(u + (u >= real(0) ? -fold : fold), v + (v >= real(0) ? -fold : fold), z);
  return normal * (real(1) / length_of(normal));
}

// Most that the rules can let a surface be thick which is answered from_origin_m along the ray.
PW_FUNCTION real greatest_thickness(BaselineRecord map, MarchRules rules, real from_origin_m) {
  if (rules.epsilon_rule == kEpsilonFixed) return rules.epsilon_m;
  real factor = rules.epsilon_rule == kEpsilonDynamic ? real(2) : real(1);
  return factor * rules.epsilon_m * (PW_TEXEL_DIAGONAL / real(1 << int(map.n_log2))) * from_origin_m;
}

// Is the surface at radius r near enough to the ray's point z = x + t d, seen in the same direction at `distance`, to
// be what the ray meets (thesis 7.1)? y is the surface's point.
PW_FUNCTION bool near_enough(BaselineRecord map, MarchRules rules, int texel, real3 x, real3 d, real t, real3 z,
                             real distance, real r, PW_INOUT(pw_uint) lookups) {
  real off = abs(distance - r);
  if (rules.epsilon_rule == kEpsilonFixed) return off <= rules.epsilon_m;
  real3 y = z * (r / distance);
  real3 to_y = y - x;
  if (rules.epsilon_rule == kEpsilonAngle) {
    // The direction of the answer may differ by k theta from that of the question. From behind a surface the rule has
    // no end (towards the probe the angle is always 0), so there the ray must have run away from the probe past it.
    real along = dot_of(to_y, d);
    if (!(along > real(0)) || (distance > r && along > t)) return false;
    return length_of(to_y - d * along) <= greatest_thickness(map, rules, along);
  }
  // eps = k tan(theta) d(X, Y) |alpha beta| (1 - beta nu): alpha from the answer to the origin, beta from the probe to
  // the origin (from the probe itself, the ray's own direction), nu the normal.
  real from_origin = length_of(to_y);
  real greatest = greatest_thickness(map, rules, from_origin);
  if (off > greatest) return false;
  real from_probe = length_of(x);
  real3 beta = from_probe > real(0) ? x * (real(1) / from_probe) : d;
  real alpha_beta = from_origin > real(0) ? abs(dot_of(to_y, beta)) / from_origin : real(0);
  real3 normal = stored_normal(map, texel, lookups);
  return off <= real(0.5) * greatest * alpha_beta * (real(1) - dot_of(beta, normal));
}

// The ray meets the texel's surface at t: a hit, or by the rules a back face. For the latter the knowledge ends at t,
// but the right surface lies before it, at most epsilon by 9.1.
PW_FUNCTION void settle_surface(BaselineRecord map, MarchRules rules, int texel, real3 x, real3 d, real t_start, real t,
                                real r, PW_INOUT(WalkState) state) {
  real3 z = x + d * t;
  real distance = max(length_of(z), real(1e-30));
  // The texel's sphere stands for the surface; with its normal the plane is known better.
  real3 plane = distance * r > real(1e-30) ? z * (real(1) / (distance * r)) : real3(0);
  state.t = t;
  if (rules.reject_backfaces) {
    real3 normal = stored_normal(map, texel, state.lookups);
    if (dot_of(normal, d) > real(0)) {
      state.status = kClassUnknown;
      state.t_safe = rules.backward_trace ? max(t_start, t - greatest_thickness(map, rules, t)) : t_start;
      return;
    }
    real height = dot_of(normal, z) * (r / distance);
    if (abs(height) > max(real(0.01) * abs(r), real(1e-30))) plane = normal * (real(1) / height);
  }
  state.status = kClassHit;
  state.plane = plane;
}

// Texel (row-major) of the map of n texels a side that the direction of p, not 0, falls into.
PW_FUNCTION int texel_of_direction(int n, real3 p) {
  real scale = real(1) / (abs(p.x) + abs(p.y) + abs(p.z));
  real u = p.x * scale, v = p.y * scale;
  if (p.z < real(0)) {
    real folded_u = (real(1) - abs(v)) * (u < real(0) ? real(-1) : real(1));
    v = (real(1) - abs(u)) * (v < real(0) ? real(-1) : real(1));
    u = folded_u;
  }
  real half_n = real(n) * real(0.5);
  int i = min(max(int((u + real(1)) * half_n), 0), n - 1), j = min(max(int((v + real(1)) * half_n), 0), n - 1);
  return j * n + i;
}

// Points of the ray x + t d (x relative to the probe, d of unit length) at t_start and every step_m further.
PW_FUNCTION WalkState march_3d(BaselineRecord map, MarchRules rules, real3 x, real3 d, real t_start) {
  WalkState state = walk_state(PW_WALKING, t_start, t_start);
  const int n = 1 << int(map.n_log2);
  const real farthest = min(rules.farthest_m, PW_FARTHEST);
  for (int step = 0; step < rules.max_steps; ++step) {
    real t = t_start + real(step) * rules.step_m;
    if (!(t < farthest)) {
      state.status = kClassMiss;
      state.t = PW_NEVER;
      state.t_safe = max(t_start, farthest);
      return state;
    }
    real3 z = x + d * t;
    real distance = length_of(z);
    if (distance > real(1e-15)) {
      int texel = texel_of_direction(n, z);
      real r = pw_word_real(map.distance_address, texel);
      state.lookups += 1u;
      if (r < real(0.5) * real(kBaselineSky_m)) {
        if (near_enough(map, rules, texel, x, d, t, z, distance, r, state.lookups)) {
          // The answer is the surface's point, not the ray's: its depth is its distance along the ray.
          real depth = t + (r - distance) * dot_of(z, d) / distance;
          settle_surface(map, rules, texel, x, d, t_start, min(max(depth, t_start), farthest), r, state);
          return state;
        }
        if (distance > r) {
          state.status = kClassUnknown;
          state.t = t;
          return state;
        }
      }
    }
    state.t = t;
    state.t_safe = t;
  }
  state.status = kClassUnknown;
  return state;
}

// A stretch of the ray inside one octant. U = half_n * (u0 + t u1) / (l0 + t l1) are quadrant-local coordinates in
// texels, V likewise.
struct TexelSegment {
  real u0, u1, v0, v1, l0, l1;
  int step_x, step_y;  // which way U and V move
  int first_x, first_y;
  real t_end;
  pw_ivec2 side;  // signs of x and y: which quadrant of the map
};

// Which way a quotient (f0 + t f1) / (l0 + t l1) moves. A ray that misses the probe by less than a millionth of its way
// stays in its texel but for the moment of passing it, where there is nothing to meet.
PW_FUNCTION int quotient_step(real f0, real f1, real l0, real l1) {
  real left = f1 * l0, right = f0 * l1;
  if (abs(left - right) <= real(1e-6) * (abs(left) + abs(right))) return 0;
  return left > right ? 1 : -1;
}

// t at which half_n (f0 + t f1) = line (l0 + t l1), crossed in the direction of step; PW_NEVER when it never is.
PW_FUNCTION real line_crossing(real f0, real f1, real l0, real l1, real half_n, int line, int step) {
  real above = real(line) * l0 - half_n * f0;
  real below = half_n * f1 - real(line) * l1;
  if (!(below * real(step) > real(0)) || abs(above) >= abs(below) * PW_NEVER) return PW_NEVER;
  return above / below;
}

// First cell of a stretch that begins at the coordinate u and moves by step.
PW_FUNCTION int first_cell(real u, int step, int half_n) {
  int cell = step < 0 ? int(ceil(u)) - 1 : int(floor(u));
  return min(max(cell, 0), half_n - 1);
}

// The cell of the axis that was not the exit, after a node was left by the other at `crossing`. Decided by the same
// comparisons as texel by texel: lines passed strictly before an x exit, before or at a y exit.
PW_FUNCTION int cell_after_skip(real f0, real f1, real l0, real l1, real half_n, int step, int cell, int line,
                                real crossing, bool at_too) {
  int low = step > 0 ? cell : line, high = step > 0 ? line - 1 : cell;
  real place = half_n * (f0 + crossing * f1) / max(l0 + crossing * l1, real(1e-30));
  int guess = min(max(int(floor(min(max(place, real(0)), half_n))), low), high);
  // The line behind the guess must have been passed, the one before it not.
  int behind = step > 0 ? guess : guess + 1, before = step > 0 ? guess + 1 : guess;
  if (guess != (step > 0 ? high : low)) {
    real t = line_crossing(f0, f1, l0, l1, half_n, before, step);
    if (t < crossing || (at_too && t == crossing)) return guess + step;
  }
  if (guess != (step > 0 ? low : high)) {
    real t = line_crossing(f0, f1, l0, l1, half_n, behind, step);
    if (!(t < crossing || (at_too && t == crossing))) return guess - step;
  }
  return guess;
}

// The ray's stretch t_in .. t_out inside one texel, where it is distance_in and distance_out from the probe. True when
// the march ends here.
PW_FUNCTION bool meet_texel(BaselineRecord map, MarchRules rules, int texel, real3 x, real3 d, real t_start, real t_in,
                            real t_out, real distance_in, real distance_out, real r, PW_INOUT(WalkState) state) {
  if (distance_in > r) {
    // Behind the surface on entry: within its thickness, or hidden.
    real3 z = x + d * t_in;
    if (near_enough(map, rules, texel, x, d, t_in, z, distance_in, r, state.lookups)) {
      real depth = t_in + (r - distance_in) * dot_of(z, d) / distance_in;
      settle_surface(map, rules, texel, x, d, t_start, max(t_start, min(depth, t_out)), r, state);
      return true;
    }
    state.status = kClassUnknown;
    state.t = t_in;
    state.t_safe = t_in;
    return true;
  }
  if (!(distance_out >= r)) return false;
  // In front at first and not at last: the ray leaves the sphere of radius r between.
  real nearest_t = -dot_of(x, d);
  real nearest = length_of(x + d * nearest_t);
  real t = nearest_t + sqrt(max((r - nearest) * (r + nearest), real(0)));
  settle_surface(map, rules, texel, x, d, t_start, min(max(t, t_in), t_out), r, state);
  return true;
}

// One octant's stretch. top: level of the first look and the coarsest there is, 0 = texel by texel; leap: from top
// straight to the texels and back (two levels), else level by level.
PW_FUNCTION bool march_segment(BaselineRecord map, MarchRules rules, real3 x, real3 d, real t_start, TexelSegment s,
                               int top, bool leap, PW_INOUT(int) steps, PW_INOUT(WalkState) state) {
  const int n = 1 << int(map.n_log2);
  const int half_n = n >> 1;
  const real half_real = real(half_n);
  int ix = s.first_x, iy = s.first_y, level = top;
  real t = state.t_safe;
  real distance_in = length_of(x + d * t);
  for (;;) {
    if (steps >= rules.max_steps) {
      state.status = kClassUnknown;
      state.t = t;
      state.t_safe = t;
      return true;
    }
    ++steps;
    int line_x = ((ix >> level) + (s.step_x > 0 ? 1 : 0)) << level;
    int line_y = ((iy >> level) + (s.step_y > 0 ? 1 : 0)) << level;
    real exit_x = s.step_x == 0 ? PW_NEVER : line_crossing(s.u0, s.u1, s.l0, s.l1, half_real, line_x, s.step_x);
    real exit_y = s.step_y == 0 ? PW_NEVER : line_crossing(s.v0, s.v1, s.l0, s.l1, half_real, line_y, s.step_y);
    bool leave_x = exit_x <= exit_y;
    real crossing = leave_x ? exit_x : exit_y;
    real exit = max(crossing, t);
    bool last = !(exit < s.t_end);
    if (last) exit = s.t_end;
    real distance_out = length_of(x + d * exit);
    int nodes = half_n >> level;
    int node_x = ix >> level, node_y = iy >> level;
    int gx = s.side.x > 0 ? nodes + node_x : nodes - 1 - node_x;
    int gy = s.side.y > 0 ? nodes + node_y : nodes - 1 - node_y;
    int at = gy * 2 * nodes + gx;
    state.lookups += 1u;
    if (level > 0) {
      real minimum = pw_word_real(map.minimum_address, minimum_level_offset(n, level) + at);
      // The distance is convex along the ray: but for rounding, it is nowhere in the node greater than at its ends.
      if (!(max(distance_in, distance_out) * real(1.000001) < minimum)) {
        level = leap ? 0 : level - 1;
        continue;
      }
    } else {
      real r = pw_word_real(map.distance_address, at);
      if (meet_texel(map, rules, at, x, d, t_start, t, exit, distance_in, distance_out, r, state)) return true;
    }
    state.t_safe = exit;
    if (last) return false;

    int old_x = ix, old_y = iy;
    if (leave_x) {
      ix = s.step_x > 0 ? line_x : line_x - 1;
      if (level > 0 && s.step_y != 0)
        iy = cell_after_skip(s.v0, s.v1, s.l0, s.l1, half_real, s.step_y, iy, line_y, crossing, false);
    } else {
      iy = s.step_y > 0 ? line_y : line_y - 1;
      if (level > 0 && s.step_x != 0)
        ix = cell_after_skip(s.u0, s.u1, s.l0, s.l1, half_real, s.step_x, ix, line_x, crossing, true);
    }
    // Beyond the quadrant's border the stretch has ended but for rounding.
    if (ix < 0 || iy < 0 || ix >= half_n || iy >= half_n) return false;
    t = exit;
    distance_in = distance_out;
    if (level < top) {
      int parent = leap ? top : level + 1;
      if ((((ix ^ old_x) | (iy ^ old_y)) >> parent) != 0) level = parent;
    }
  }
}

// The ray x + t d, octant by octant, through the texels or nodes that it crosses.
PW_FUNCTION WalkState march_octants(BaselineRecord map, MarchRules rules, real3 x, real3 d, real t_start, int top,
                                    bool leap) {
  WalkState state = walk_state(PW_WALKING, t_start, t_start);
  const real farthest = min(rules.farthest_m, PW_FARTHEST);
  const int half_n = 1 << int(map.n_log2 - 1u);
  int steps = 0;

  real3 t_cross, s;
  first_octant(x, d, t_start, t_cross, s);
  real t_a = t_start;
  int crossed = -1;  // axis whose plane the stretch starts on
  for (int k = 0; k < 4 && t_a < farthest; ++k) {
    real t_b = min(min(t_cross.x, t_cross.y), t_cross.z);
    int axis = t_cross.x == t_b ? 0 : t_cross.y == t_b ? 1 : 2;
    bool endless = !(t_b < farthest);
    if (endless) t_b = farthest;
    if (t_b > t_a) {
      real3 sd = s * d, sx = s * x;
      // Where the stretch starts; at the probe itself, where it goes to.
      real3 m = max(real3(0), sx + sd * t_a);
      if (crossed == 0) m.x = real(0);
      if (crossed == 1) m.y = real(0);
      if (crossed == 2) m.z = real(0);
      real len = m.x + m.y + m.z;
      if (!(len > real(1e-30))) {
        m = max(real3(0), sd);
        len = m.x + m.y + m.z;
      }
      if (len > real(1e-30)) {
        TexelSegment segment;
        // Upper octants: (x, y) / L; lower ones folded outwards, as sums, so that nothing cancels.
        bool upper = s.z > real(0);
        segment.u0 = upper ? sx.x : sx.x + sx.z;
        segment.u1 = upper ? sd.x : sd.x + sd.z;
        segment.v0 = upper ? sx.y : sx.y + sx.z;
        segment.v1 = upper ? sd.y : sd.y + sd.z;
        segment.l0 = sx.x + sx.y + sx.z;
        segment.l1 = sd.x + sd.y + sd.z;
        segment.step_x = quotient_step(segment.u0, segment.u1, segment.l0, segment.l1);
        segment.step_y = quotient_step(segment.v0, segment.v1, segment.l0, segment.l1);
        real scale = real(half_n) / len;
        segment.first_x = first_cell((upper ? m.x : m.x + m.z) * scale, segment.step_x, half_n);
        segment.first_y = first_cell((upper ? m.y : m.y + m.z) * scale, segment.step_y, half_n);
        segment.t_end = t_b;
        segment.side = pw_ivec2(s.x < real(0) ? -1 : 1, s.y < real(0) ? -1 : 1);
        state.t_safe = t_a;
        if (march_segment(map, rules, x, d, t_start, segment, top, leap, steps, state)) return state;
      }
      if (endless) break;
      t_a = t_b;
    }
    crossed = axis;
    next_octant(axis, t_cross, s);
  }
  state.status = kClassMiss;
  state.t = PW_NEVER;
  state.t_safe = max(t_start, farthest);
  return state;
}

// Every texel that the ray crosses; hierarchical: nodes that the ray cannot meet anything in are passed as a whole,
// with the same answer.
PW_FUNCTION WalkState march_2d(BaselineRecord map, MarchRules rules, real3 x, real3 d, real t_start,
                               bool hierarchical) {
  int top = hierarchical ? min(max(int(map.n_log2) - PW_TOP_BELOW_MAP, 1), int(map.n_log2) - 1) : 0;
  return march_octants(map, rules, x, d, t_start, top, false);
}

// The coarse map's texels; inside those that may hold a hit, the fine ones.
PW_FUNCTION WalkState march_two_level(BaselineRecord map, MarchRules rules, real3 x, real3 d, real t_start) {
  return march_octants(map, rules, x, d, t_start, min(PW_COARSE_LEVEL, int(map.n_log2) - 1), true);
}
