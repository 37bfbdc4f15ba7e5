#include "content/scene/space/parts.h"

#include <algorithm>
#include <cmath>

#include "content/scene/space.h"

namespace probewalk {

std::vector<FloorPart> find_parts(const FloorGraph& graph) {
  constexpr double kSmallest_m2 = 1.0;
  std::vector<std::int32_t> part_of(graph.places.size(), -1);
  std::vector<FloorPart> parts;
  for (std::size_t seed = 0; seed < graph.places.size(); ++seed) {
    if (part_of[seed] >= 0 || graph.places[seed].wall_m < float(kBodyRadius_m)) continue;
    const std::int32_t id = std::int32_t(parts.size());
    std::vector<std::int32_t> reached{std::int32_t(seed)};
    part_of[seed] = id;
    for (std::size_t i = 0; i < reached.size(); ++i) {
      for (const std::int32_t j : graph.places[reached[i]].link) {
        if (j < 0 || part_of[j] >= 0 || graph.places[j].wall_m < float(kBodyRadius_m)) continue;
        part_of[j] = id;
        reached.push_back(j);
      }
    }
    parts.emplace_back().places = std::move(reached);
  }

  const int rings = int(std::ceil(kBodyRadius_m / graph.cell_m));
  for (std::size_t id = 0; id < parts.size(); ++id) {
    std::vector<std::int32_t> front = parts[id].places;
    for (int ring = 0; ring < rings; ++ring) {
      std::vector<std::int32_t> grown;
      for (const std::int32_t i : front) {
        for (const std::int32_t j : graph.places[i].link) {
          if (j < 0 || part_of[j] >= 0) continue;
          part_of[j] = std::int32_t(id);
          grown.push_back(j);
        }
      }
      parts[id].places.insert(parts[id].places.end(), grown.begin(), grown.end());
      front = std::move(grown);
    }
  }

  for (FloorPart& part : parts) {
    std::sort(part.places.begin(), part.places.end());
    part.area_m2 = graph.area_m2(part.places.size());
    for (const std::int32_t i : part.places) part.widest_m = std::max(part.widest_m, 2.0 * graph.places[i].wall_m);
  }
  std::erase_if(parts, [](const FloorPart& part) { return part.area_m2 < kSmallest_m2; });
  return parts;
}

std::int32_t nearest_place(const FloorGraph& graph, const std::vector<std::int32_t>& places, glm::dvec3 position_m) {
  std::int32_t nearest = -1;
  double least = HUGE_VAL;
  for (const std::int32_t i : places) {
    const glm::dvec3 foot = graph.foot_m(i);
    const double rise = std::min(std::abs(position_m.y - foot.y), std::abs(position_m.y - graph.eye_m(i).y));
    const double dx = position_m.x - foot.x;
    const double dz = position_m.z - foot.z;
    // Too near to a wall costs as much as being a body's width away.
    const double tight = graph.places[i].wall_m < float(kBodyRadius_m) ? 2.0 * kBodyRadius_m : 0.0;
    const double cost = std::sqrt(dx * dx + dz * dz + rise * rise) + tight;
    if (cost < least) {
      least = cost;
      nearest = i;
    }
  }
  return nearest;
}

}  // namespace probewalk
