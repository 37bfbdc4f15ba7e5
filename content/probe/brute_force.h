// The independent check of the tracer: the same probe, taken as what it means, a star-shaped surface of planar pieces
// around a point, intersected in double precision by visiting every piece that it could meet. Shares no code with the
// tracer: no octants, no map coordinates along the ray, no pyramid; directions, cones and planes only. Patches of the
// map are passed over whole where the cone of directions around them is one that the ray never looks into.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "content/probe/probe_map.h"

namespace probewalk {

struct BruteAnswer {
  enum class Class { kHit, kMiss, kUnknown, kBehind } cls = Class::kMiss;
  double t = 0.0;
  glm::dvec3 plane{0.0};  // of the piece that decided: dot(plane, p) = 1 on it; 0 of a miss
  bool on_cut = false;    // decided inside a triangle with a disconnected edge
};

class BruteForceProbe {
 public:
  explicit BruteForceProbe(const ProbeGeometry& geometry);

  // Ray x + t d from t_start on; x relative to the probe. With t_start > 0 a start less than a texel behind counts as a
  // hit, as on a hand-off. Thread-safe.
  BruteAnswer trace(glm::dvec3 x, glm::dvec3 d, double t_start = 0.0) const;
  // The same without the patches: every piece of the map is looked at.
  BruteAnswer trace_every_piece(glm::dvec3 x, glm::dvec3 d, double t_start = 0.0) const;

 private:
  // A piece: the cone of directions with side[k] . p >= 0 for all k, holding the plane gradient . p = 1 (w of the
  // surface in direction q, |q|_1 = 1, is gradient . q). sky: nothing there.
  struct Piece {
    std::int32_t vertices[3];  // of its triangle, for the quick test
    std::int32_t sides;
    glm::dvec3 side[5];
    glm::dvec3 gradient;
    bool sky;
    bool cut;
  };
  // The directions of a square of cells lie within `radius` of the axis.
  struct Patch {
    glm::dvec3 axis;  // unit
    double cos_radius, sin_radius;
    bool wide;  // too wide for a cone: never passed over
  };
  // The directions that a ray looks into, seen from the probe: an arc of a great circle, from that of its start to d's.
  struct Arc;
  struct Visit {
    double t0, t1;
    const Piece* piece;
  };
  void add_triangle(const ProbeGeometry& g, int i, int j, bool high);
  Patch patch_around(int i, int j, int side) const;
  template <class Look>
  void for_each_cell_near(const Arc& arc, const Look& look) const;
  void visit_cell(const Arc& arc, int i, int j, std::vector<Visit>& visits) const;
  BruteAnswer decide(const Arc& arc, std::vector<Visit>& visits) const;

  int n_;
  std::vector<glm::dvec3> directions_;      // per vertex, |q|_1 = 1
  std::vector<std::uint32_t> first_piece_;  // per triangle
  std::vector<Piece> pieces_;
  std::vector<Patch> fine_, coarse_;  // kFinePatch and kCoarsePatch cells a side, row-major; the last may be cut short
};

}  // namespace probewalk
