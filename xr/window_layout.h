// Where the eyes' pictures lie in a window: side by side or one alone, never distorted, black around them.
#pragma once

#include <volk.h>

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

namespace probewalk {

// What a window shows: eyes; kSpectator: a view of its own beside a headset; kNone: there is no window (a headset
// without a mirror).
enum class ShownEyes { kBoth, kLeft, kRight, kSpectator, kNone };

struct ShownView {
  std::uint32_t view = 0;
  VkOffset2D offset{};
  VkExtent2D extent{};
};

std::vector<ShownView> window_layout(ShownEyes eyes, VkExtent2D eye, VkExtent2D window);

// The view under a place in the window ((0, 0) top left to (1, 1)) and the place in that view, likewise.
struct PlaceInView {
  std::uint32_t view = 0;
  glm::dvec2 place{0.0};
};
std::optional<PlaceInView> view_under(const std::vector<ShownView>& layout, VkExtent2D window, glm::dvec2 place);

}  // namespace probewalk
