// What the light field reads in each cell of space, as hashes, and the values of its cache points.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "content/bake/light_field.h"
#include "content/bake/rebake/space_cells.h"

namespace probewalk {

struct LightCells {
  // By cell; 0 = nothing.
  std::vector<std::uint64_t> points;    // the cache points that reach it: where they are, not their values
  std::vector<std::uint64_t> emitters;  // what is known of emitters there; everywhere(): all emitters
  // By cache point.
  std::vector<std::uint64_t> identities;
  std::vector<CachedLight> indirect;  // values of the cache
  std::vector<glm::vec3> total;       // lux that arrive there, direct light included
};

LightCells hash_light(const LightField& light, const SpaceCells& cells);

}  // namespace probewalk
