// What lies in each cell of space, as hashes: of the surfaces' shape, and of all that light makes of them.
#pragma once

#include <cstdint>
#include <vector>

#include "content/bake/rebake/space_cells.h"
#include "content/scene/scene.h"

namespace probewalk {

struct SceneCells {
  // By cell; 0 = nothing is there. Equal when a ray through the cell finds the same, wherever it passes and whatever
  // the triangles' numbers.
  std::vector<std::uint64_t> shape;
  // The same, materials, normals and textures included; outside also the sky.
  std::vector<std::uint64_t> look;
};

SceneCells hash_scene(const Scene& scene, const SpaceCells& cells);

}  // namespace probewalk
