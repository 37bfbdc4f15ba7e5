// Step 7: where heads can be, which furniture below 1.4 m does not part: the floor of the kept parts, and what stands
// along its edges. Rooms are told apart on this map: on the floor alone a table would make two of one.
#pragma once

#include <cstdint>
#include <vector>

#include "content/scene/space/column_spans.h"
#include "content/scene/space/floor_graph.h"

namespace probewalk {

inline constexpr double kFurnitureDepth_m = 1.25;  // how far a head can lean over what stands along the floor's edge

struct HeadMap {
  // As a floor graph: places that heads can be above, linked over steps up to 0.5 m, wall_m to what stops a head. What
  // stands on the floor has the floor's height.
  FloorGraph graph;
  std::vector<std::int32_t> floor_place;  // by place: the place of the floor graph that it is; -1 over furniture
};

// `kept` and `other` by place of the floor: part of the space; part of another large floor, which no head leans over
// to.
HeadMap build_head_map(const FloorGraph& floor, const ColumnSpans& spans, const std::vector<bool>& kept,
                       const std::vector<bool>& other);

}  // namespace probewalk
