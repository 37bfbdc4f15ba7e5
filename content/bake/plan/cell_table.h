// The grid through which rays find a plan's probes. Its spacing has nothing to do with where they stand: every vertex
// names the probe that does most for the rays that start or stop around it, so that the eight corners of a cell are the
// list of probes that serve it.
#pragma once

#include <cstdint>
#include <vector>

#include "content/bake/placement.h"
#include "content/bake/placement/head_space.h"
#include "content/bake/plan/coverage.h"

namespace probewalk {

// `probe` is sized and zero.
ProbeGrid plan_grid(const HeadSpace& heads);

// Fills grid.probe with indices into coverage.chosen().
void fill_cell_table(ProbeGrid& grid, const Coverage& coverage, const std::vector<EyeRay>& rays,
                     const RayScene& triangles);

}  // namespace probewalk
