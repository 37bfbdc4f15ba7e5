#include "content/bake/point_index.h"

#include <tbb/parallel_sort.h>

#include <utility>

namespace probewalk {
namespace {

constexpr std::uint32_t kOfOthers = ~0u;

struct Entry {
  std::uint64_t key;
  std::uint32_t point, influence;
  bool operator<(const Entry& other) const { return key != other.key ? key < other.key : point < other.point; }
};

template <typename Visit>
void for_each_cell(const PointIndex::Influence& influence, float cell_m, Visit&& visit) {
  const glm::vec3 p = influence.member.position_m, half = influence.half_m;
  const glm::ivec3 low(glm::floor((p - half) / cell_m)), high(glm::floor((p + half) / cell_m));
  for (int z = low.z; z <= high.z; ++z) {
    for (int y = low.y; y <= high.y; ++y) {
      for (int x = low.x; x <= high.x; ++x) visit(point_cell_key({x, y, z}));
    }
  }
}

}  // namespace

PointIndex::PointIndex(std::span<const Influence> influences, float cell_m, std::span<const Influence> closer)
    : cell_m_(cell_m) {
  std::vector<Entry> entries;
  for (std::uint32_t k = 0; k < influences.size(); ++k) {
    for_each_cell(influences[k], cell_m,
                  [&](std::uint64_t key) { entries.push_back({key, influences[k].member.point, k}); });
  }
  const std::size_t own = entries.size();
  for (const Influence& other : closer) {
    for_each_cell(other, cell_m, [&](std::uint64_t key) { entries.push_back({key, kOfOthers, 0}); });
  }
  tbb::parallel_sort(entries.begin(), entries.end());  // a point is once in a cell: one order
  members_.reserve(own);
  std::size_t cells = 0;
  for (std::size_t k = 0; k < entries.size(); ++k) cells += k == 0 || entries[k].key != entries[k - 1].key;
  std::size_t capacity = 16;
  while (capacity < 2 * cells) capacity *= 2;
  buckets_.resize(capacity);
  for (std::size_t first = 0; first < entries.size();) {
    Bucket bucket{entries[first].key, static_cast<std::uint32_t>(members_.size())};
    std::size_t k = first;
    for (; k < entries.size() && entries[k].key == bucket.key; ++k) {
      if (entries[k].point == kOfOthers) {
        bucket.has_closer = 1;
      } else {
        members_.push_back(influences[entries[k].influence].member);
      }
    }
    bucket.count = static_cast<std::uint32_t>(members_.size() - bucket.first) & 0x7FFFFFFFu;
    std::size_t slot = first_slot(bucket.key);
    while (buckets_[slot].key != kNone) slot = (slot + 1) & (capacity - 1);
    buckets_[slot] = bucket;
    first = k;
  }
}

}  // namespace probewalk
