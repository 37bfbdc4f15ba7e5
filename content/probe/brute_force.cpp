#include "content/probe/brute_force.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "shaders/shared/probe_layout.h"

namespace probewalk {

namespace {

// Cells a side of a patch. Powers of two: n is one.
constexpr int kFinePatch = 4;
constexpr int kCoarsePatch = 16;
// Slack of the patches' tests, in radians: far above rounding, far below a cell.
constexpr double kPatchSlack = 1e-7;

using Vertex = glm::ivec2;

// The cut fraction on the edge from a to b, measured from a; negative = connected. Edges are stored once, from the
// vertex that comes first in rows (smaller j, then smaller i).
double fraction(const ProbeGeometry& g, Vertex a, Vertex b) {
  const bool swapped = a.y > b.y || (a.y == b.y && a.x > b.x);
  const Vertex p = swapped ? b : a, q = swapped ? a : b;
  std::uint8_t edge = 0;
  const std::size_t n = static_cast<std::size_t>(g.n);
  if (p.y == q.y) {
    edge = g.edges_horizontal[p.y * n + p.x];
  } else if (p.x == q.x) {
    edge = g.edges_vertical[p.y * (n + 1) + p.x];
  } else {
    edge = g.edges_diagonal[p.y * n + std::min(p.x, q.x)];
  }
  if (edge == kConnected) return -1.0;
  const double at = (edge - 0.5) / kCutSteps;
  return swapped ? 1.0 - at : at;
}

// Gradient of the linear function on space that takes the given values at three directions.
glm::dvec3 linear_through(const std::array<glm::dvec3, 3>& q, glm::dvec3 values) {
  return glm::inverse(glm::transpose(glm::dmat3(q[0], q[1], q[2]))) * values;
}

}  // namespace

BruteForceProbe::BruteForceProbe(const ProbeGeometry& geometry) : n_(geometry.n) {
  const int n = n_;
  directions_.reserve(static_cast<std::size_t>(n + 1) * (n + 1));
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) directions_.push_back(octahedral_point(2.0 * i / n - 1.0, 2.0 * j / n - 1.0));
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      add_triangle(geometry, i, j, false);
      add_triangle(geometry, i, j, true);
    }
  }
  first_piece_.push_back(static_cast<std::uint32_t>(pieces_.size()));
  for (int j = 0; j < n; j += kFinePatch) {
    for (int i = 0; i < n; i += kFinePatch) fine_.push_back(patch_around(i, j, kFinePatch));
  }
  for (int j = 0; j < n; j += kCoarsePatch) {
    for (int i = 0; i < n; i += kCoarsePatch) coarse_.push_back(patch_around(i, j, kCoarsePatch));
  }
}

void BruteForceProbe::add_triangle(const ProbeGeometry& g, int i, int j, bool high) {
  first_piece_.push_back(static_cast<std::uint32_t>(pieces_.size()));
  const int half = n_ / 2;
  // The corner nearest the map's centre, and the steps away from it.
  const int su = i >= half ? 1 : -1, sv = j >= half ? 1 : -1;
  const Vertex inner{su > 0 ? i : i + 1, sv > 0 ? j : j + 1};
  const Vertex outer = inner + Vertex(su, sv);
  const std::array<Vertex, 3> v{high ? outer : inner, Vertex(inner.x + su, inner.y), Vertex(inner.x, inner.y + sv)};
  std::array<glm::dvec3, 3> q;
  std::array<double, 3> w;
  std::array<std::size_t, 3> index;
  for (int k = 0; k < 3; ++k) {
    index[k] = static_cast<std::size_t>(v[k].y) * (n_ + 1) + v[k].x;
    q[k] = directions_[index[k]];
    w[k] = g.w[index[k]];
  }
  std::array<double, 3> cut;  // edges 01, 12, 20
  for (int k = 0; k < 3; ++k) cut[k] = fraction(g, v[k], v[(k + 1) % 3]);

  Piece whole{};
  for (int k = 0; k < 3; ++k) whole.vertices[k] = static_cast<std::int32_t>(index[k]);
  // Barycentric coordinates are linear functions on space: rows of the inverse.
  const glm::dmat3 to_barycentric = glm::inverse(glm::dmat3(q[0], q[1], q[2]));
  std::array<glm::dvec3, 3> bary;
  for (int k = 0; k < 3; ++k) bary[k] = glm::dvec3(to_barycentric[0][k], to_barycentric[1][k], to_barycentric[2][k]);
  whole.sides = 3;
  for (int k = 0; k < 3; ++k) whole.side[k] = bary[k];

  const int cuts = (cut[0] >= 0) + (cut[1] >= 0) + (cut[2] >= 0);
  if (cuts == 0) {
    whole.sky = w[0] <= 0 && w[1] <= 0 && w[2] <= 0;
    whole.gradient = linear_through(q, {w[0], w[1], w[2]});
    pieces_.push_back(whole);
    return;
  }
  whole.cut = true;

  // Tangent planes, as values at the triangle's three directions. A step of one cell along the grid inside the triangle
  // is a difference of two of its directions: along u it is v1 - inner (low) or outer - v2 (high).
  const glm::dvec3 step_u = high ? q[0] - q[2] : q[1] - q[0], step_v = high ? q[0] - q[1] : q[2] - q[0];
  const auto tangent = [&](int k) -> glm::dvec2 {
    const std::uint16_t code = g.normals[index[k]];
    if (w[k] <= 0 || code == 0) return glm::dvec2(0.0);
    const glm::dvec3 normal(decode_normal(code));
    const double facing = glm::dot(normal, q[k]);
    if (std::abs(facing) < 1e-6) return glm::dvec2(0.0);
    glm::dvec2 slope(glm::dot(normal, step_u) * w[k] / facing, glm::dot(normal, step_v) * w[k] / facing);
    const double steepest = std::max(std::abs(slope.x), std::abs(slope.y)), limit = double(kSlopeClamp) * w[k];
    return steepest > limit ? slope * (limit / steepest) : slope;
  };
  // Positions of the vertices in steps of (u, v).
  const std::array<glm::dvec2, 3> at{high ? glm::dvec2(1, 1) : glm::dvec2(0, 0), glm::dvec2(1, 0), glm::dvec2(0, 1)};
  const auto plane = [&](int k, glm::dvec2 slope) {
    glm::dvec3 values;
    for (int m = 0; m < 3; ++m) values[m] = w[k] + glm::dot(slope, at[m] - at[k]);
    return linear_through(q, values);
  };

  if (cuts == 2) {
    // The vertex between the two cut edges stands alone.
    const int lone = cut[1] < 0 ? 0 : cut[2] < 0 ? 1 : 2;
    const int next = (lone + 1) % 3, last = (lone + 2) % 3;
    const double own_next = std::max(cut[lone], 0.01), own_last = std::max(1.0 - cut[last], 0.01);
    const glm::dvec3 line = bary[next] / own_next + bary[last] / own_last - (bary[0] + bary[1] + bary[2]);
    Piece alone = whole;
    alone.side[alone.sides++] = -line;
    alone.sky = w[lone] <= 0;
    alone.gradient = plane(lone, tangent(lone));
    pieces_.push_back(alone);
    const int own = w[next] >= w[last] ? next : last, other = own == next ? last : next;
    glm::dvec2 slope = 0.5 * (tangent(own) + tangent(other));
    const glm::dvec2 edge = at[other] - at[own];
    slope += edge * ((w[other] - w[own] - glm::dot(slope, edge)) / glm::dot(edge, edge));
    const double steepest = std::max(std::abs(slope.x), std::abs(slope.y)), limit = double(kSlopeClamp) * w[own];
    if (steepest > limit) slope *= limit / steepest;
    Piece pair = whole;
    pair.side[pair.sides++] = line;
    pair.sky = w[own] <= 0;
    pair.gradient = plane(own, slope);
    pieces_.push_back(pair);
    return;
  }
  for (int k = 0; k < 3; ++k) {
    Piece region = whole;
    region.side[region.sides++] = bary[k] - bary[(k + 1) % 3];
    region.side[region.sides++] = bary[k] - bary[(k + 2) % 3];
    region.sky = w[k] <= 0;
    region.gradient = plane(k, tangent(k));
    pieces_.push_back(region);
  }
}

BruteForceProbe::Patch BruteForceProbe::patch_around(int i0, int j0, int side) const {
  const int i1 = std::min(i0 + side, n_), j1 = std::min(j0 + side, n_);
  const auto direction = [&](int i, int j) {
    return glm::normalize(directions_[static_cast<std::size_t>(j) * (n_ + 1) + i]);
  };
  glm::dvec3 sum(0.0);
  for (int j = j0; j <= j1; ++j) {
    for (int i = i0; i <= i1; ++i) sum += direction(i, j);
  }
  Patch patch{glm::normalize(sum), 1.0, 0.0, false};
  // A cone narrower than a half-space that holds the corners of a triangle of directions holds all of it.
  for (int j = j0; j <= j1; ++j) {
    for (int i = i0; i <= i1; ++i) patch.cos_radius = std::min(patch.cos_radius, glm::dot(patch.axis, direction(i, j)));
  }
  patch.wide = !(patch.cos_radius > 0.2);
  patch.sin_radius = std::sqrt(std::max(0.0, 1.0 - patch.cos_radius * patch.cos_radius));
  return patch;
}

struct BruteForceProbe::Arc {
  glm::dvec3 x, d;
  double t_start;
  glm::dvec3 normal;          // unit, of the plane through the ray and the probe
  bool radial;                // there is no such plane: the ray runs straight at, or away from, the probe
  glm::dvec3 from, to;        // unit, the arc's ends; of a radial ray the only directions it has
  glm::dvec3 middle;          // unit
  double cos_half, sin_half;  // of the angle from the middle to the ends
  bool halves;                // the middle is well defined

  Arc(glm::dvec3 origin, glm::dvec3 direction, double start) : x(origin), d(direction), t_start(start) {
    const glm::dvec3 cross = glm::cross(x, d);
    const double size = glm::dot(x, x) * glm::dot(d, d);
    radial = glm::dot(cross, cross) <= 1e-24 * size;
    normal = radial ? glm::dvec3(0.0) : glm::normalize(cross);
    to = glm::normalize(d);
    from = glm::dot(x, x) > 0.0 ? glm::normalize(x) : to;
    const glm::dvec3 sum = from + to;
    const double length = glm::length(sum);
    halves = !radial && length > 1e-3;
    middle = halves ? sum / length : to;
    cos_half = 0.5 * length;
    sin_half = std::sqrt(std::max(0.0, 1.0 - cos_half * cos_half));
  }

  bool may_meet(const Patch& patch) const {
    if (patch.wide) return true;
    if (radial) {
      return std::max(glm::dot(patch.axis, from), glm::dot(patch.axis, to)) >= patch.cos_radius - kPatchSlack;
    }
    if (std::abs(glm::dot(normal, patch.axis)) > patch.sin_radius + kPatchSlack) return false;
    // Beyond either end of the arc? Half of it and the cone's radius together are less than half a turn.
    const double cos_reach = cos_half * patch.cos_radius - sin_half * patch.sin_radius;
    return !halves || glm::dot(middle, patch.axis) >= cos_reach - kPatchSlack;
  }
};

template <class Look>
void BruteForceProbe::for_each_cell_near(const Arc& arc, const Look& look) const {
  const int coarse_columns = (n_ + kCoarsePatch - 1) / kCoarsePatch, fine_columns = (n_ + kFinePatch - 1) / kFinePatch;
  for (int cj = 0; cj < n_; cj += kCoarsePatch) {
    for (int ci = 0; ci < n_; ci += kCoarsePatch) {
      if (!arc.may_meet(coarse_[static_cast<std::size_t>(cj / kCoarsePatch * coarse_columns + ci / kCoarsePatch)]))
        continue;
      for (int fj = cj; fj < std::min(cj + kCoarsePatch, n_); fj += kFinePatch) {
        for (int fi = ci; fi < std::min(ci + kCoarsePatch, n_); fi += kFinePatch) {
          if (!arc.may_meet(fine_[static_cast<std::size_t>(fj / kFinePatch * fine_columns + fi / kFinePatch)]))
            continue;
          for (int j = fj; j < fj + kFinePatch; ++j) {
            for (int i = fi; i < fi + kFinePatch; ++i) look(i, j);
          }
        }
      }
    }
  }
}

// Notes where the ray is inside the cones of the cell's pieces.
void BruteForceProbe::visit_cell(const Arc& arc, int i, int j, std::vector<Visit>& visits) const {
  const std::size_t first_triangle = 2 * (static_cast<std::size_t>(j) * n_ + i);
  for (std::size_t triangle = first_triangle; triangle < first_triangle + 2; ++triangle) {
    const Piece& first = pieces_[first_piece_[triangle]];
    if (!arc.radial) {
      // Only triangles that the ray's plane through the probe crosses can be met.
      double height[3];
      for (int k = 0; k < 3; ++k)
        height[k] = glm::dot(arc.normal, directions_[static_cast<std::size_t>(first.vertices[k])]);
      if (height[0] > 0 && height[1] > 0 && height[2] > 0) continue;
      if (height[0] < 0 && height[1] < 0 && height[2] < 0) continue;
    }
    for (std::uint32_t p = first_piece_[triangle]; p < first_piece_[triangle + 1]; ++p) {
      const Piece& piece = pieces_[p];
      double t0 = arc.t_start, t1 = 1e300;
      for (int k = 0; k < piece.sides; ++k) {
        const double at0 = glm::dot(piece.side[k], arc.x), slope = glm::dot(piece.side[k], arc.d);
        if (slope > 0) {
          t0 = std::max(t0, -at0 / slope);
        } else if (slope < 0) {
          t1 = std::min(t1, -at0 / slope);
        } else if (at0 < 0) {
          t1 = -1.0;
        }
      }
      // Cones that the ray only touches at a corner decide nothing.
      if (t1 - t0 > 1e-13 * (1.0 + t0)) visits.push_back({t0, t1, &piece});
    }
  }
}

BruteAnswer BruteForceProbe::trace(glm::dvec3 x, glm::dvec3 d, double t_start) const {
  const Arc arc(x, d, t_start);
  std::vector<Visit> visits;
  for_each_cell_near(arc, [&](int i, int j) { visit_cell(arc, i, j, visits); });
  return decide(arc, visits);
}

BruteAnswer BruteForceProbe::trace_every_piece(glm::dvec3 x, glm::dvec3 d, double t_start) const {
  const Arc arc(x, d, t_start);
  std::vector<Visit> visits;
  for (int j = 0; j < n_; ++j) {
    for (int i = 0; i < n_; ++i) visit_cell(arc, i, j, visits);
  }
  return decide(arc, visits);
}

// Along the ray, piece by piece.
BruteAnswer BruteForceProbe::decide(const Arc& arc, std::vector<Visit>& visits) const {
  const glm::dvec3 x = arc.x, d = arc.d;
  const double t_start = arc.t_start;
  std::sort(visits.begin(), visits.end(),
            [](const Visit& a, const Visit& b) { return a.t0 != b.t0 ? a.t0 < b.t0 : a.t1 < b.t1; });

  // Height above the surface, relative: f = (w_ray - w_surface) / w_ray = 1 - gradient . p, affine in t.
  BruteAnswer answer;
  const double texel = 2.0 / n_;
  bool known = false;
  for (const Visit& visit : visits) {
    const Piece& piece = *visit.piece;
    if (piece.sky) {
      known = true;
      continue;
    }
    const double f_x = 1.0 - glm::dot(piece.gradient, x), f_d = -glm::dot(piece.gradient, d);
    const double f0 = f_x + visit.t0 * f_d;
    const bool endless = visit.t1 > 1e290;
    // At infinity only the sign of the slope matters.
    const double f1 = endless ? f_d : f_x + visit.t1 * f_d;
    if (f0 <= 0 && (!known || piece.cut)) {
      answer.on_cut = piece.cut;
      answer.plane = piece.gradient;
      answer.t = visit.t0;
      const bool touching = !known && t_start > 0 && -f0 < texel;
      answer.cls = touching ? BruteAnswer::Class::kHit
                   : known  ? BruteAnswer::Class::kUnknown
                            : BruteAnswer::Class::kBehind;
      return answer;
    }
    known = true;
    if (f1 <= 0 && !(endless && f_d >= 0)) {
      answer.on_cut = piece.cut;
      answer.plane = piece.gradient;
      answer.cls = BruteAnswer::Class::kHit;
      answer.t = f0 > 0 ? std::max(visit.t0, f_x / -f_d) : visit.t0;
      return answer;
    }
  }
  answer.cls = BruteAnswer::Class::kMiss;
  answer.t = 1e300;
  return answer;
}

}  // namespace probewalk
