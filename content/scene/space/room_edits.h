// Corrections of rooms, the author's or found: merged, renamed, cut.
#pragma once

#include <cstdint>
#include <vector>

#include "content/scene/scene.h"
#include "content/scene/space.h"
#include "content/scene/space/floor_graph.h"

namespace probewalk {

// room: of each place of the graph, changed with the rooms. Rooms that nothing is left of, go; of rooms that are cut
// the bounds are those of what is left, of rooms that are merged those of both. Throws BadInput for an id that is not
// there or taken, and a line that cuts nothing.
void edit_rooms(const std::vector<RoomEdit>& edits, const FloorGraph& graph, std::vector<RoomRegion>& rooms,
                std::vector<std::int32_t>& room);

}  // namespace probewalk
