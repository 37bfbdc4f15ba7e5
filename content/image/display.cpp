#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "content/error.h"
#include "content/image/image.h"
#include "shaders/shared/display_transform.h"

namespace probewalk {
namespace {

// Brighter than anything shown, and small enough for the tone curve's arithmetic.
constexpr float kBrightest = 1e18f;

// Negative radiance is nobody's: the curve would mirror it.
float shown(float value) { return std::isnan(value) ? 0.0f : std::clamp(value, 0.0f, kBrightest); }

std::uint8_t to_byte(float value) { return static_cast<std::uint8_t>(std::lround(srgb_encode(value) * 255.0f)); }

}  // namespace

ImageRgb8 display_transform(const ImageRgbF& image, float exposure_ev) {
  ImageRgb8 result{image.width_px, image.height_px, {}};
  result.rgb.reserve(image.rgb.size() * 3);
  const float exposure = exposure_from_ev(exposure_ev);
  for (const glm::vec3& radiance : image.rgb) {
    const glm::vec3 exposed = radiance * exposure;
    const glm::vec3 color = tone_curve({shown(exposed.x), shown(exposed.y), shown(exposed.z)});
    for (int c = 0; c < 3; ++c) result.rgb.push_back(to_byte(color[c]));
  }
  return result;
}

ImageRgb8 false_colour(const std::vector<float>& values, int width_px, int height_px, float maximum) {
  constexpr glm::vec3 kLow(0.0f, 34.0f, 120.0f);
  constexpr glm::vec3 kHigh(253.0f, 231.0f, 37.0f);
  constexpr glm::vec3 kNoValue(255.0f, 0.0f, 255.0f);
  ImageRgb8 image{width_px, height_px, {}};
  image.rgb.reserve(values.size() * 3);
  for (const float value : values) {
    const glm::vec3 color =
        std::isfinite(value) ? glm::mix(kLow, kHigh, std::clamp(value / maximum, 0.0f, 1.0f)) : kNoValue;
    for (int c = 0; c < 3; ++c) image.rgb.push_back(static_cast<std::uint8_t>(std::lround(color[c])));
  }
  return image;
}

ImageRgb8 side_by_side(const std::vector<ImageRgb8>& images) {
  ImageRgb8 result;
  for (const ImageRgb8& image : images) {
    if (image.height_px != images.front().height_px) {
      throw BadInput(fmt::format("pictures of {} and {} pixels height cannot stand side by side",
                                 images.front().height_px, image.height_px));
    }
    result.width_px += image.width_px;
    result.height_px = image.height_px;
  }
  result.rgb.reserve(std::size_t{3} * result.width_px * result.height_px);
  for (int y = 0; y < result.height_px; ++y) {
    for (const ImageRgb8& image : images) {
      const std::size_t row_bytes = std::size_t{3} * image.width_px;
      const auto row = image.rgb.begin() + static_cast<std::ptrdiff_t>(row_bytes * y);
      result.rgb.insert(result.rgb.end(), row, row + static_cast<std::ptrdiff_t>(row_bytes));
    }
  }
  return result;
}

}  // namespace probewalk
