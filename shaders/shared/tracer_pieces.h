// The pieces of surface that a walk can meet: a planar entry's plane, a cell's triangles, and the regions into which cuts
// part a triangle. Same includer's contract as tracer.h, no include guard either.

// Stands for "never" in ray parameters; finite, so that no proof rests on the device's infinities.
#define PW_NEVER real(1e30)
// Status of a walk beside the answers of probe_layout.h.
#define PW_WALKING (-1)
#define PW_CLASS_BEHIND 3  // the ray's start lies behind the probe's surface

// A piece of the ray inside one octant, in quadrant-local map coordinates [0, half]^2; everything is linear in lambda.
struct OctantSegment {
  real2 uv0;   // map coordinates at lambda 0, in cells
  real2 d_uv;  // change to lambda 1
  real w0;     // ray's 1/L1 at lambda 0
  real dw;
  real tw0;  // t * w at lambda 0: t = lerp(tw) / lerp(w)
  real dtw;
  pw_ivec2 side;  // signs of x and y: which quadrant of the map
  bool upper;     // z > 0
};

struct WalkState {
  int status;
  real t;       // of a hit; of unknown and behind: where the knowledge ends
  real t_safe;  // the ray is known to be free from its start to here
  bool known;   // the current point has been proven to lie above the surface
  pw_uint lookups;
  // Of a hit: the plane that was met, as the p with dot(plane, p) = 1 relative to the probe; w along any direction is its
  // product with the direction of unit L1 length.
  real3 plane;
};

PW_FUNCTION WalkState walk_state(int status, real t, real t_start) {
  WalkState state;
  state.status = status;
  state.t = t;
  state.t_safe = t_start;
  state.known = false;
  state.lookups = 0u;
  state.plane = real3(0);
  return state;
}

// The piece met, in the world's terms. side: of the quadrant; upper: z > 0; corner: the cell's, quadrant-local.
PW_FUNCTION real3 plane_of_piece(real3 piece, real2 at, real2 corner, pw_ivec2 side, bool upper, real half_n) {
  real centre = piece.x - piece.y * (at.x + corner.x) - piece.z * (at.y + corner.y);
  real along_u = piece.y * half_n, along_v = piece.z * half_n;
  real pole = upper ? centre : -(centre + along_u + along_v);
  return real3((centre + along_u) * real(side.x), (centre + along_v) * real(side.y), pole);
}

PW_FUNCTION real segment_t(OctantSegment s, real lambda) {
  return min((s.tw0 + lambda * s.dtw) / max(s.w0 + lambda * s.dw, real(1e-30)), PW_NEVER);
}

// The same, from the far end: there 1 - lambda, of which w at infinity is a multiple, would have lost its digits.
PW_FUNCTION real segment_t_from_end(OctantSegment s, real rest) {
  real w_end = s.w0 + s.dw, tw_end = s.tw0 + s.dtw;
  return min((tw_end - rest * s.dtw) / max(w_end - rest * s.dw, real(1e-30)), PW_NEVER);
}

// The piece of surface at which a walk ends.
struct Meeting {
  bool cut;  // the piece ends in mid-air, so being below it on entry means having passed through a wall that nobody has seen
  real ray_w;   // where the ray comes over the piece
  real f0, f1;  // the ray's height above the piece, in w, there and where it leaves it again
  real lambda0, lambda1;
  real3 piece;  // w at the anchor, slopes a cell step
  real2 at;     // the anchor in the cell's unit square
};

// The ray's height above a planar piece at its two ends decides whether the walk ends there. A piece of no length decides
// nothing: which side of an outline its one point is on is anybody's guess, and a neighbour has the point, too.
PW_FUNCTION bool ends_walk(bool known, Meeting m) {
  return m.lambda1 > m.lambda0 && (m.f1 <= real(0) || (m.f0 <= real(0) && (m.cut || !known)));
}

// Whether the cells under a planar entry, each within kPlanarTolerance of it, could say something else than its plane
// does: the ray comes or goes about as close to it as that, or crosses it so flatly that the distance changes by more than
// kPlaneError. w_out: the ray's, where it leaves.
PW_FUNCTION bool plane_is_doubtful(OctantSegment s, Meeting m, real w_out) {
  const real tolerance = real(kPlanarTolerance);
  if (abs(m.f0) <= tolerance * (m.ray_w - m.f0) || abs(m.f1) <= tolerance * (w_out - m.f1)) return true;
  if (m.f0 < real(0) || m.f1 > real(0)) return false;
  // t is a quotient of linear functions, so dt = turn / w^2 dlambda, and the tolerance shifts lambda by tolerance w over
  // the slope.
  real fall = m.f0 - m.f1, length = m.lambda1 - m.lambda0, lambda = m.lambda0 + length * (m.f0 / fall);
  real turn = s.dtw * s.w0 - s.tw0 * s.dw;
  return abs(turn) * tolerance * length > real(kPlaneError) * fall * (s.tw0 + lambda * s.dtw);
}

PW_FUNCTION void end_walk(OctantSegment s, real t_start, real texel, Meeting m, PW_INOUT(WalkState) state) {
  if (m.f0 <= real(0) && (m.cut || !state.known)) {
    // On a hand-off the start may lie on the surface itself, a texel behind by rounding: that is a hit.
    bool touching = t_start > real(0) && -m.f0 < m.ray_w * texel;
    state.status = state.known ? kClassUnknown : touching ? kClassHit : PW_CLASS_BEHIND;
    state.t = max(t_start, segment_t(s, m.lambda0));
    state.t_safe = state.t;
    return;
  }
  real tau = m.f0 > real(0) ? m.f0 / (m.f0 - m.f1) : real(0);
  real lambda = m.lambda0 + (m.lambda1 - m.lambda0) * tau;
  real rest = (real(1) - m.lambda1) + (m.lambda1 - m.lambda0) * (m.f0 > real(0) ? m.f1 / (m.f1 - m.f0) : real(1));
  state.status = kClassHit;
  state.t = max(t_start, lambda < real(0.5) ? segment_t(s, lambda) : segment_t_from_end(s, rest));
  state.t_safe = max(t_start, segment_t(s, m.lambda0));
}

PW_FUNCTION real2 unpack_slopes(pw_uint word) {
  int x = int(word << 16) >> 16, y = int(word) >> 16;
  return real2(real(x), real(y)) * real(kSlopeStep);
}

// The edges of a cut record (probe_layout.h).
struct CutEdges {
  pw_uint low_u, low_v, diagonal, high_v, high_u;
};

PW_FUNCTION CutEdges cut_edges(pw_uint word) {
  CutEdges edges;
  edges.low_u = word % kEdgeCodes;
  word /= kEdgeCodes;
  edges.low_v = word % kEdgeCodes;
  word /= kEdgeCodes;
  edges.diagonal = word % kEdgeCodes;
  word /= kEdgeCodes;
  edges.high_v = word % kEdgeCodes;
  edges.high_u = word / kEdgeCodes;
  return edges;
}

// Disconnected edges of a triangle: bits for those from its corner 0 to 1, 1 to 2, 2 to 0. Corner 0 is (0, 0) or (1, 1),
// the others (1, 0) and (0, 1).
PW_FUNCTION int cut_mask(CutEdges edges, bool high) {
  int mask = edges.diagonal != 0u ? 2 : 0;
  if ((high ? edges.high_v : edges.low_u) != 0u) mask |= 1;
  if ((high ? edges.high_u : edges.low_v) != 0u) mask |= 4;
  return mask;
}

// Where along its edge the surface ends.
PW_FUNCTION real cut_fraction(pw_uint code) {
  return (real(max(int(code) - 1, 0)) + real(0.5)) / real(64);
}

// Where a linear function that is a at 0 and b at 1 changes sign; 1 when it does not.
PW_FUNCTION real sign_change(real a, real b) {
  if ((a < real(0)) == (b < real(0))) return real(1);
  real at = a / (a - b);
  return at > real(0) && at < real(1) ? at : real(1);
}

// A triangle with disconnected edges: cut lines split it into regions, each with its own vertex's plane. The ray's
// piece runs from p0 (w r0, lambda l0) to p1 in the cell's unit square. corner_w: w at v0, v1, v2.
PW_FUNCTION bool meet_cut_triangle(pw_uvec2 geometry, int record, CutEdges edges, bool high, bool on_fold,
                                   real3 corner_w, real l0, real r0, real2 p0, real l1, real r1, real2 p1,
                                   PW_INOUT(bool) known, PW_INOUT(Meeting) m) {
  const int mask = cut_mask(edges, high);
  real2 v0 = high ? real2(1, 1) : real2(0, 0);
  real2 v1 = real2(1, 0);
  real2 v2 = real2(0, 1);
  // Barycentric coordinates of both ends.
  real3 a, b;
  a.y = high ? real(1) - p0.y : p0.x;
  a.z = high ? real(1) - p0.x : p0.y;
  a.x = real(1) - a.y - a.z;
  b.y = high ? real(1) - p1.y : p1.x;
  b.z = high ? real(1) - p1.x : p1.y;
  b.x = real(1) - b.y - b.z;
  int first = high && on_fold ? record + int(pw_word(geometry, record + 4)) : record + 2;  // of (1, 0), (0, 1), (1, 1)
  real2 slope0 = unpack_slopes(pw_word(geometry, high ? first + 2 : record + 1)) * corner_w.x;
  real2 slope1 = unpack_slopes(pw_word(geometry, first)) * corner_w.y;
  real2 slope2 = unpack_slopes(pw_word(geometry, first + 1)) * corner_w.z;

  // Two disconnected edges leave one vertex alone: one cut line through the edges' fractions, the other two vertices
  // share a plane. Else three regions, each nearest to its vertex.
  bool lone = mask == 5 || mask == 3 || mask == 6;
  real break0 = real(1), break1 = real(1), break2 = real(1);
  real h0 = real(0), h1 = real(0);
  real lone_w = real(0), pair_w = real(0);
  real2 lone_at = v0, lone_slope = slope0, pair_at = v1, pair_slope = slope1;
  if (lone) {
    real f01 = high ? real(1) - cut_fraction(edges.high_v) : cut_fraction(edges.low_u);
    real f12 = cut_fraction(edges.diagonal);
    real f20 = high ? cut_fraction(edges.high_u) : real(1) - cut_fraction(edges.low_v);
    // Parts of the edges to the next two vertices that the lone vertex owns.
    real own_next, own_last;
    real2 a2, b2;
    real2 next_at, last_at, next_slope, last_slope;
    real next_w, last_w;
    if (mask == 5) {
      own_next = f01; own_last = real(1) - f20;
      a2 = real2(a.y, a.z); b2 = real2(b.y, b.z);
      lone_w = corner_w.x; lone_at = v0; lone_slope = slope0;
      next_w = corner_w.y; next_at = v1; next_slope = slope1;
      last_w = corner_w.z; last_at = v2; last_slope = slope2;
    } else if (mask == 3) {
      own_next = f12; own_last = real(1) - f01;
      a2 = real2(a.z, a.x); b2 = real2(b.z, b.x);
      lone_w = corner_w.y; lone_at = v1; lone_slope = slope1;
      next_w = corner_w.z; next_at = v2; next_slope = slope2;
      last_w = corner_w.x; last_at = v0; last_slope = slope0;
    } else {
      own_next = f20; own_last = real(1) - f12;
      a2 = real2(a.x, a.y); b2 = real2(b.x, b.y);
      lone_w = corner_w.z; lone_at = v2; lone_slope = slope2;
      next_w = corner_w.x; next_at = v0; next_slope = slope0;
      last_w = corner_w.y; last_at = v1; last_slope = slope1;
    }
    own_next = max(own_next, real(0.01));
    own_last = max(own_last, real(0.01));
    h0 = a2.x / own_next + a2.y / own_last - real(1);
    h1 = b2.x / own_next + b2.y / own_last - real(1);
    break0 = sign_change(h0, h1);
    // The pair's plane: mean slopes, corrected so that it goes through both vertices, clamped, hung at the nearer one.
    bool next_nearer = next_w >= last_w;
    pair_w = next_nearer ? next_w : last_w;
    pair_at = next_nearer ? next_at : last_at;
    real other_w = next_nearer ? last_w : next_w;
    real2 edge = next_nearer ? last_at - next_at : next_at - last_at;
    pair_slope = (next_slope + last_slope) * real(0.5);
    real along = pair_slope.x * edge.x + pair_slope.y * edge.y;
    pair_slope = pair_slope + edge * ((other_w - pair_w - along) / (edge.x * edge.x + edge.y * edge.y));
    real steepest = max(abs(pair_slope.x), abs(pair_slope.y)), limit = real(kSlopeClamp) * pair_w;
    if (steepest > limit) pair_slope = pair_slope * (limit / steepest);
  } else {
    real x = sign_change(a.x - a.y, b.x - b.y);
    real y = sign_change(a.y - a.z, b.y - b.z);
    real z = sign_change(a.z - a.x, b.z - b.x);
    break0 = min(min(x, y), z);
    break2 = max(max(x, y), z);
    break1 = max(min(x, y), min(max(x, y), z));
  }

  real from = real(0);
  for (int piece = 0; piece < 4; ++piece) {
    real to = piece == 0 ? break0 : piece == 1 ? break1 : piece == 2 ? break2 : real(1);
    if (piece > 0 && from >= real(1)) break;
    real middle = (from + to) * real(0.5);
    real w, plane_x, plane_y;
    real2 at;
    if (lone) {
      bool alone = h0 + (h1 - h0) * middle < real(0);
      w = alone ? lone_w : pair_w;
      at = alone ? lone_at : pair_at;
      plane_x = alone ? lone_slope.x : pair_slope.x;
      plane_y = alone ? lone_slope.y : pair_slope.y;
    } else {
      real3 c = a + (b - a) * middle;
      int owner = c.x >= c.y && c.x >= c.z ? 0 : c.y >= c.z ? 1 : 2;
      w = owner == 0 ? corner_w.x : owner == 1 ? corner_w.y : corner_w.z;
      at = owner == 0 ? v0 : owner == 1 ? v1 : v2;
      plane_x = owner == 0 ? slope0.x : owner == 1 ? slope1.x : slope2.x;
      plane_y = owner == 0 ? slope0.y : owner == 1 ? slope1.y : slope2.y;
    }
    if (w > real(0)) {
      real2 q0 = p0 + (p1 - p0) * from - at, q1 = p0 + (p1 - p0) * to - at;
      m.lambda0 = l0 + (l1 - l0) * from;
      m.lambda1 = l0 + (l1 - l0) * to;
      m.ray_w = r0 + (r1 - r0) * from;
      m.f0 = m.ray_w - (w + plane_x * q0.x + plane_y * q0.y);
      m.f1 = (r0 + (r1 - r0) * to) - (w + plane_x * q1.x + plane_y * q1.y);
      if (ends_walk(known, m)) {
        m.piece = real3(w, plane_x, plane_y);
        m.at = at;
        return true;
      }
    }
    // Sky, too: nothing to be behind of. Of a piece of no length nothing is known.
    known = known || to > from;
    from = to;
  }
  return false;
}
