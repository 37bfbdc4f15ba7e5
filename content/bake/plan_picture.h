// A person's check of what was found: the storeys from above as an architect draws them, cut at the height of the eyes.
#pragma once

#include <string>
#include <vector>

#include "content/bake/floor_plan/label_places.h"
#include "content/bake/placement.h"
#include "content/image/image.h"
#include "content/scene/space.h"

namespace probewalk {

struct PlanPanel {
  double lowest_m = 0.0, highest_m = 0.0;  // y of the floors that it shows; stairs and steps not counted
  PixelBox box;
};

struct PlanLabel {
  enum class Of {
    kRoom,        // its name
    kRoomNumber,  // where the name has no room: the number under which the legend names it
    kProbes,      // numbers of the probes at one place, as in the pack
  };
  Of of = Of::kRoom;
  std::string text;   // lines of a name joined by blanks, numbers by slashes
  std::size_t index;  // of the room or the first of the probes
  PixelBox box;
};

struct PlanPicture {
  ImageRgb8 image;
  double px_per_m = 0.0;
  glm::dvec2 lower_m{0.0};  // x, z at the upper left of every panel
  std::vector<PlanPanel> panels;
  std::vector<PlanLabel> labels;     // no two of them overlap
  std::vector<std::string> legend;   // what it says

  glm::dvec2 pixel(std::size_t panel, glm::dvec3 point_m) const {
    return glm::dvec2(panels[panel].box.lower) + (glm::dvec2(point_m.x, point_m.z) - lower_m) * px_per_m;
  }
};

// x to the right, z down, storeys side by side. Walls are dark, windows lines, furniture lighter than walls; rooms that
// meet have different colours. Portals are as wide as their openings. A probe's number is its index in the pack, which
// is that of its site. Only what is there is drawn, and only that is in the legend. At most about eight million pixels,
// however large the scene.
PlanPicture draw_plan(const Scene& scene, const Space& space, const Placement& placement);

}  // namespace probewalk
