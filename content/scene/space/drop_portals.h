// Openings that one looks through and does not walk: from the edge of a higher floor into the room below it. Galleries,
// stair wells, balconies, ledges.
#pragma once

#include <vector>

#include "content/scene/space.h"
#include "content/scene/space/column_spans.h"
#include "content/scene/space/head_map.h"

namespace probewalk {

// `room` of each place of the head map. Room a is the higher one. Each is an upright rectangle over a straight piece of
// the edge, or of the rail along it: what is seen of the one room from the other is seen through it, from above and from
// below.
std::vector<Portal> find_drops(const HeadMap& heads, const ColumnSpans& spans, const std::vector<std::int32_t>& room);

}  // namespace probewalk
