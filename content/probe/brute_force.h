// The independent check of the tracer: the same probe, taken as what it means, a star-shaped surface of planar pieces
// around a point, intersected in double precision by visiting every piece. Shares no code with the tracer: no octants, no
// map coordinates along the ray, no pyramid; directions, cones and planes only.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "content/probe/probe_map.h"

namespace probewalk {

struct BruteAnswer {
  enum class Class { kHit, kMiss, kUnknown, kBehind } cls = Class::kMiss;
  double t = 0.0;
  bool on_cut = false;  // decided inside a triangle with a disconnected edge
};

class BruteForceProbe {
 public:
  explicit BruteForceProbe(const ProbeGeometry& geometry);

  // Ray x + t d from t_start on; x relative to the probe. With t_start > 0 a start less than a texel behind counts as a
  // hit, as on a hand-off.
  BruteAnswer trace(glm::dvec3 x, glm::dvec3 d, double t_start = 0.0) const;

 private:
  // A piece: the cone of directions with side[k] . p >= 0 for all k, holding the plane gradient . p = 1 (w of the surface
  // in direction q, |q|_1 = 1, is gradient . q). sky: nothing there.
  struct Piece {
    std::int32_t vertices[3];  // of its triangle, for the quick test
    std::int32_t sides;
    glm::dvec3 side[5];
    glm::dvec3 gradient;
    bool sky;
    bool cut;
  };
  void add_triangle(const ProbeGeometry& g, int i, int j, bool high);
  int n_;
  std::vector<glm::dvec3> directions_;  // per vertex, |q|_1 = 1
  std::vector<std::uint32_t> first_piece_;  // per triangle
  std::vector<Piece> pieces_;
};

}  // namespace probewalk
