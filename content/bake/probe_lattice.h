// Where probes may stand: on a lattice, so that their offsets from a room's origin are exact in float, in the pack and
// on the device, and are the very positions that rays were cast from.
#pragma once

#include <glm/glm.hpp>

namespace probewalk {

inline constexpr double kPositionSteps_per_m = 4096.0;

inline glm::dvec3 on_lattice(glm::dvec3 p) {
  return glm::round(p * kPositionSteps_per_m) / kPositionSteps_per_m;
}

}  // namespace probewalk
