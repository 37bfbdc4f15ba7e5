#include "content/bake/point_index.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace probewalk {
namespace {

constexpr std::size_t kPiece = 4096;  // of the influences, for a thread
constexpr std::size_t kMany = 128;    // members of a cell, beyond which it is divided
constexpr int kDivisions = 2;
constexpr float kRounding = 1.001f;  // of a cell: a place on its border must find all

struct Entry {
  std::uint64_t key;
  std::uint32_t point, influence;
  bool operator<(const Entry& other) const { return key != other.key ? key < other.key : point < other.point; }
};

template <typename Visit>
void for_each_cell(const PointIndex::Influence& influence, float cell_m, Visit&& visit) {
  const glm::vec3 p = influence.member.position_m, half = influence.half_m();
  const glm::ivec3 low(glm::floor((p - half) / cell_m)), high(glm::floor((p + half) / cell_m));
  for (int z = low.z; z <= high.z; ++z) {
    for (int y = low.y; y <= high.y; ++y) {
      for (int x = low.x; x <= high.x; ++x) visit(glm::ivec3(x, y, z));
    }
  }
}

// Whether a point may count in a cell: false for none where it does. By the ball and the slice that the ellipsoid lies
// in.
bool reaches(const PointIndex::Influence& influence, glm::ivec3 cell, float cell_m) {
  const float half_m = kRounding * 0.5f * cell_m;
  const glm::vec3 offset = (glm::vec3(cell) + 0.5f) * cell_m - influence.member.position_m,
                  beyond = glm::max(glm::abs(offset) - half_m, 0.0f), normal = glm::abs(influence.member.normal);
  return glm::dot(beyond, beyond) < influence.reach_m * influence.reach_m &&
         std::abs(glm::dot(offset, influence.member.normal)) - half_m * (normal.x + normal.y + normal.z) <
             influence.across_m;
}

glm::ivec3 cell_of_key(std::uint64_t key) {
  const auto part = [](std::uint64_t v) { return static_cast<int>(v & 0x1FFFFFu) - (1 << 20); };
  return {part(key >> 42), part(key >> 21), part(key)};
}

}  // namespace

PointIndex::PointIndex(std::span<const Influence> influences, float cell_m) : cell_m_(cell_m) {
  std::vector<std::vector<Entry>> pieces((influences.size() + kPiece - 1) / kPiece);
  tbb::parallel_for(std::size_t(0), pieces.size(), [&](std::size_t piece) {
    for (std::size_t k = piece * kPiece; k < std::min((piece + 1) * kPiece, influences.size()); ++k) {
      for_each_cell(influences[k], cell_m, [&](glm::ivec3 cell) {
        if (!reaches(influences[k], cell, cell_m)) return;
        pieces[piece].push_back({point_cell_key(cell), influences[k].member.point, static_cast<std::uint32_t>(k)});
      });
    }
  });
  std::size_t count = 0;
  for (const std::vector<Entry>& piece : pieces) count += piece.size();
  std::vector<Entry> entries;
  entries.reserve(count);
  for (std::vector<Entry>& piece : pieces) {
    entries.insert(entries.end(), piece.begin(), piece.end());
    piece = {};
  }
  tbb::parallel_sort(entries.begin(), entries.end());  // a point is once in a cell: one order
  members_.reserve(count);
  std::size_t cells = 0;
  for (std::size_t k = 0; k < entries.size(); ++k) cells += k == 0 || entries[k].key != entries[k - 1].key;
  resize(std::bit_ceil(2 * cells));
  std::vector<std::uint32_t> numbers;
  for (std::size_t k = 0; k < entries.size();) {
    const std::uint64_t key = entries[k].key;
    numbers.clear();
    for (; k < entries.size() && entries[k].key == key; ++k) numbers.push_back(entries[k].influence);
    bucket(key).range = store(influences, numbers, cell_of_key(key), cell_m, kDivisions);
  }
}

void PointIndex::mark_closer(std::span<const Influence> closer) {
  for (const Influence& other : closer) {
    for_each_cell(other, cell_m_, [&](glm::ivec3 cell) { bucket(point_cell_key(cell)).has_closer = 1; });
  }
}

PointIndex::Bucket& PointIndex::bucket(std::uint64_t key) {
  if (2 * (cells_ + 1) > buckets_.size()) resize(std::max<std::size_t>(16, 2 * buckets_.size()));
  std::size_t slot = first_slot(key);
  while (buckets_[slot].key != kNone && buckets_[slot].key != key) slot = (slot + 1) & (buckets_.size() - 1);
  if (buckets_[slot].key == kNone) {
    buckets_[slot].key = key;
    ++cells_;
  }
  return buckets_[slot];
}

void PointIndex::resize(std::size_t capacity) {
  const std::vector<Bucket> before = std::exchange(buckets_, std::vector<Bucket>(std::max<std::size_t>(capacity, 16)));
  for (const Bucket& kept : before) {
    if (kept.key == kNone) continue;
    std::size_t slot = first_slot(kept.key);
    while (buckets_[slot].key != kNone) slot = (slot + 1) & (buckets_.size() - 1);
    buckets_[slot] = kept;
  }
}

PointIndex::Range PointIndex::store(std::span<const Influence> influences, std::span<const std::uint32_t> numbers,
                                    glm::ivec3 cell, float side_m, int divisions) {
  Range range;
  if (divisions == 0 || numbers.size() <= kMany) {
    range.first = static_cast<std::uint32_t>(members_.size());
    range.count = static_cast<std::uint32_t>(numbers.size()) & 0x7FFFFFFFu;
    for (const std::uint32_t number : numbers) members_.push_back(influences[number].member);
    return range;
  }
  range.first = static_cast<std::uint32_t>(parts_.size());
  range.is_divided = 1;
  parts_.resize(parts_.size() + 8);
  std::vector<std::uint32_t> of_part;
  for (int k = 0; k < 8; ++k) {
    const glm::ivec3 part = 2 * cell + glm::ivec3(k & 1, k >> 1 & 1, k >> 2);
    of_part.clear();
    for (const std::uint32_t number : numbers) {
      if (reaches(influences[number], part, 0.5f * side_m)) of_part.push_back(number);
    }
    const Range stored = store(influences, of_part, part, 0.5f * side_m, divisions - 1);
    parts_[range.first + part_of(part)] = stored;
  }
  return range;
}

}  // namespace probewalk
