#include <algorithm>
#include <cmath>
#include <tuple>

#include "content/scene/space.h"
#include "content/scene/space/floor_graph.h"

namespace probewalk {

std::int32_t FloorMap::find(glm::dvec3 position_m) const {
  const glm::dvec2 cell = glm::floor((glm::dvec2(position_m.x, position_m.z) - origin_m) / cell_m);
  if (!(cell.x >= 0.0 && cell.y >= 0.0 && cell.x < columns.x && cell.y < columns.y)) return -1;
  const std::int32_t ix = std::int32_t(cell.x);
  const std::int32_t iz = std::int32_t(cell.y);
  const float highest = float(position_m.y + kStep_m);
  const auto above =
      std::upper_bound(nodes.begin(), nodes.end(), std::tuple(iz, ix, highest),
                       [](const std::tuple<std::int32_t, std::int32_t, float>& key, const FloorNode& node) {
                         return key < std::tuple(node.iz, node.ix, node.floor_m);
                       });
  if (above == nodes.begin()) return -1;
  const auto found = above - 1;
  return found->ix == ix && found->iz == iz ? std::int32_t(found - nodes.begin()) : -1;
}

}  // namespace probewalk
