// Sets of cache points that are joined from many threads; which point stands for a set does not depend on their order.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace probewalk {

class PointSets {
 public:
  explicit PointSets(std::size_t count);
  // The least point of the set. Thread-safe, as join() is.
  std::uint32_t first_of(std::uint32_t point);
  void join(std::uint32_t a, std::uint32_t b);

 private:
  std::vector<std::atomic<std::uint32_t>> parents_;
};

}  // namespace probewalk
