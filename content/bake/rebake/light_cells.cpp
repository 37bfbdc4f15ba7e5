#include "content/bake/rebake/light_cells.h"

#include <tbb/parallel_for.h>

#include <atomic>
#include <span>

#include "content/bake/cache_points.h"
#include "content/bake/direct_light.h"
#include "content/pack/pack_io.h"

namespace probewalk {
namespace {

void add_in_box(const SpaceCells& cells, glm::dvec3 lower_m, glm::dvec3 upper_m, std::uint64_t hash,
                std::vector<std::uint64_t>& sums) {
  const auto add = [&](std::size_t cell) { std::atomic_ref(sums[cell]).fetch_add(hash, std::memory_order_relaxed); };
  const glm::ivec3 low = cells.cell_of(lower_m), high = cells.cell_of(upper_m);
  if (!cells.holds(low) || !cells.holds(high)) add(cells.outside());
  const glm::ivec3 first = glm::max(low, glm::ivec3(0)), last = glm::min(high, cells.dims - 1);
  for (int z = first.z; z <= last.z; ++z) {
    for (int y = first.y; y <= last.y; ++y) {
      for (int x = first.x; x <= last.x; ++x) add(cells.index({x, y, z}));
    }
  }
}

}  // namespace

LightCells hash_light(const LightField& light, const SpaceCells& cells) {
  const CachePoints& points = light.points();
  LightCells result;
  result.points.assign(cells.count(), 0);
  result.emitters.assign(cells.count(), 0);
  result.identities.resize(points.size());
  result.total.resize(points.size());
  result.indirect = light.cache_values();
  tbb::parallel_for(std::size_t(0), points.size(), [&](std::size_t k) {
    constexpr double kRounding_m = 1e-4;
    const CachePoints::Point& point = points[k];
    result.identities[k] = points.identity(k);
    const glm::dvec3 half_m = glm::dvec3(points.influence(k).half_m()) + kRounding_m;
    add_in_box(cells, glm::dvec3(point.position_m) - half_m, glm::dvec3(point.position_m) + half_m,
               result.identities[k], result.points);
    std::uint64_t cast = 0;
    result.total[k] = result.indirect[k].lux + light.direct().irradiance(point.position_m, point.geometric_normal, point.normal, cast);
  });
  const std::vector<std::uint64_t> emitters = emitter_hashes(light.direct().emitters());
  const std::uint64_t all = short_hash(std::as_bytes(std::span(emitters)));
  light.direct().grid().for_each_hash(emitters, all, [&](glm::vec3 corner_m, float side_m, std::uint64_t hash) {
    add_in_box(cells, glm::dvec3(corner_m) - 1e-4, glm::dvec3(corner_m) + double(side_m) + 1e-4, hash, result.emitters);
  });
  result.emitters[cells.everywhere()] = all;
  return result;
}

}  // namespace probewalk
