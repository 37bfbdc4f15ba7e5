// Where the rooms' names lie on the sheet: within the room, on as many lines as that takes, else a number that the legend
// explains.
#pragma once

#include <string>
#include <vector>

#include "content/bake/floor_plan/panels.h"
#include "content/image/lettering.h"

namespace probewalk {

inline constexpr Lettering kRoomLettering{10, 1.5};
inline constexpr Lettering kSmallLettering{8, 1.15};

struct RoomLabel {
  std::size_t room = 0, storey = 0;
  bool is_number = false;
  std::vector<std::string> lines;  // the last may be the area, in small letters
  bool has_area = false;
  PixelBox box;
  glm::dvec2 anchor{0.0};  // a pixel of the room, where the box lies outside of it
  bool outside = false;
};

// Names as they can be drawn: the id where a character of the name cannot, cut where very long.
std::vector<std::string> drawable_names(const Space& space);

// Square metres of every room on all storeys, furniture included.
std::vector<double> room_areas_m2(const StoreyMaps& maps, std::size_t rooms);

// For every storey that a room has much of, at least one. Takes its places.
std::vector<RoomLabel> place_room_labels(const StoreyMaps& maps, const Panels& panels,
                                         const std::vector<std::string>& names, LabelPlaces& places);

void draw_room_label(const RoomLabel& label, Colour ground, Canvas& canvas);

}  // namespace probewalk
