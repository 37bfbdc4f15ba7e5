#include "content/bake/point_index.h"

#include <tbb/parallel_sort.h>

#include <utility>

namespace probewalk {

PointIndex::PointIndex(std::span<const Influence> influences, float cell_m) : cell_m_(cell_m) {
  struct Entry {
    std::uint64_t key;
    std::uint32_t point, influence;
    bool operator<(const Entry& other) const { return key != other.key ? key < other.key : point < other.point; }
  };
  std::vector<Entry> entries;
  for (std::uint32_t k = 0; k < influences.size(); ++k) {
    const glm::vec3 p = influences[k].member.position_m, half = influences[k].half_m;
    const glm::ivec3 low(glm::floor((p - half) / cell_m_)), high(glm::floor((p + half) / cell_m_));
    for (int z = low.z; z <= high.z; ++z) {
      for (int y = low.y; y <= high.y; ++y) {
        for (int x = low.x; x <= high.x; ++x) {
          entries.push_back({point_cell_key({x, y, z}), influences[k].member.point, k});
        }
      }
    }
  }
  tbb::parallel_sort(entries.begin(), entries.end());  // a point is once in a cell: one order
  members_.resize(entries.size());
  std::size_t cells = 0;
  for (std::size_t k = 0; k < entries.size(); ++k) {
    members_[k] = influences[entries[k].influence].member;
    cells += k == 0 || entries[k].key != entries[k - 1].key;
  }
  std::size_t capacity = 16;
  while (capacity < 2 * cells) capacity *= 2;
  buckets_.resize(capacity);
  for (std::size_t first = 0; first < entries.size();) {
    std::size_t end = first;
    while (end < entries.size() && entries[end].key == entries[first].key) ++end;
    std::size_t slot = first_slot(entries[first].key);
    while (buckets_[slot].key != kNone) slot = (slot + 1) & (capacity - 1);
    buckets_[slot] = {entries[first].key, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(end - first)};
    first = end;
  }
}

}  // namespace probewalk
