#include "content/bake/point_sets.h"

#include <utility>

namespace probewalk {

PointSets::PointSets(std::size_t count) : parents_(count) {
  for (std::size_t k = 0; k < count; ++k) parents_[k].store(std::uint32_t(k), std::memory_order_relaxed);
}

std::uint32_t PointSets::first_of(std::uint32_t point) {
  for (;;) {
    std::uint32_t parent = parents_[point].load(std::memory_order_relaxed);
    if (parent == point) return point;
    const std::uint32_t above = parents_[parent].load(std::memory_order_relaxed);
    parents_[point].compare_exchange_weak(parent, above, std::memory_order_relaxed);  // halves the way
    point = above;
  }
}

void PointSets::join(std::uint32_t a, std::uint32_t b) {
  for (;;) {
    a = first_of(a);
    b = first_of(b);
    if (a == b) return;
    if (a < b) std::swap(a, b);
    std::uint32_t expected = a;
    if (parents_[a].compare_exchange_weak(expected, b, std::memory_order_relaxed)) return;
  }
}

}  // namespace probewalk
