// From damaged bytes to the probes they resemble: counts brought into range, sizes made to fit, samples and cuts moved
// into what a chunk may hold. So most mutations reach the tracer instead of ending at a check.
#pragma once

#include "content/pack/pack_io.h"

namespace probewalk::fuzz {

// Few and small probes, whatever the bytes say. Any bytes will do, none at all included.
RoomLevel repaired_level(std::span<const std::byte> damaged);

}  // namespace probewalk::fuzz
