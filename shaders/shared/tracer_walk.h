// One ray against one probe: the octant-affine walk. Compiled as GLSL, as C++ float and as C++ double; whoever includes
// it provides `real`, `real2`, `real3` and the memory access of tracer.h. No include guard: C++ includes it once a
// type.
//
// In each octant around the probe every plane of the world is affine in the map's coordinates (U, V), and a ray is a
// straight line there whose own w = 1 / L1 distance is affine along it. So each triangle of the vertex grid is a planar
// triangle of the world, and the walk needs one compare a node, no step size and no thickness (design: tracer, 2).
//
// What the walk guarantees on any data: it ends (every step moves on by at least one cell), it forms no NaN and no
// infinity from finite rays and says "unknown" to others, and with the pyramid it visits the same surfaces as without,
// bit for bit; with its planes the class of the answer stays and its distance moves by less than kPlaneError of itself.
#include "tracer_pieces.h"
#include "tracer_pyramid.h"
#include "tracer_samples.h"

// Sizes of what can be walked: origins up to here from the probe, directions no longer and no shorter than these.
// Beyond them sums and reciprocals might not be finite.
#define PW_GREATEST_M real(1e15)
#define PW_LONGEST real(1e6)
#define PW_SHORTEST real(1e-6)

// The walk through one octant's segment. Returns true when it ends there; state.status says how.
PW_FUNCTION bool walk_segment(ProbeRecord probe, OctantSegment s, real t_start, int start_level,
                              PW_INOUT(WalkState) state) {
  const int n = 1 << int(probe.n_log2);
  const int half_n = n >> 1;
  const bool tiled = has_tiled_samples(probe);
  const int pyramid = pyramid_begin(n, tiled);
  const int masks = pyramid + pyramid_words(int(probe.n_log2));
  const int records = masks + n * n / 16;
  const pw_uvec2 geometry = probe.geometry_address;
  const real texel = real(2) / real(n);

  // A move of less than 1e-12 cells is none: its reciprocal would not be finite.
  const int step_x = abs(s.d_uv.x) <= real(1e-12) ? 0 : s.d_uv.x > real(0) ? 1 : -1;
  const int step_y = abs(s.d_uv.y) <= real(1e-12) ? 0 : s.d_uv.y > real(0) ? 1 : -1;
  const real per_u = step_x == 0 ? real(0) : real(1) / s.d_uv.x;
  const real per_v = step_y == 0 ? real(0) : real(1) / s.d_uv.y;
  int ix = step_x < 0 ? int(ceil(s.uv0.x)) - 1 : int(floor(s.uv0.x));
  int iy = step_y < 0 ? int(ceil(s.uv0.y)) - 1 : int(floor(s.uv0.y));
  ix = min(max(ix, 0), half_n - 1);
  iy = min(max(iy, 0), half_n - 1);

  // Levels 0 (cells), 1, 3, 5 ... The first look is as wide as the way is long, at most.
  const bool planes = start_level < kWithoutPlanes;
  int top = min(planes ? start_level : start_level - kWithoutPlanes, pyramid_top(int(probe.n_log2)));
  top = top < 1 ? 0 : ((top - 1) | 1);
  const real way = max(abs(s.d_uv.x), abs(s.d_uv.y));
  while (top > 1 && real(1 << top) > way) top -= 2;
  // A segment that moves by less than a cell, a ray's that runs (almost) straight away from the probe, meets three
  // cells at most, mostly one: looking at nodes first would only add to that (thesis 4.3: one look-up).
  if (way < real(1)) top = 0;

  int level = top, node_read = -1;
  real lambda = real(0), exit = real(0), w_in = s.w0, w_out = s.w0, crossing = real(0);
  int line_x = 0, line_y = 0;
  bool leave_x = false, last = false, passed = false;
  for (;;) {
    // On to the next cell or planar entry that the ray comes down to. Rays that are walked side by side go through this
    // loop first and what they have found then together: it is many times as long.
    bool planar = false;
    int record = -1;  // of the cell's cuts
    real w00 = real(0), w10 = real(0), w01 = real(0), w11 = real(0);
    real2 corner_uv = real2(0, 0);
    for (;;) {
      if (passed) {
        if (last) return false;
        // Step over the exit line. The other coordinate's cell is decided by the same comparisons of line parameters as
        // a cell-by-cell walk would make, so that skipping nodes changes nothing: lines passed strictly before an x
        // exit, before or at a y exit.
        int old_x = ix, old_y = iy;
        if (leave_x) {
          ix = step_x > 0 ? line_x : line_x - 1;
          if (step_y != 0 && level > 0) {
            int guess = int(floor(s.uv0.y + exit * s.d_uv.y));
            int low = step_y > 0 ? iy : line_y, high = step_y > 0 ? line_y - 1 : iy;
            guess = min(max(guess, low), high);
            if (step_y > 0) {
              if (guess < high && (real(guess + 1) - s.uv0.y) * per_v < crossing)
                ++guess;
              else if (guess > low && !((real(guess) - s.uv0.y) * per_v < crossing))
                --guess;
            } else {
              if (guess > low && (real(guess) - s.uv0.y) * per_v < crossing)
                --guess;
              else if (guess < high && !((real(guess + 1) - s.uv0.y) * per_v < crossing))
                ++guess;
            }
            iy = guess;
          }
        } else {
          iy = step_y > 0 ? line_y : line_y - 1;
          if (step_x != 0 && level > 0) {
            int guess = int(floor(s.uv0.x + exit * s.d_uv.x));
            int low = step_x > 0 ? ix : line_x, high = step_x > 0 ? line_x - 1 : ix;
            guess = min(max(guess, low), high);
            if (step_x > 0) {
              if (guess < high && (real(guess + 1) - s.uv0.x) * per_u <= crossing)
                ++guess;
              else if (guess > low && !((real(guess) - s.uv0.x) * per_u <= crossing))
                --guess;
            } else {
              if (guess > low && (real(guess) - s.uv0.x) * per_u <= crossing)
                --guess;
              else if (guess < high && !((real(guess + 1) - s.uv0.x) * per_u <= crossing))
                ++guess;
            }
            ix = guess;
          }
        }
        if (ix < 0 || iy < 0 || ix >= half_n || iy >= half_n) return false;
        lambda = exit;
        w_in = w_out;
        if (level < top && (((ix ^ old_x) | (iy ^ old_y)) >> (level == 0 ? 1 : level + 2)) != 0)
          level = (level + 1) | 1;
      }
      // The node's far lines and where the ray leaves it.
      line_x = ((ix >> level) + (step_x > 0 ? 1 : 0)) << level;
      line_y = ((iy >> level) + (step_y > 0 ? 1 : 0)) << level;
      real exit_x = step_x == 0 ? PW_NEVER : (real(line_x) - s.uv0.x) * per_u;
      real exit_y = step_y == 0 ? PW_NEVER : (real(line_y) - s.uv0.y) * per_v;
      leave_x = exit_x <= exit_y;
      crossing = leave_x ? exit_x : exit_y;
      exit = max(crossing, lambda);
      last = !(exit < real(1));
      if (last) exit = real(1);
      w_out = s.w0 + exit * s.dw;
      real w_low = min(w_in, w_out);
      int gx = s.side.x > 0 ? (half_n >> level) + (ix >> level) : (half_n >> level) - 1 - (ix >> level);
      int gy = s.side.y > 0 ? (half_n >> level) + (iy >> level) : (half_n >> level) - 1 - (iy >> level);
      if (level > 0) {
        int node = pyramid_node(pyramid, n, level, gx, gy);
        if (node != node_read) state.lookups += 1u;
        node_read = node;
        pw_uint entry = pyramid_entry(geometry, node, gx, gy);
        real maximum = entry_maximum(entry);
        passed = maximum <= real(0) || w_low > maximum;
        planar = !passed && planes && (entry & kEntryPlanar) != 0u;
        if (planar) break;
        if (!passed) level = max(level - 2, 0);
      } else {
        CornerSamples corners =
            corner_samples(geometry, tiled, n, half_n + s.side.x * ix, half_n + s.side.y * iy, s.side, 1);
        w00 = corners.w00;
        w10 = corners.w10;
        w01 = corners.w01;
        w11 = corners.w11;
        state.lookups += 1u;
        real maximum = max(max(w00, w10), max(w01, w11));
        passed = maximum <= real(0) || w_low > maximum * real(kCutExtension);
        record = -1;
        if (!passed) {
          if ((probe.flags & kFlagCuts) != 0u) {
            int cell = gy * n + gx;
            pw_uint mask = pw_word(geometry, masks + 2 * (cell >> 5));
            pw_uint bit = 1u << pw_uint(cell & 31);
            if ((mask & bit) != 0u) {
              pw_uint before = pw_word(geometry, masks + 2 * (cell >> 5) + 1);
              record = records + kCutRecordWords * int(before + pw_uint(bitCount(mask & (bit - 1u))));
            }
          }
          passed = record < 0 && w_low > maximum;
        }
        // By rounding only: on the fold the ray is in a cell of the octant that it comes from or goes to, which here
        // says nothing.
        int past_fold = ix + iy + 1 - half_n;
        if (!passed && (s.upper ? past_fold > 0 : past_fold < 0)) {
          passed = true;
          continue;
        }
        if (!passed) break;
      }
      if (passed) state.known = true;
    }

    Meeting m;
    m.cut = false;
    bool ended = false;
    if (planar) {
      // One plane stands for all the entry's cells: that through the corners next to the map's centre.
      int corner_x = (ix >> level) << level, corner_y = (iy >> level) << level, size = 1 << level;
      int x = half_n + s.side.x * corner_x, y = half_n + s.side.y * corner_y;
      real w, w_u, w_v;
      if (tiled && size < kDeviceTileSide) {
        CornerSamples corners = corner_samples(geometry, tiled, n, x, y, s.side, size);
        w = corners.w00;
        w_u = corners.w10;
        w_v = corners.w01;
      } else {
        w = pw_word_real(geometry, corner_word(tiled, n, x, y));
        w_u = pw_word_real(geometry, corner_word(tiled, n, x + s.side.x * size, y));
        w_v = pw_word_real(geometry, corner_word(tiled, n, x, y + s.side.y * size));
      }
      real gu = (w_u - w) / real(size), gv = (w_v - w) / real(size);
      state.lookups += 1u;
      corner_uv = real2(real(corner_x), real(corner_y));
      real2 q0 = s.uv0 + s.d_uv * lambda - corner_uv, q1 = s.uv0 + s.d_uv * exit - corner_uv;
      m.ray_w = w_in;
      m.f0 = w_in - (w + gu * q0.x + gv * q0.y);
      m.f1 = w_out - (w + gu * q1.x + gv * q1.y);
      m.lambda0 = lambda;
      m.lambda1 = exit;
      m.piece = real3(w, gu, gv);
      m.at = real2(0, 0);
      if (plane_is_doubtful(s, m, w_out)) {
        level = max(level - 2, 0);
        passed = false;
        continue;
      }
      ended = ends_walk(state.known, m);
    } else {
      // Entry and exit in the cell's unit square; the cell's diagonal x + y = 1 parts low from high triangle. On the
      // fold each of the two belongs to an octant of its own.
      corner_uv = real2(real(ix), real(iy));
      real2 p_in = s.uv0 + s.d_uv * lambda - corner_uv;
      real2 p_out = s.uv0 + s.d_uv * exit - corner_uv;
      real side_in = p_in.x + p_in.y - real(1), side_out = p_out.x + p_out.y - real(1);
      bool on_fold = ix + iy + 1 == half_n;
      bool both_low = on_fold ? s.upper : side_in <= real(0) && side_out <= real(0);
      bool both_high = on_fold ? !s.upper : !both_low && side_in >= real(0) && side_out >= real(0);
      bool crosses = !(both_low || both_high);
      bool high = both_low ? false : both_high ? true : side_in > real(0);
      real l0 = lambda, r0 = w_in, l1 = exit, r1 = w_out;
      real2 p0 = p_in, p1 = p_out;
      if (crosses) {
        real at = side_in / (side_in - side_out);
        l1 = lambda + (exit - lambda) * at;
        r1 = w_in + (w_out - w_in) * at;
        p1 = p_in + (p_out - p_in) * at;
      }
      CutEdges edges = cut_edges(record < 0 ? 0u : pw_word(geometry, record));
      for (int part = 0; part < 2; ++part) {
        real w_corner = high ? w11 : w00;
        m.cut = cut_mask(edges, high) != 0;
        if (m.cut) {
          ended = meet_cut_triangle(geometry, record, edges, high, on_fold, real3(w_corner, w10, w01), l0, r0, p0, l1,
                                    r1, p1, state.known, m);
        } else if (w_corner > real(0) || w10 > real(0) || w01 > real(0)) {
          real gu = high ? w11 - w01 : w10 - w00, gv = high ? w11 - w10 : w01 - w00;
          real2 from_corner = high ? real2(1, 1) : real2(0, 0);
          real2 q0 = p0 - from_corner, q1 = p1 - from_corner;
          m.ray_w = r0;
          m.f0 = r0 - (w_corner + gu * q0.x + gv * q0.y);
          m.f1 = r1 - (w_corner + gu * q1.x + gv * q1.y);
          m.lambda0 = l0;
          m.lambda1 = l1;
          m.piece = real3(w_corner, gu, gv);
          m.at = from_corner;
          ended = ends_walk(state.known, m);
        }
        if (ended || !crosses) break;
        state.known = state.known || l1 > l0;
        crosses = false;
        high = !high;
        l0 = l1;
        r0 = r1;
        p0 = p1;
        l1 = exit;
        r1 = w_out;
        p1 = p_out;
      }
    }
    if (ended) {
      end_walk(s, t_start, texel, m, state);
      state.plane = plane_of_piece(m.piece, m.at, corner_uv, s.side, s.upper, real(half_n));
      return true;
    }
    state.known = state.known || exit > lambda;
    passed = true;
  }
}

// Does the ray cross x = 0 on this axis, and when? false when it never does within PW_NEVER.
PW_FUNCTION bool axis_crossing(real x, real d, PW_OUT(real) t) {
  t = PW_NEVER;
  if (d == real(0) || abs(x) >= abs(d) * PW_NEVER) return false;
  t = -x / d;
  return true;
}

PW_FUNCTION real octant_sign(bool crosses, real t, real t_start, real x, real d) {
  real forward = d > real(0) ? real(1) : real(-1);
  return !crosses ? (x < real(0) ? real(-1) : real(1)) : t > t_start ? -forward : forward;
}

// The octant that the ray x + t d is in from t_start on, as signs, and when it crosses each axis' plane after that
// (else PW_NEVER). Signs come from comparing crossing times, never from evaluating points.
PW_FUNCTION void first_octant(real3 x, real3 d, real t_start, PW_OUT(real3) t_cross, PW_OUT(real3) s) {
  real t_axis;
  bool crosses_x = axis_crossing(x.x, d.x, t_axis);
  t_cross.x = t_axis;
  bool crosses_y = axis_crossing(x.y, d.y, t_axis);
  t_cross.y = t_axis;
  bool crosses_z = axis_crossing(x.z, d.z, t_axis);
  t_cross.z = t_axis;
  s.x = octant_sign(crosses_x, t_cross.x, t_start, x.x, d.x);
  s.y = octant_sign(crosses_y, t_cross.y, t_start, x.y, d.y);
  s.z = octant_sign(crosses_z, t_cross.z, t_start, x.z, d.z);
  if (!crosses_x || t_cross.x <= t_start) t_cross.x = PW_NEVER;
  if (!crosses_y || t_cross.y <= t_start) t_cross.y = PW_NEVER;
  if (!crosses_z || t_cross.z <= t_start) t_cross.z = PW_NEVER;
}

// Across an axis' plane; -1: none.
PW_FUNCTION void next_octant(int axis, PW_INOUT(real3) t_cross, PW_INOUT(real3) s) {
  if (axis == 0) {
    t_cross.x = PW_NEVER;
    s.x = -s.x;
  }
  if (axis == 1) {
    t_cross.y = PW_NEVER;
    s.y = -s.y;
  }
  if (axis == 2) {
    t_cross.z = PW_NEVER;
    s.z = -s.z;
  }
}

// Walks the ray x + t d, t >= t_start, through the probe's map. x: origin relative to the probe. start_level: pyramid
// level of the first look, 0 = cell by cell, + kWithoutPlanes for the very answers of cell by cell.
PW_FUNCTION WalkState walk_probe(ProbeRecord probe, real3 x, real3 d, real t_start, int start_level) {
  WalkState state = walk_state(PW_WALKING, PW_NEVER, t_start);
  const real half_n = real(1 << int(probe.n_log2 - 1u));
  const real l_min = real(probe.l_min_m);
  // Of a ray whose numbers are none nothing is known; the comparisons fail for NaN, too.
  bool has_start = abs(t_start) < PW_NEVER;
  real size = abs(x.x) + abs(x.y) + abs(x.z), speed = abs(d.x) + abs(d.y) + abs(d.z);
  if (!(has_start && size < PW_GREATEST_M && speed < PW_LONGEST && speed > PW_SHORTEST)) {
    state.status = kClassUnknown;
    state.t = has_start ? t_start : real(0);
    state.t_safe = state.t;
    return state;
  }

  real3 t_cross, s;
  first_octant(x, d, t_start, t_cross, s);
  real t_a = t_start;
  int crossed = -1;  // axis whose plane the segment starts on
  for (int k = 0; k < 4; ++k) {
    // Next crossing; ties make a segment of no length: flip the sign, no work.
    real t_b = min(min(t_cross.x, t_cross.y), t_cross.z);
    bool endless = !(t_b < PW_NEVER);
    int axis = endless ? -1 : t_cross.x == t_b ? 0 : t_cross.y == t_b ? 1 : 2;
    if (endless || t_b > t_a) {
      real3 m0 = max(real3(0), s * (x + d * t_a));
      if (crossed == 0) m0.x = real(0);
      if (crossed == 1) m0.y = real(0);
      if (crossed == 2) m0.z = real(0);
      real3 sd = s * d;
      real3 m1 = endless ? max(real3(0), sd) : max(real3(0), s * (x + d * t_b));
      if (axis == 0) m1.x = real(0);
      if (axis == 1) m1.y = real(0);
      if (axis == 2) m1.z = real(0);
      real len0 = m0.x + m0.y + m0.z, len1 = m1.x + m1.y + m1.z, slope = sd.x + sd.y + sd.z;
      // Near clip: inside the empty octahedron nothing needs proof. Covers rays through and from the probe's centre.
      real t0 = t_a, t1 = t_b;
      bool skip = false;
      if (len0 < l_min) {
        state.known = true;
        skip = true;
        if (endless || len1 >= l_min) {
          t0 = t_a + (l_min - len0) / max(slope, real(1e-30));
          if (t0 < t_b) {
            m0 = max(real3(0), s * (x + d * t0));
            len0 = m0.x + m0.y + m0.z;
            skip = !(len0 > real(0.5) * l_min);
          }
        }
      } else if (!endless && len1 < l_min) {
        t1 = t_a + (len0 - l_min) / max(-slope, real(1e-30));
        if (!(t1 > t_a)) {
          skip = true;
          state.known = true;
        } else {
          t1 = min(t1, t_b);
          m1 = max(real3(0), s * (x + d * t1));
          len1 = max(m1.x + m1.y + m1.z, real(0.5) * l_min);
        }
      }
      if (!(len0 > real(0)) || !(len1 > real(0))) skip = true;
      if (!skip) {
        // Upper octants: (x, y) / L; lower ones folded outwards, as sums, so that nothing cancels.
        OctantSegment segment;
        bool upper = s.z > real(0);
        real w0 = real(1) / len0, w1 = real(1) / len1;
        real2 a0 = upper ? real2(m0.x, m0.y) : real2(m0.x + m0.z, m0.y + m0.z);
        real2 a1 = upper ? real2(m1.x, m1.y) : real2(m1.x + m1.z, m1.y + m1.z);
        segment.uv0 = a0 * (w0 * half_n);
        segment.d_uv = a1 * (w1 * half_n) - segment.uv0;
        segment.w0 = w0;
        segment.dw = (endless ? real(0) : w1) - w0;
        segment.tw0 = t0 * w0;
        segment.dtw = (endless ? w1 : t1 * w1) - segment.tw0;
        segment.side = pw_ivec2(s.x < real(0) ? -1 : 1, s.y < real(0) ? -1 : 1);
        segment.upper = upper;
        if (walk_segment(probe, segment, t_start, start_level, state)) return state;
      }
      if (endless) break;
      t_a = t_b;
    }
    crossed = axis;
    next_octant(axis, t_cross, s);
  }
  // Every finite point of the ray was proven to lie above the surface.
  state.status = kClassMiss;
  return state;
}
