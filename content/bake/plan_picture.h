// A person's check of what was found: floors from above, one panel a storey, with rooms, portals, probes and the tour.
#pragma once

#include "content/bake/placement.h"
#include "content/image/image.h"
#include "content/scene/space.h"

namespace probewalk {

// Rooms in pastel, portals red, the tour blue from the green start, probes black (low ones hollow) with their numbers in
// the pack, which are those of the sites, where there is room for them; x to the right, z down. At most 2000 pixels a side; a plain grey picture for a space without floor.
ImageRgb8 draw_plan(const Space& space, const Placement& placement);

}  // namespace probewalk
