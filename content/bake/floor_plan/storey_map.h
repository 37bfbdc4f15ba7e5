// What stands where on every storey, seen from above and cut at the height of the eyes: floor, furniture, cupboards,
// windows, walls, by the columns of the space's floor map.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "content/scene/scene.h"
#include "content/scene/space.h"

namespace probewalk {

enum class PlanMatter : std::uint8_t {
  kNothing,    // not part of the storey
  kVoid,       // open to a storey below
  kFloor,      // one can stand there, or could if one got there
  kFurniture,  // ends below the shoulder
  kCupboard,   // higher than the eyes, but not a wall
  kWindow,     // wall below and above, nothing between
  kWall,       // from below the eyes to near the ceiling; the inside of thick walls, too
};

struct PlanCell {
  PlanMatter matter = PlanMatter::kNothing;
  std::uint16_t room = 0;  // of floor and furniture: index into Space::rooms
  float floor_m = 0.0f;    // y of the floor there, or nearest to it
};

struct StoreyMap {
  double floor_m = 0.0;                       // y at which most of its floor lies
  double lowest_m = 0.0, highest_m = 0.0;     // y of the main levels that it has; stairs and steps between not counted
  std::vector<PlanCell> cells;                // x fastest
};

struct StoreyMaps {
  glm::dvec2 origin_m{0.0};  // x, z of the corner of cell (0, 0)
  double cell_m = 0.05;
  glm::ivec2 columns{0};
  glm::ivec2 used_from{0}, used_to{0};  // cells that are something on some storey; to excluded
  std::vector<StoreyMap> storeys;       // ascending; at least one

  const PlanCell& at(std::size_t storey, int ix, int iz) const {
    return storeys[storey].cells[std::size_t(iz) * columns.x + ix];
  }
  // That on whose floor the point stands, or over which it hangs.
  std::size_t storey_of(glm::dvec3 point_m) const;
};

// Levels that overlap nowhere share a storey: terraces of a hillside are one plan.
StoreyMaps map_storeys(const Scene& scene, const Space& space);

}  // namespace probewalk
