// What stands under the storeys: scale, axes, what the signs mean, rooms whose names had no place.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "content/image/canvas.h"

namespace probewalk {

struct LegendEntry {
  std::string text;
  // Draws the sign around this pixel, at most 30 wide and 16 high.
  std::function<void(Canvas&, glm::dvec2)> sign;
};

struct Legend {
  std::vector<LegendEntry> signs;
  std::vector<LegendEntry> rooms;  // in columns
  double px_per_m = 1.0;
};

// Keeps as many rooms as a legend of this width may have lines for, and says how many it leaves out.
void leave_out_rooms(Legend& legend, int width_px);
Canvas draw_legend(const Legend& legend, int width_px);

}  // namespace probewalk
