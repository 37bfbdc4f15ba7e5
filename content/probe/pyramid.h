// The pyramid over a probe's cells that lets a ray skip empty space and meet walls as one plane (layout and meaning:
// shaders/shared/probe_layout.h).
#pragma once

#include <cstdint>
#include <vector>

#include "content/probe/probe_map.h"

namespace probewalk {

// The 15-bit code of w, rounded up: what it decodes to is at least w. 0 for 0.
std::uint32_t pyramid_code(float w);

// Appends the pyramid's words. maxima: n^2, largest w of each cell with its cut's extension; cut: whether it has a cut.
void append_pyramid(const ProbeGeometry& geometry, std::vector<float> maxima, const std::vector<bool>& cut,
                    std::vector<std::uint32_t>& words);

}  // namespace probewalk
