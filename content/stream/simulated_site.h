// Buildings of any size for trials of streaming: a pack's rooms over and over, door to door.
#pragma once

#include <cstdint>

#include "content/pack/manifest.h"

namespace probewalk {

// A site of `rooms` rooms of 6 x 5 m in rows and columns. Each has the levels (sizes and bytes) of one of the pack's
// rooms in turn; doors join every room to the next of its row and every third to the one behind, so that all can be
// reached. The probes' places and the floor are left out: streaming does not ask for them. `pack` has at least one room
// with levels.
Manifest site_of_rooms(const Manifest& pack, std::uint32_t rooms);

}  // namespace probewalk
