// The tracer: rays against all resident probes. This text is compiled three times: as GLSL (float, on the device), as
// C++ float and as C++ double (content/probe/tracer_f32.h, tracer_f64.h). The includer provides
//   real, real2, real3, ivec3           the arithmetic
//   pw_word(address, index)             a 32-bit word of device memory
//   pw_word_real(address, index)        the same as a float, widened to real
//   PW_MAY_TILE                         false where no probe has its samples in tiles
//   pw_probe(grid, index)               a ProbeRecord
//   PW_OUT(type), PW_INOUT(type)        parameter directions
// and may define PW_BASELINES, for a tracer that walks by another method than its own; then it also provides
//   pw_baseline(constants, index)       a BaselineRecord
// No include guard: C++ includes it once a type.
#include "octahedral.h"
#include "selection_rules.h"
#include "tracer_walk.h"

// How far ahead of a hand-off the next probe's view is tested, as a fraction of the mean probe spacing.
#define PW_START_AHEAD real(0.01)
// Pyramid level of the start test's first look-up; 1 to 3 are alike (design: fewer-tries, 2).
#define PW_START_LEVEL 3
// Progress below this is none: a probe that failed here is not asked again.
#define PW_PROGRESS_M real(1e-3)
// Walks a ray can have, whatever the dials say.
#define PW_TRIES_LIMIT 16
#define PW_CANDIDATES 8
// A stop point this far (relative) from a probe's surface is no plausible point of that surface.
#define PW_PLAUSIBLE real(0.25)

struct RayAnswer {
  int cls;     // kClassHit, kClassMiss, kClassUnknown
  real t;      // metres along the unit direction; unknown: how far the ray is known to be free; miss: PW_NEVER
  int probe;   // that answered, or whose radiance stands in; -1 = none resident
  bool environment;  // unknown and nothing plausible at the stop point: radiance comes from the direction alone
  pw_uint lookups;   // dependent reads: pyramid nodes, cells, start tests
  pw_uint tries;     // walks
  real3 plane;       // of a hit: the plane that was met, relative to the probe (tracer_walk.h); else 0
};

// Origin relative to a probe: float-float differences, exact to one ulp however far from the scene's origin.
PW_FUNCTION real3 relative_origin(ProbeRecord probe, real3 origin_hi, real3 origin_lo) {
  return (origin_hi - real3(probe.position_hi_m)) + (origin_lo - real3(probe.position_lo_m));
}

// w of the probe's vertex nearest to the direction of x.
PW_FUNCTION real nearest_vertex_w(ProbeRecord probe, real3 x) {
  int n = 1 << int(probe.n_log2);
  real2 uv = (octahedral_uv(x) + real2(1, 1)) * (real(n) * real(0.5)) + real2(0.5, 0.5);
  int i = min(max(int(uv.x), 0), n), j = min(max(int(uv.y), 0), n);
  return sample_w(probe.geometry_address, has_tiled_samples(probe), n, i, j);
}

// Does the probe see the point x (relative to it)? 2: clearly in front of its surface. 1: in front of, or within the
// margin behind, the nearest vertex. 0: hidden. Counts its look-ups.
PW_FUNCTION int start_test(ProbeRecord probe, real3 x, real margin, PW_INOUT(pw_uint) lookups) {
  real len = abs(x.x) + abs(x.y) + abs(x.z);
  if (len <= real(probe.l_min_m)) return 2;
  int n = 1 << int(probe.n_log2);
  real2 uv = (octahedral_uv(x) + real2(1, 1)) * (real(n) * real(0.5));
  real w = real(1) / len;
  int level = min(PW_START_LEVEL, pyramid_top(int(probe.n_log2)));
  if (level > 0) {
    int i = min(max(int(uv.x), 0), n - 1) >> level, j = min(max(int(uv.y), 0), n - 1) >> level;
    int node = pyramid_node(pyramid_begin(n, has_tiled_samples(probe)), n, level, i, j);
    lookups += 1u;
    if (w > entry_maximum(pyramid_entry(probe.geometry_address, node, i, j))) return 2;
  }
  lookups += 1u;
  real surface = nearest_vertex_w(probe, x);
  return surface <= real(0) || w > surface * (real(1) - margin) ? 1 : 0;
}

// PW_WALK: the walk of one ray through one probe, and PW_WALK_PARAMETER what trace_ray is given for it beforehand.
#ifdef PW_BASELINES
#include "baseline_walks.h"
#define PW_WALK_PARAMETER BaselineContext context,
#define PW_WALK_ARGUMENT context,
#define PW_WALK(probe, id, x, d, t, level, failures) walk_baseline(context, probe, id, x, d, t, failures)
#else
#define PW_WALK_PARAMETER
#define PW_WALK_ARGUMENT
#define PW_WALK(probe, id, x, d, t, level, failures) walk_probe(probe, x, d, t, level)
#endif

// A corner's score falls from half a cell away on, so that one that the next cell has not got is not the first choice at
// the border: else a step across it swaps the probes of many rays at once, and the picture jumps. In units of score a
// cell; above 2 no direction makes up for it.
#define PW_FADE_FROM real(0.5)
#define PW_FADE_PER_CELL real(8)

// The probes at the corners of a grid cell, corner (x, y, z) as number x + 2 y + 4 z; each is asked for by the best of
// the corners that it serves.
struct CellCandidates {
  int probe[PW_CANDIDATES];
  real score[PW_CANDIDATES];  // -PW_NEVER: not (or no more) to be asked
};

// The grid cell that holds a point (clamped to the grid): its lowest corner, and where in it the point lies, 0 to 1.
struct CellOfPoint {
  pw_ivec3 corner;
  real3 part;
};

PW_FUNCTION CellOfPoint cell_of_point(GridConstants grid, real3 q) {
  CellOfPoint at;
  real3 cell = (q - real3(grid.origin_m)) / real3(grid.spacing_m);
  int cx = min(max(int(floor(min(max(cell.x, real(-1)), real(65536)))), 0), max(0, grid.dims.x - 2));
  int cy = min(max(int(floor(min(max(cell.y, real(-1)), real(65536)))), 0), max(0, grid.dims.y - 2));
  int cz = min(max(int(floor(min(max(cell.z, real(-1)), real(65536)))), 0), max(0, grid.dims.z - 2));
  at.corner = pw_ivec3(cx, cy, cz);
  at.part = real3(min(max(cell.x - real(cx), real(0)), real(1)), min(max(cell.y - real(cy), real(0)), real(1)),
                  min(max(cell.z - real(cz), real(0)), real(1)));
  return at;
}

// What a corner's score is made of besides the ray's direction: the same for all rays that choose from one point.
struct CandidatePlace {
  real3 away;           // from the corner's probe to that point
  real distance;
  real less_distance;   // of the score: for the distance
  real less_border;     // of the score: for a corner beyond the cell's middle
  int probe;
  int resident;         // 0: not to be asked
};

PW_FUNCTION CandidatePlace candidate_place(GridConstants grid, TraceConstants dials, int first, CellOfPoint at, real3 q,
                                           int k) {
  CandidatePlace place;
  int x = min(at.corner.x + (k & 1), grid.dims.x - 1);
  int y = min(at.corner.y + ((k >> 1) & 1), grid.dims.y - 1);
  int z = min(at.corner.z + (k >> 2), grid.dims.z - 1);
  place.probe = int(pw_word(grid.table_address, (z * grid.dims.y + y) * grid.dims.x + x));
  ProbeRecord probe = pw_probe(grid, place.probe);
  place.resident = probe.n_log2 == 0u ? 0 : 1;
  place.away = q - real3(probe.position_hi_m);
  place.distance = sqrt(place.away.x * place.away.x + place.away.y * place.away.y + place.away.z * place.away.z) + real(1e-6);
  real weight = first == kFirstNearest ? real(1) : real(dials.distance_weight);
  place.less_distance = weight * place.distance * real(grid.inverse_diagonal);
  real off_x = (k & 1) != 0 ? real(1) - at.part.x : at.part.x, off_y = (k & 2) != 0 ? real(1) - at.part.y : at.part.y;
  real off_z = (k & 4) != 0 ? real(1) - at.part.z : at.part.z;
  real off = max(off_x, max(off_y, off_z));
  place.less_border = max(off - PW_FADE_FROM, real(0)) * PW_FADE_PER_CELL;
  return place;
}

// How promising a probe is for a ray of unit direction d: what is first of a cell has the highest score. Probes that are
// not resident have none.
PW_FUNCTION real candidate_score(CandidatePlace place, int first, real3 d) {
  if (place.resident == 0) return -PW_NEVER;
  if (first == kFirstNearest) return -place.less_distance;
  real cosine = (place.away.x * d.x + place.away.y * d.y + place.away.z * d.z) / place.distance;
  if (first == kFirstSigned) return cosine;
  if (first == kFirstUnsigned) return abs(cosine);
  return cosine - place.less_distance - place.less_border;
}

// When a corner is asked if `first` is asked first, by a fixed order.
PW_FUNCTION int corner_rank(int order, int first, int corner) {
  if (order == kOrderPlusThree) return (3 * (corner - first)) & 7;
  return (0x75134260 >> (4 * (corner ^ first))) & 7;
}

// The corner to be asked next; PW_CANDIDATES when there is none.
PW_FUNCTION int best_candidate(CellCandidates cell) {
  int best = PW_CANDIDATES;
  real best_score = -PW_NEVER;
  PW_UNROLL for (int k = 0; k < PW_CANDIDATES; ++k) {
    bool better = cell.score[k] > best_score;
    best = better ? k : best;
    best_score = better ? cell.score[k] : best_score;
  }
  return best;
}

PW_FUNCTION int candidate_probe(CellCandidates cell, int corner) {
  int id = cell.probe[0];
  PW_UNROLL for (int k = 1; k < PW_CANDIDATES; ++k) id = k == corner ? cell.probe[k] : id;
  return id;
}

// Takes a probe from all its corners.
PW_FUNCTION void strike_candidate(PW_INOUT(CellCandidates) cell, int id) {
  PW_UNROLL for (int k = 0; k < PW_CANDIDATES; ++k) {
    cell.score[k] = cell.probe[k] == id ? -PW_NEVER : cell.score[k];
  }
}

// The probes at the corners of the grid cell that holds q (clamped to the grid), scored by the rules; by default: how well
// the ray runs away from the probe, less its distance, less how far beyond the cell's middle its corner lies. Probes that
// are not resident are left out.
PW_FUNCTION CellCandidates cell_candidates(GridConstants grid, TraceConstants dials, SelectionRules rules, real3 q,
                                           real3 d) {
  CellCandidates list;
  CellOfPoint at = cell_of_point(grid, q);
  PW_UNROLL for (int k = 0; k < PW_CANDIDATES; ++k) {
    CandidatePlace place = candidate_place(grid, dials, rules.first, at, q, k);
    list.probe[k] = place.probe;
    list.score[k] = candidate_score(place, rules.first, d);
  }
  if (rules.order != kOrderSorted) {
    int first = best_candidate(list);
    PW_UNROLL for (int k = 0; k < PW_CANDIDATES; ++k) {
      if (list.score[k] > -PW_NEVER) list.score[k] = -real(corner_rank(rules.order, first, k));
    }
  }
  return list;
}

// What is known of a ray before it is traced.
struct RayHint {
  int probe;    // that it asks first, as the rules would choose it; -1: they are to choose
  real t_free;  // nothing is met before; 0: nothing is known
};

PW_FUNCTION RayHint no_hint() {
  RayHint hint;
  hint.probe = -1;
  hint.t_free = real(0);
  return hint;
}

// Traces a ray from origin_hi + origin_lo (metres, scene coordinates; hi is the float nearest, lo the rest) along the
// unit direction d. Probes are tried one after the other, each from where the last one's knowledge ended; candidates come
// from the cell of the current point, then from the cells one and two spacings ahead, then from the origin's; the start
// test skips those that cannot see the current point (design: fewer-tries, 1).
PW_FUNCTION RayAnswer trace_ray(PW_WALK_PARAMETER GridConstants grid, TraceConstants dials, SelectionRules rules,
                                real3 origin_hi, real3 origin_lo, real3 d, int start_level, RayHint hint) {
  RayAnswer answer;
  answer.cls = kClassUnknown;
  answer.t = real(0);
  answer.probe = -1;
  answer.environment = false;
  answer.lookups = 0u;
  answer.tries = 0u;
  answer.plane = real3(0);

  const real3 chosen_from = origin_hi + real3(rules.choice_shift_m);
  int failed_probe[PW_TRIES_LIMIT];
  real failed_t[PW_TRIES_LIMIT];
  int failures = 0;
  const int max_tries = min(int(dials.max_tries), PW_TRIES_LIMIT);
  const real ahead = real(grid.spacing_mean_m);
  real t = hint.t_free;
  // Stages 0 to 2 look where the ray has got to, and ahead of there; stage 3 at its origin.
  const int first_stage = rules.advance != 0 ? 0 : 3;
  int stage = first_stage;
  // Every turn walks once. Stages are gone through within it, so that rays that are traced side by side walk together.
  while (int(answer.tries) < max_tries) {
    int chosen = answer.tries == 0u ? hint.probe : -1;
    for (; chosen < 0 && stage < 4; stage += chosen < 0 ? 1 : 0) {
      // The first probe is chosen from the origin, whatever is known of the ray: the same as without.
      real t_cell = stage == 3 ? real(0) : (answer.tries == 0u ? real(0) : t) + real(stage) * ahead;
      CellCandidates cell = cell_candidates(grid, dials, rules, chosen_from + d * t_cell, d);
      int doubtful = -1;
      for (int k = best_candidate(cell); k < PW_CANDIDATES && chosen < 0; k = best_candidate(cell)) {
        int id = candidate_probe(cell, k);
        bool failed = false;
        for (int f = 0; f < failures; ++f) failed = failed || (failed_probe[f] == id && (rules.retry == 0 || failed_t[f] >= t));
        if (!failed) {
          int seen = 2;
          if (answer.tries > 0u && rules.start_test != 0) {
            ProbeRecord probe = pw_probe(grid, id);
            real3 x = relative_origin(probe, origin_hi, origin_lo) + d * (t + PW_START_AHEAD * ahead);
            seen = start_test(probe, x, real(dials.start_margin), answer.lookups);
          }
          if (seen == 2) chosen = id;
          if (seen == 1 && doubtful < 0) doubtful = id;
        }
        strike_candidate(cell, id);
      }
      if (chosen < 0) chosen = doubtful;
    }
    if (chosen < 0) break;
    ProbeRecord probe = pw_probe(grid, chosen);
    const real t_start = rules.hand_on != 0 ? t : real(0);
    WalkState walk = PW_WALK(probe, chosen, relative_origin(probe, origin_hi, origin_lo), d, t_start, start_level, failures);
    answer.tries += 1u;
    answer.lookups += walk.lookups;
    if (walk.status == kClassHit || walk.status == kClassMiss) {
      answer.cls = walk.status;
      answer.t = walk.status == kClassHit ? walk.t : PW_NEVER;
      answer.probe = chosen;
      answer.plane = walk.plane;
      return answer;
    }
    failed_probe[failures] = chosen;
    failed_t[failures] = rules.hand_on != 0 ? max(walk.t, t) : PW_NEVER;
    ++failures;
    if (walk.t_safe > t * real(1.00001) + PW_PROGRESS_M) stage = first_stage;
    t = max(t, walk.t_safe);
  }

  // Nobody knows: the ray is free up to t. The probe whose surface lies nearest to the stop point lends its radiance.
  answer.t = t;
  if (rules.last_resort == kLastResortNothing) return answer;
  CellCandidates cell = cell_candidates(grid, dials, rules, chosen_from + d * t, d);
  real best = PW_NEVER, nearest = PW_NEVER;
  int environment = -1, open = -1;
  for (int k = best_candidate(cell); k < PW_CANDIDATES; k = best_candidate(cell)) {
    int id = candidate_probe(cell, k);
    strike_candidate(cell, id);
    ProbeRecord probe = pw_probe(grid, id);
    real3 x = relative_origin(probe, origin_hi, origin_lo) + d * t;
    real len = abs(x.x) + abs(x.y) + abs(x.z);
    if (len < nearest) {
      nearest = len;
      environment = id;
    }
    if (open < 0 && nearest_vertex_w(probe, d) <= real(0)) open = id;
    answer.lookups += 1u;
    if (!(len > real(0))) continue;
    real off = abs(nearest_vertex_w(probe, x) * len - real(1));
    answer.lookups += 1u;
    if (off < best) {
      best = off;
      answer.probe = id;
    }
  }
  answer.environment = rules.last_resort == kLastResortEnvironment || !(best < PW_PLAUSIBLE);
  if (answer.environment) answer.probe = open >= 0 ? open : environment;
  return answer;
}

PW_FUNCTION RayAnswer trace_ray(PW_WALK_PARAMETER GridConstants grid, TraceConstants dials, SelectionRules rules,
                                real3 origin_hi, real3 origin_lo, real3 d, int start_level) {
  return trace_ray(PW_WALK_ARGUMENT grid, dials, rules, origin_hi, origin_lo, d, start_level, no_hint());
}

#ifndef PW_BASELINES
// The same by the product's own rules.
PW_FUNCTION RayAnswer trace_ray(GridConstants grid, TraceConstants dials, real3 origin_hi, real3 origin_lo, real3 d,
                                int start_level) {
  return trace_ray(grid, dials, default_rules(), origin_hi, origin_lo, d, start_level);
}
#endif

#undef PW_WALK
#undef PW_WALK_PARAMETER
#undef PW_WALK_ARGUMENT
