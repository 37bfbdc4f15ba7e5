#include "content/stream/room_graph.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

namespace probewalk {

namespace {

std::vector<Bounds> bounds_of(std::span<const RoomEntry> rooms) {
  std::vector<Bounds> bounds;
  for (const RoomEntry& room : rooms) bounds.push_back(room.bounds);
  return bounds;
}

// Of the triangle seen from the origin, in steradians (Van Oosterom and Strackee 1983).
double solid_angle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  const double volume = std::abs(glm::dot(a, glm::cross(b, c)));
  const double below = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
  return 2.0 * std::abs(std::atan2(volume, below));
}

constexpr double kAllDirections = 4.0 * std::numbers::pi;
constexpr double kInTheDoorway_m = 0.3;   // so near to a portal every direction may lead through it
constexpr std::size_t kMostDoors = 1024;  // looked at from one point: a hall of many thousand costs no more than this
constexpr double kLeastLength_m = 1e-9;
const double kViewHalfCosine = std::cos(RoomGraph::kViewHalf_rad), kViewHalfSine = std::sin(RoomGraph::kViewHalf_rad);

}  // namespace

RoomGraph::RoomGraph(std::span<const RoomEntry> rooms, std::span<const Portal> portals) : boxes_(bounds_of(rooms)) {
  std::vector<std::uint32_t> count(rooms.size() + 1, 0);
  for (const Portal& portal : portals) {
    ++count[static_cast<std::size_t>(portal.room_a) + 1];
    ++count[static_cast<std::size_t>(portal.room_b) + 1];
  }
  for (std::size_t k = 1; k < count.size(); ++k) count[k] += count[k - 1];
  first_door_ = count;
  doors_.resize(2 * portals.size());
  std::uint32_t index = 0;
  for (const Portal& portal : portals) {
    Door door;
    door.first_corner = static_cast<std::uint32_t>(corners_m_.size());
    door.corners = static_cast<std::uint32_t>(portal.polygon.size());
    door.portal = index++;
    door.walked = portal.walked;
    all_walked_ = all_walked_ && portal.walked;
    for (const glm::dvec3& corner : portal.polygon) {
      corners_m_.push_back(corner);
      door.middle_m += corner / static_cast<double>(portal.polygon.size());
    }
    const auto a = static_cast<std::uint32_t>(portal.room_a), b = static_cast<std::uint32_t>(portal.room_b);
    door.to = b;
    doors_[count[a]++] = door;
    door.to = a;
    doors_[count[b]++] = door;
  }
}

std::uint32_t RoomGraph::room_of(const glm::dvec3& point_m, std::int64_t previous, double margin_m) const {
  const std::uint32_t found = boxes_.find(point_m);
  if (previous < 0 || static_cast<std::uint64_t>(previous) >= boxes_.size()) return found;
  const auto old_room = static_cast<std::uint32_t>(previous);
  if (found == old_room) return found;
  const double old_m = signed_distance_m(boxes_[old_room], point_m);
  const double new_m = signed_distance_m(boxes_[found], point_m);
  const bool left = old_m > margin_m && old_m > new_m;
  const bool deep_inside = new_m <= -margin_m;
  return left || deep_inside ? found : old_room;
}

// A room that is only seen into is as near as one behind a door; but nobody arrives there that way.
std::vector<RoomGraph::Reach> RoomGraph::reach(std::uint32_t room, const glm::dvec3& point_m,
                                               std::uint32_t most_portals, const glm::dvec3& velocity_m_s) const {
  std::vector<Reach> found = ways(room, point_m, most_portals, velocity_m_s, false);
  if (all_walked_) return found;
  std::vector<Reach> walked = ways(room, point_m, most_portals, velocity_m_s, true);
  std::ranges::sort(walked, {}, &Reach::room);
  for (Reach& reach : found) {
    const auto way = std::ranges::lower_bound(walked, reach.room, {}, &Reach::room);
    reach.arrival_s = way != walked.end() && way->room == reach.room ? way->arrival_s : HUGE_VAL;
  }
  return found;
}

std::vector<RoomGraph::Reach> RoomGraph::ways(std::uint32_t room, const glm::dvec3& point_m, std::uint32_t most_portals,
                                              const glm::dvec3& velocity_m_s, bool walked_only) const {
  struct Way {
    Reach reach;
    glm::dvec3 at_m;
  };
  std::vector<Reach> found{{room, 0, 0.0, 0.0}};
  std::vector<Way> ring{{found[0], point_m}}, next;
  std::vector<std::uint32_t> known{room};  // sorted
  for (std::uint32_t portals = 1; portals <= most_portals && !ring.empty(); ++portals) {
    next.clear();
    for (const Way& way : ring) {
      for (const Door& door : doors(way.reach.room)) {
        if (walked_only && !door.walked) continue;
        const glm::dvec3 step_m = door.middle_m - way.at_m;
        const double length_m = glm::length(step_m);
        const double along_m_s = length_m > kLeastLength_m ? glm::dot(velocity_m_s, step_m) / length_m : 0.0;
        const double speed_m_s = std::max(kLeastSpeed_m_s, kIdleSpeed_m_s + along_m_s);
        next.push_back({{door.to, portals, way.reach.distance_m + length_m, way.reach.arrival_s + length_m / speed_m_s},
                        door.middle_m});
      }
    }
    // The shortest way to each new room, with the earliest arrival of all ways.
    std::sort(next.begin(), next.end(), [](const Way& a, const Way& b) {
      return std::tuple(a.reach.room, a.reach.distance_m) < std::tuple(b.reach.room, b.reach.distance_m);
    });
    ring.clear();
    for (const Way& way : next) {
      if (!ring.empty() && ring.back().reach.room == way.reach.room) {
        ring.back().reach.arrival_s = std::min(ring.back().reach.arrival_s, way.reach.arrival_s);
      } else if (!std::ranges::binary_search(known, way.reach.room)) {
        ring.push_back(way);
      }
    }
    const auto old = static_cast<std::ptrdiff_t>(known.size());
    for (const Way& way : ring) {  // by room, as they were sorted
      found.push_back(way.reach);
      known.push_back(way.reach.room);
    }
    std::inplace_merge(known.begin(), known.begin() + old, known.end());
  }
  std::sort(found.begin(), found.end(), [](const Reach& a, const Reach& b) {
    return std::tuple(a.portals, a.distance_m, a.room) < std::tuple(b.portals, b.distance_m, b.room);
  });
  return found;
}

// Around a door; its share is not known yet, unless it is all around.
RoomGraph::Cone RoomGraph::cone_of(const Door& door, const glm::dvec3& point_m) const {
  const std::span corners_m(corners_m_.data() + door.first_corner, door.corners);
  const Cone all{.share = 0.5};
  double nearest_m = glm::distance(point_m, door.middle_m);
  glm::dvec3 sum(0.0);
  for (const glm::dvec3& corner : corners_m) {
    const double length_m = glm::distance(corner, point_m);
    nearest_m = std::min(nearest_m, length_m);
    if (length_m < kInTheDoorway_m) return all;
    sum += (corner - point_m) / length_m;
  }
  const double length = glm::length(sum);
  if (length < kLeastLength_m) return all;
  const glm::dvec3 axis = sum / length;
  double least_cosine = 1.0;
  for (const glm::dvec3& corner : corners_m) {
    least_cosine = std::min(least_cosine, glm::dot(axis, glm::normalize(corner - point_m)));
  }
  // Corners within less than a right angle of the axis: then all between them is, too.
  if (least_cosine < 0.1) return all;
  const glm::dvec3 normal = glm::cross(corners_m[1] - corners_m[0], corners_m[2] - corners_m[0]);
  if (nearest_m < 1.0 && glm::length(normal) > kLeastLength_m) {
    const double plane_m = std::abs(glm::dot(glm::normalize(normal), point_m - corners_m[0]));
    if (plane_m < kInTheDoorway_m) return all;
  }
  return {axis, least_cosine, std::sqrt(1.0 - least_cosine * least_cosine), 0.0};
}

double RoomGraph::share_of(const Door& door, const glm::dvec3& point_m) const {
  const std::span corners_m(corners_m_.data() + door.first_corner, door.corners);
  double angle = 0.0;
  for (std::size_t k = 2; k < corners_m.size(); ++k) {
    angle += solid_angle(corners_m[0] - point_m, corners_m[k - 1] - point_m, corners_m[k] - point_m);
  }
  return std::min(0.5, angle / kAllDirections);
}

bool RoomGraph::Cone::meets(const Cone& other) const {
  const double sum_cosine = cosine * other.cosine - sine * other.sine;
  const double sum_sine = sine * other.cosine + cosine * other.sine;
  return sum_sine < 0.0 || glm::dot(axis, other.axis) >= sum_cosine;  // together half a turn or more: always
}

std::vector<RoomGraph::Seen> RoomGraph::seen(std::uint32_t room, const glm::dvec3& point_m,
                                             const glm::dvec3& look) const {
  struct Look {
    std::uint32_t room, portals, through;  // the last: the portal before
    Cone cone;
  };
  constexpr std::uint32_t kNone = ~std::uint32_t{0};
  std::vector<Seen> found{{room, 0, 0.0}};
  std::vector<Look> looks{{room, 0, kNone, {.share = 1.0}}};
  const Cone view{look, kViewHalfCosine, kViewHalfSine, 0.0};
  std::size_t doors_left = kMostDoors;
  for (std::size_t k = 0; k < looks.size() && doors_left > 0; ++k) {
    const Look from = looks[k];
    if (from.portals == kSeenPortals) break;  // the others are no nearer
    for (const Door& door : doors(from.room)) {
      if (doors_left == 0) break;
      --doors_left;
      if (door.portal == from.through || door.to == room) continue;
      // What lies in the cone through the doors before and in that of this one: at least the smaller of the two.
      Cone cone = cone_of(door, point_m);
      if (!cone.is_all()) {
        if (!from.cone.is_all() && !from.cone.meets(cone)) continue;
        cone.share = share_of(door, point_m);
      }
      cone.share = std::min(cone.share, from.cone.share);
      if (from.cone.cosine > cone.cosine) {
        cone.axis = from.cone.axis;
        cone.cosine = from.cone.cosine;
        cone.sine = from.cone.sine;
      }
      const bool in_view = look == glm::dvec3(0.0) || cone.is_all() || view.meets(cone);
      const auto known = std::find_if(found.begin(), found.end(), [&](const Seen& s) { return s.room == door.to; });
      if (known == found.end()) {
        found.push_back({door.to, from.portals + 1, cone.share, in_view});
      } else {
        known->in_view = known->in_view || in_view;
        known->share = std::min(1.0, known->share + cone.share);
      }
      looks.push_back({door.to, from.portals + 1, door.portal, cone});
    }
  }
  double others = 0.0;
  for (const Seen& seen : found) others += seen.share;
  // Rooms behind one another share directions: scaled, so that the point's own room keeps at least half.
  const double scale = others > 0.5 ? 0.5 / others : 1.0;
  for (Seen& seen : found) seen.share *= scale;
  found[0].share = 1.0 - others * scale;
  return found;
}

}  // namespace probewalk
