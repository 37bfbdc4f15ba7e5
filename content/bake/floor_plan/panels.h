// The part of the sheet with the storeys: how large, where, and what is where on it.
#pragma once

#include <vector>

#include "content/bake/floor_plan/label_places.h"
#include "content/bake/floor_plan/storey_map.h"
#include "content/bake/placement.h"
#include "content/image/canvas.h"

namespace probewalk {

namespace plan_colour {
inline constexpr Colour kPaper{255, 255, 255}, kInk{28, 30, 36}, kFaint{200, 203, 209};
inline constexpr Colour kWall{52, 55, 63}, kCupboard{156, 157, 161}, kPane{214, 231, 245}, kPaneEdge{72, 92, 122};
inline constexpr Colour kPortal{214, 30, 36}, kTour{40, 86, 214}, kStart{0, 132, 56}, kProbe{28, 30, 36};
}  // namespace plan_colour

struct Panels {
  glm::dvec2 lower_m{0.0};  // x, z at the upper left of every panel
  double px_per_m = 1.0;
  std::vector<PixelBox> boxes;  // by storey
  glm::ivec2 size_px{0};        // of the part of the sheet, titles and margins included

  glm::dvec2 pixel(std::size_t storey, glm::dvec3 point_m) const {
    return glm::dvec2(boxes[storey].lower) + (glm::dvec2(point_m.x, point_m.z) - lower_m) * px_per_m;
  }
};

inline constexpr int kSheetMargin_px = 24;
inline constexpr int kPanelTitle_px = 26;  // over a panel

Panels lay_out_panels(const StoreyMaps& maps, const Space& space, const Placement& placement);

// A colour for every room; those of rooms that meet, or that only a wall parts, differ as long as colours last.
std::vector<Colour> choose_room_colours(const StoreyMaps& maps, std::size_t rooms);

// Floors, furniture, walls; notes what is dark.
void draw_matter(const StoreyMaps& maps, const Panels& panels, const std::vector<Colour>& colours, Canvas& canvas,
                 LabelPlaces& places);

}  // namespace probewalk
