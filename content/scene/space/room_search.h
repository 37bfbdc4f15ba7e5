// Steps 8 to 10: rooms of a head map, found by where it narrows. Deterministic: every order is total.
#pragma once

#include <cstdint>
#include <vector>

#include "content/scene/space/head_map.h"

namespace probewalk {

struct RoomLimits {
  double smallest_m2 = 1.5;   // what is smaller is part of the room that it opens to widest
  double largest_m2 = 150.0;  // what is larger is cut: rooms are what streaming loads
};

struct FoundRooms {
  std::vector<std::int32_t> room;  // by place of the head map, 0 to count - 1, none without
  std::int32_t count = 0;
};

// Smaller rooms come first, so that a box of an L-shaped hall does not take what lies in its corner.
FoundRooms search_rooms(const HeadMap& heads, const RoomLimits& limits = {});

}  // namespace probewalk
