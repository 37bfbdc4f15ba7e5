// Which cache points may count at a place: a hashed grid of cells, each with the points whose influence reaches it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace probewalk {

// A word for each cell of a grid of 2^21 cells an axis.
inline std::uint64_t point_cell_key(glm::ivec3 cell) {
  const auto part = [](int v) { return static_cast<std::uint64_t>(v + (1 << 20)) & 0x1FFFFFu; };
  return part(cell.x) << 42 | part(cell.y) << 21 | part(cell.z);
}

class PointIndex {
 public:
  // What decides whether a point matters at a place, copied beside its neighbours': looking is most of the work.
  struct Member {
    glm::vec3 position_m{0.0f};
    std::uint32_t point = 0;
    glm::vec3 normal{0.0f};
  };
  struct Influence {
    Member member;
    glm::vec3 half_m{0.0f};  // of the box around the point outside of which it does not count
  };

  struct Found {
    std::span<const Member> members;  // in the order of the points' numbers
    bool has_closer = false;          // points of another index may count there, too
  };

  PointIndex() = default;
  // cell_m > 0. The order of the influences does not matter. closer: of points that are in other indices.
  PointIndex(std::span<const Influence> influences, float cell_m, std::span<const Influence> closer = {});

  // Thread-safe.
  Found at(glm::vec3 position_m) const {
    if (buckets_.empty()) return {};
    const std::uint64_t key = point_cell_key(glm::ivec3(glm::floor(position_m / cell_m_)));
    for (std::size_t slot = first_slot(key);; slot = (slot + 1) & (buckets_.size() - 1)) {
      const Bucket& bucket = buckets_[slot];
      if (bucket.key == key) return {std::span(members_).subspan(bucket.first, bucket.count), bucket.has_closer != 0};
      if (bucket.key == kNone) return {};
    }
  }

 private:
  static constexpr std::uint64_t kNone = ~0ull;
  struct Bucket {
    std::uint64_t key = kNone;
    std::uint32_t first = 0, count : 31 = 0, has_closer : 1 = 0;
  };
  std::size_t first_slot(std::uint64_t key) const {
    return (key * 0x9E3779B97F4A7C15ull) >> 32 & (buckets_.size() - 1);
  }

  float cell_m_ = 1.0f;
  std::vector<Member> members_;  // grouped by the cell that they influence
  std::vector<Bucket> buckets_;  // open addressing, a power of two of them
};

}  // namespace probewalk
