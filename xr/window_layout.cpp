#include "xr/window_layout.h"

#include <algorithm>
#include <cmath>

namespace probewalk {

std::vector<ShownView> window_layout(ShownEyes eyes, VkExtent2D eye, VkExtent2D window) {
  const std::vector<std::uint32_t> views = eyes == ShownEyes::kBoth    ? std::vector<std::uint32_t>{0, 1}
                                           : eyes == ShownEyes::kRight ? std::vector<std::uint32_t>{1}
                                                                       : std::vector<std::uint32_t>{0};
  const double column_px = static_cast<double>(window.width) / static_cast<double>(views.size());
  const double scale = std::min(column_px / eye.width, static_cast<double>(window.height) / eye.height);
  std::vector<ShownView> layout;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const double width = std::max(1.0, std::floor(eye.width * scale + 1e-6));
    const double height = std::max(1.0, std::floor(eye.height * scale + 1e-6));
    ShownView shown;
    shown.view = views[i];
    shown.extent = {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
    shown.offset = {static_cast<std::int32_t>(std::floor(column_px * static_cast<double>(i) + (column_px - width) / 2)),
                    static_cast<std::int32_t>(std::floor((window.height - height) / 2))};
    shown.offset = {std::max(0, shown.offset.x), std::max(0, shown.offset.y)};
    layout.push_back(shown);
  }
  return layout;
}

std::optional<PlaceInView> view_under(const std::vector<ShownView>& layout, VkExtent2D window, glm::dvec2 place) {
  const glm::dvec2 at = place * glm::dvec2(window.width, window.height);
  for (const ShownView& shown : layout) {
    const glm::dvec2 inside =
        (at - glm::dvec2(shown.offset.x, shown.offset.y)) / glm::dvec2(shown.extent.width, shown.extent.height);
    if (inside.x >= 0 && inside.y >= 0 && inside.x < 1 && inside.y < 1) return PlaceInView{shown.view, inside};
  }
  return std::nullopt;
}

}  // namespace probewalk
