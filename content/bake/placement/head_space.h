// The air that heads can be in: over the floor, over and under the furniture along it, not behind walls or panes.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "content/scene/ray_scene.h"
#include "content/scene/space.h"
#include "content/scene/space/column_spans.h"

namespace probewalk {

class HeadSpace {
 public:
  // Over the space's floor; without one, all points of the bounds' inside that the start pose sees.
  HeadSpace(const Scene& scene, const RayScene& rays, const Space& space);

  // Is the point in reachable air, by the columns of the floor map? Says nothing about its distance to surfaces.
  bool holds(glm::dvec3 point_m) const;
  // Room of the air at a point that is held.
  int room(glm::dvec3 point_m) const;

  // Sample positions of heads, standing and sitting, about one every 0.5 m of floor (fewer on large floors).
  const std::vector<glm::dvec3>& eyes() const { return eyes_; }
  // Those in a box, bounds included, evenly thinned to at most `most`.
  std::vector<std::uint32_t> eyes_in(glm::dvec3 lower_m, glm::dvec3 upper_m, std::size_t most) const;
  // Of all eyes, floors' corners included.
  const Bounds& bounds() const { return bounds_; }
  // Heights of floors with their headroom and share of the area, ascending; empty without floor.
  struct Level {
    double floor_m, headroom_m, share;
  };
  const std::vector<Level>& levels() const { return levels_; }

 private:
  void spread_from_floor(const FloorMap& floor);
  void sample_standing(const Space& space);
  void sample_hovering(const Scene& scene, const RayScene& rays, const Space& space);
  std::int64_t gap_at(glm::dvec3 point_m) const;

  struct Owner {
    float floor_m = 0.0f;       // of the place from which the gap was reached
    std::uint16_t room = 0;
    bool reached = false;
  };
  ColumnSpans columns_;
  std::vector<Owner> above_;  // of the gap above each span
  std::vector<glm::dvec3> eyes_;
  std::vector<Level> levels_;
  Bounds bounds_;
  const RayScene& rays_;
  glm::dvec3 hover_m_{0.0};
  bool hovering_ = false;
};

}  // namespace probewalk
