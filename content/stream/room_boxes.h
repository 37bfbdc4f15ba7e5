// Which room holds a point, in time that hardly grows with the number of rooms: a hierarchy of boxes.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "content/scene/space.h"

namespace probewalk {

// Positive outside, negative inside: how far the point is from the box's surface.
double signed_distance_m(const Bounds& box, const glm::dvec3& point_m);

class RoomBoxes {
 public:
  explicit RoomBoxes(std::vector<Bounds> bounds);

  const Bounds& operator[](std::uint32_t room) const { return bounds_[room]; }
  std::uint32_t size() const { return static_cast<std::uint32_t>(bounds_.size()); }
  // The first room whose box holds the point, else the nearest; 0 where there is none.
  std::uint32_t find(const glm::dvec3& point_m) const;

 private:
  struct Node {
    Bounds box;
    std::uint32_t begin = 0, end = 0;  // of order_; a leaf where `right` is 0
    std::uint32_t right = 0;           // the left child follows its parent
  };
  void build(std::uint32_t begin, std::uint32_t end);

  std::vector<Bounds> bounds_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace probewalk
