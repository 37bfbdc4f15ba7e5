// Which cache points may count at a place: a hashed grid of cells, each with the points whose influence reaches it.
// Cells that many reach (amid grass) are divided, twice at most.
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
  // A point counts within an ellipsoid: so far along its surface, and so far across it.
  struct Influence {
    Member member;
    float reach_m = 0.0f;
    float across_m = 0.0f;  // at most reach_m

    // Of the box around it.
    glm::vec3 half_m() const {
      const glm::vec3 n2 = member.normal * member.normal;
      return glm::sqrt(glm::max(reach_m * reach_m * (1.0f - n2) + across_m * across_m * n2, 0.0f));
    }
  };

  struct Found {
    std::span<const Member> members;  // in the order of the points' numbers
    bool has_closer = false;          // points of another index may count there, too
  };

  PointIndex() = default;
  // cell_m > 0. The order of the influences does not matter.
  PointIndex(std::span<const Influence> influences, float cell_m);
  // Where points count that are in other indices is known from now on.
  void mark_closer(std::span<const Influence> closer);

  // Thread-safe.
  Found at(glm::vec3 position_m) const {
    if (buckets_.empty()) return {};
    const std::uint64_t key = point_cell_key(glm::ivec3(glm::floor(position_m / cell_m_)));
    for (std::size_t slot = first_slot(key);; slot = (slot + 1) & (buckets_.size() - 1)) {
      const Bucket& bucket = buckets_[slot];
      if (bucket.key == kNone) return {};
      if (bucket.key != key) continue;
      Range range = bucket.range;
      for (float side_m = 0.5f * cell_m_; range.is_divided; side_m *= 0.5f) {
        range = parts_[range.first + part_of(glm::ivec3(glm::floor(position_m / side_m)))];
      }
      return {std::span(members_).subspan(range.first, range.count), bucket.has_closer != 0};
    }
  }

 private:
  static constexpr std::uint64_t kNone = ~0ull;
  // Members, or eight parts.
  struct Range {
    std::uint32_t first = 0, count : 31 = 0, is_divided : 1 = 0;
  };
  struct Bucket {
    std::uint64_t key = kNone;
    Range range;
    std::uint32_t has_closer = 0;
  };
  // Of eight, by the number of the half cell.
  static std::uint32_t part_of(glm::ivec3 half) { return (half.x & 1) | (half.y & 1) << 1 | (half.z & 1) << 2; }
  Bucket& bucket(std::uint64_t key);  // a new one where there is none
  void resize(std::size_t capacity);
  Range store(std::span<const Influence> influences, std::span<const std::uint32_t> numbers, glm::ivec3 cell,
              float side_m, int divisions);
  std::size_t first_slot(std::uint64_t key) const {
    return (key * 0x9E3779B97F4A7C15ull) >> 32 & (buckets_.size() - 1);
  }

  float cell_m_ = 1.0f;
  std::vector<Member> members_;  // grouped by the cell that they influence
  std::vector<Range> parts_;     // of the divided cells, by eights
  std::vector<Bucket> buckets_;  // open addressing, a power of two of them
  std::size_t cells_ = 0;        // in use
};

}  // namespace probewalk
