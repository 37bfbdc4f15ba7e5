#include "xr/inset_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "content/error.h"

namespace probewalk {
namespace {

constexpr double kMaxSide_px = 16384;

// A view's part of the plane one metre ahead, y down.
struct Plane {
  explicit Plane(const ViewPose& view)
      : left(std::tan(view.fov_left_rad)),
        top(-std::tan(view.fov_up_rad)),
        width(std::tan(view.fov_right_rad) - left),
        height(-std::tan(view.fov_down_rad) - top) {}
  double left, top, width, height;
};

// Bilinear; u and v in [0, 1] across the picture, its border pixels go on outside.
void sample(const ImageRgb8& image, double u, double v, std::uint8_t* rgb) {
  const double x = std::clamp(u * image.width_px - 0.5, 0.0, image.width_px - 1.0);
  const double y = std::clamp(v * image.height_px - 0.5, 0.0, image.height_px - 1.0);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, image.width_px - 1), y1 = std::min(y0 + 1, image.height_px - 1);
  const double fx = x - x0, fy = y - y0;
  const auto at = [&](int px, int py, int c) {
    return static_cast<double>(image.rgb[3 * (static_cast<std::size_t>(py) * image.width_px + px) + c]);
  };
  for (int c = 0; c < 3; ++c) {
    const double above = at(x0, y0, c) + (at(x1, y0, c) - at(x0, y0, c)) * fx;
    const double below = at(x0, y1, c) + (at(x1, y1, c) - at(x0, y1, c)) * fx;
    rgb[c] = static_cast<std::uint8_t>(std::lround(above + (below - above) * fy));
  }
}

}  // namespace

ImageRgb8 with_inset(const ImageRgb8& wide, const ViewPose& wide_view, const ImageRgb8& inset,
                     const ViewPose& inset_view) {
  const Plane all(wide_view), middle(inset_view);
  const double width = std::round(inset.width_px * all.width / middle.width);
  const double height = std::round(inset.height_px * all.height / middle.height);
  if (!(width <= kMaxSide_px && height <= kMaxSide_px)) {
    throw BadUsage(
        fmt::format("a view of {}x{} with its inset in place has {:.0f}x{:.0f} pixels, more than {:.0f} a side; "
                    "choose smaller views",
                    wide.width_px, wide.height_px, width, height, kMaxSide_px));
  }
  ImageRgb8 shown;
  shown.width_px = static_cast<int>(width);
  shown.height_px = static_cast<int>(height);
  shown.rgb.resize(3 * static_cast<std::size_t>(shown.width_px) * static_cast<std::size_t>(shown.height_px));
  for (int y = 0; y < shown.height_px; ++y) {
    for (int x = 0; x < shown.width_px; ++x) {
      const double u = (x + 0.5) / shown.width_px, v = (y + 0.5) / shown.height_px;
      const double inset_u = (all.left + u * all.width - middle.left) / middle.width;
      const double inset_v = (all.top + v * all.height - middle.top) / middle.height;
      const bool is_inside = inset_u >= 0.0 && inset_u < 1.0 && inset_v >= 0.0 && inset_v < 1.0;
      std::uint8_t* rgb = &shown.rgb[3 * (static_cast<std::size_t>(y) * shown.width_px + x)];
      if (is_inside) {
        sample(inset, inset_u, inset_v, rgb);
      } else {
        sample(wide, u, v, rgb);
      }
    }
  }
  return shown;
}

}  // namespace probewalk
