// Walls, floors and roofs: flat slabs with real thickness and rectangular openings, closed on all sides.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "content/scene/procedural/brush.h"

namespace probewalk::procedural {

// In the panel's own frame: x to the right, y up, from its lower left corner.
struct Opening {
  double left_m = 0.0, bottom_m = 0.0, right_m = 0.0, top_m = 0.0;
};

// The front lies in z = 0 of the brush's frame and faces +z, the back in z = -thickness_m.
struct Panel {
  double width_m = 0.0, height_m = 0.0, thickness_m = 0.2;
  std::vector<Opening> openings;
  // Further lines at which faces are split, so that each side can change its material there.
  std::vector<double> cuts_x_m, cuts_y_m;
  // Material of a face, by a world-space point 0.12 m in front of its middle.
  std::function<MaterialId(glm::dvec3 world_m)> material;
  MaterialId edge = 0;  // of the narrow sides and of the reveals in the openings
};

// Every vertex of one face is a vertex of its neighbours: no ray passes between them.
void draw_panel(Brush brush, const Panel& panel);

}  // namespace probewalk::procedural
