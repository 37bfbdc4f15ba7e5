// Baseline maps of scenes that are formulas: what a probe sees there is exact, so that every difference of a march's
// answer is the march's own or the map's resolution.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "shaders/shared/baseline_layout.h"

namespace probewalk::test {

struct AnalyticHit {
  double t;
  glm::dvec3 normal;  // unit, either way
};
// First surface from a point along a unit direction; nothing = sky.
using AnalyticScene = std::function<std::optional<AnalyticHit>(glm::dvec3 from, glm::dvec3 d)>;

// A box seen from within, corner to corner.
AnalyticScene box_room(glm::dvec3 low, glm::dvec3 high);
AnalyticScene sphere(glm::dvec3 centre, double radius);
// The plane x = at, with a square hole of half side `half` around (y, z) = 0; half < 0: none.
AnalyticScene wall(double at, double half_hole);
// A vertical cylinder around the y axis through (x, z), without end.
AnalyticScene pole(double x, double z, double radius);
AnalyticScene nearest_of(std::vector<AnalyticScene> scenes);
AnalyticScene open_sky();

// Keeps the words that record() points to.
class AnalyticMap {
 public:
  AnalyticMap(const AnalyticScene& scene, glm::dvec3 probe, int n_log2);
  BaselineRecord record() const;
  int size() const { return 1 << n_log2_; }
  glm::dvec3 probe() const { return probe_; }
  float distance(int texel) const { return distance_[static_cast<std::size_t>(texel)]; }
  bool is_distance(std::uint64_t address) const {
    return address == reinterpret_cast<std::uintptr_t>(distance_.data());
  }

 private:
  glm::dvec3 probe_;
  int n_log2_;
  std::vector<float> distance_, minimum_;
  std::vector<pw_uint> normal_;
};

// Direction (not unit) of the point (u, v) of the octahedral map.
glm::dvec3 map_direction(double u, double v);

}  // namespace probewalk::test
