#include "content/stream/room_boxes.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <tuple>

namespace probewalk {

namespace {

constexpr std::uint32_t kLeafRooms = 4;

double outside_m(const Bounds& box, const glm::dvec3& point_m) {
  return std::max(0.0, signed_distance_m(box, point_m));
}

}  // namespace

double signed_distance_m(const Bounds& box, const glm::dvec3& point_m) {
  const glm::dvec3 beyond_m = glm::max(box.lower_m - point_m, point_m - box.upper_m);
  const double out_m = glm::length(glm::max(beyond_m, glm::dvec3(0.0)));
  return out_m > 0.0 ? out_m : std::max({beyond_m.x, beyond_m.y, beyond_m.z});
}

RoomBoxes::RoomBoxes(std::vector<Bounds> bounds) : bounds_(std::move(bounds)), order_(bounds_.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  if (!order_.empty()) build(0, size());
}

void RoomBoxes::build(std::uint32_t begin, std::uint32_t end) {
  const std::size_t at = nodes_.size();
  Node node{bounds_[order_[begin]], begin, end, 0};
  for (std::uint32_t i = begin; i < end; ++i) {
    node.box.lower_m = glm::min(node.box.lower_m, bounds_[order_[i]].lower_m);
    node.box.upper_m = glm::max(node.box.upper_m, bounds_[order_[i]].upper_m);
  }
  nodes_.push_back(node);
  if (end - begin <= kLeafRooms) return;
  const glm::dvec3 size_m = node.box.upper_m - node.box.lower_m;
  const int axis = size_m.x >= size_m.y && size_m.x >= size_m.z ? 0 : size_m.y >= size_m.z ? 1 : 2;
  const auto middle = [&](std::uint32_t room) { return bounds_[room].lower_m[axis] + bounds_[room].upper_m[axis]; };
  const std::uint32_t half = begin + (end - begin) / 2;
  std::nth_element(
      order_.begin() + begin, order_.begin() + half, order_.begin() + end,
      [&](std::uint32_t a, std::uint32_t b) { return std::tuple(middle(a), a) < std::tuple(middle(b), b); });
  build(begin, half);
  nodes_[at].right = static_cast<std::uint32_t>(nodes_.size());
  build(half, end);
}

std::uint32_t RoomBoxes::find(const glm::dvec3& point_m) const {
  std::uint32_t found = 0;
  double found_m = std::numeric_limits<double>::infinity();
  std::array<std::uint32_t, 64> stack{};  // halving 2^32 rooms takes fewer
  std::size_t depth = 0;
  if (!nodes_.empty()) stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t at = stack[--depth];
    const Node& node = nodes_[at];
    if (outside_m(node.box, point_m) > found_m) continue;
    if (node.right == 0) {
      for (std::uint32_t i = node.begin; i < node.end; ++i) {
        const double distance_m = outside_m(bounds_[order_[i]], point_m);
        if (std::tuple(distance_m, order_[i]) < std::tuple(found_m, found)) {
          found = order_[i];
          found_m = distance_m;
        }
      }
      continue;
    }
    const bool left_first = outside_m(nodes_[at + 1].box, point_m) <= outside_m(nodes_[node.right].box, point_m);
    stack[depth++] = left_first ? node.right : at + 1;
    stack[depth++] = left_first ? at + 1 : node.right;
  }
  return found;
}

}  // namespace probewalk
