// Rooms that somebody can walk in and that got no probe.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "content/pack/pack_io.h"
#include "content/scene/space.h"

namespace probewalk {

// What to tell people of them; empty when there are none. rooms: as Space::rooms; most_probes: what was asked for.
std::string bare_rooms_warning(const Space& space, const std::vector<RoomEntry>& rooms, std::size_t most_probes);

}  // namespace probewalk
