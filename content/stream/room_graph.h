// Rooms as the residency policy sees them: boxes joined by portals. Pure geometry. What a question costs depends on the
// rooms around the point, not on how many there are.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "content/pack/manifest.h"
#include "content/stream/room_boxes.h"

namespace probewalk {

class RoomGraph {
 public:
  RoomGraph(std::span<const RoomEntry> rooms, std::span<const Portal> portals);

  std::size_t size() const { return boxes_.size(); }

  // The room that holds the point: the first whose bounds do, else the nearest. `previous` (a room, or -1) is kept
  // until the point is `margin_m` outside of it or as deep inside another that comes first, so that a head that sways
  // in a doorway stays in one room.
  std::uint32_t room_of(const glm::dvec3& point_m, std::int64_t previous, double margin_m) const;

  struct Reach {
    std::uint32_t room = 0;
    std::uint32_t portals = 0;  // fewest portals between
    double distance_m = 0.0;    // shortest way through the portals' middles, from the point
    // When a walker may be there, by the quickest of the ways through fewest portals that are walked; infinity where
    // there is none within as many portals as were asked for.
    double arrival_s = 0.0;
  };
  // Rooms within `most_portals` of `room`, itself first, by number of portals, then distance, then index. A walker goes
  // at `kIdleSpeed_m_s` plus what of `velocity_m_s` leads along the way, at least kLeastSpeed_m_s.
  std::vector<Reach> reach(std::uint32_t room, const glm::dvec3& point_m, std::uint32_t most_portals,
                           const glm::dvec3& velocity_m_s = glm::dvec3(0.0)) const;
  static constexpr double kIdleSpeed_m_s = 0.8;   // of somebody who may set out any moment
  static constexpr double kLeastSpeed_m_s = 0.3;  // of somebody who goes the other way and may turn

  struct Seen {
    std::uint32_t room = 0;
    std::uint32_t portals = 0;
    double share = 0.0;   // of all directions, at most; the room of the point has what is left
    bool in_view = true;  // some of it within kViewHalf_rad of the direction `look`
  };
  // Rooms that some ray from the point may reach through portals, at most kSeenPortals of them one behind the other; the
  // point's room first. Cones around the portals are intersected: none that can be seen is left out, unless that many
  // doors are in sight that looking at them would take too long.
  // `look` is a unit vector, or 0: all around.
  std::vector<Seen> seen(std::uint32_t room, const glm::dvec3& point_m, const glm::dvec3& look = glm::dvec3(0.0)) const;
  static constexpr double kViewHalf_rad = 1.2;  // the corner of a wide headset's view, and a little that the head turns
  static constexpr std::uint32_t kSeenPortals = 6;

 private:
  std::vector<Reach> ways(std::uint32_t room, const glm::dvec3& point_m, std::uint32_t most_portals,
                          const glm::dvec3& velocity_m_s, bool walked_only) const;

  struct Door {
    std::uint32_t to = 0;
    glm::dvec3 middle_m{0.0};
    std::uint32_t first_corner = 0, corners = 0;
    std::uint32_t portal = 0;
    bool walked = true;
  };
  // Directions within an angle of an axis, or all of them. Angles are kept as cosine and sine: a frame asks for many.
  struct Cone {
    glm::dvec3 axis{0.0};
    double cosine = -1.0, sine = 0.0;  // of the half angle; up to a right angle, or all around
    double share = 0.0;                // of all directions
    bool is_all() const { return cosine < 0.0; }
    // Whether directions of both are less than the half angles apart. Of no use for all directions.
    bool meets(const Cone& other) const;
  };
  Cone cone_of(const Door& door, const glm::dvec3& point_m) const;
  double share_of(const Door& door, const glm::dvec3& point_m) const;
  std::span<const Door> doors(std::uint32_t room) const {
    return {doors_.data() + first_door_[room], first_door_[room + 1] - first_door_[room]};
  }

  RoomBoxes boxes_;
  std::vector<std::uint32_t> first_door_;  // of each room, and the end
  std::vector<Door> doors_;
  std::vector<glm::dvec3> corners_m_;
  bool all_walked_ = true;
};

}  // namespace probewalk
