#include "content/bake/floor_plan/label_places.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace probewalk {

LabelPlaces::LabelPlaces(glm::ivec2 size_px)
    : size_px_(size_px), at_(std::size_t(size_px.x) * std::size_t(size_px.y), 0) {}

void LabelPlaces::note(PixelBox box, std::uint8_t what) {
  box.lower = glm::clamp(box.lower, glm::ivec2(0), size_px_);
  box.upper = glm::clamp(box.upper, glm::ivec2(0), size_px_);
  for (int y = box.lower.y; y < box.upper.y; ++y) {
    for (int x = box.lower.x; x < box.upper.x; ++x) at_[std::size_t(y) * size_px_.x + x] |= what;
  }
}

void LabelPlaces::note_line(glm::dvec2 a, glm::dvec2 b, std::uint8_t what) {
  const int steps = int(std::min(glm::distance(a, b), 1e5)) + 1;
  for (int k = 0; k <= steps; ++k) {
    const glm::ivec2 p(glm::floor(a + (b - a) * (double(k) / steps)));
    note({p - 1, p + 2}, what);
  }
}

bool LabelPlaces::is_free(PixelBox box, std::uint8_t of) const {
  if (box.lower.x < 0 || box.lower.y < 0 || box.upper.x > size_px_.x || box.upper.y > size_px_.y) return false;
  for (int y = box.lower.y; y < box.upper.y; ++y) {
    for (int x = box.lower.x; x < box.upper.x; ++x) {
      if (at_[std::size_t(y) * size_px_.x + x] & of) return false;
    }
  }
  return true;
}

std::optional<PixelBox> LabelPlaces::take_beside(glm::dvec2 mark, double radius_px, glm::ivec2 size_px, double far_px,
                                                 PixelBox panel) {
  constexpr double kStep_px = 4.0;
  constexpr int kAngles = 16;
  constexpr double kGap_px = 2.0;
  // From a clear place near by to any place at all.
  struct Pass {
    std::uint8_t avoid;
    double far_px;
  };
  const Pass passes[]{{kLine | kDark | kMark | kLabel, 12.0},
                      {kDark | kMark | kLabel, 12.0},
                      {kMark | kLabel, 24.0},
                      {kMark | kLabel, far_px}};
  for (const Pass& pass : passes) {
    for (double away = 0.0; away <= std::min(pass.far_px, far_px); away += kStep_px) {
      for (int k = 0; k < kAngles; ++k) {
        // To the right first, as one reads; then alternately above and below.
        const double angle = (k % 2 ? -1.0 : 1.0) * ((k + 1) / 2) * 2.0 * std::numbers::pi / kAngles;
        const glm::dvec2 ahead(std::cos(angle), std::sin(angle));
        // The box touches the circle around the mark from outside.
        const glm::dvec2 middle = mark + ahead * (radius_px + kGap_px + away) + 0.5 * glm::dvec2(size_px) * ahead;
        const glm::ivec2 lower(glm::round(middle - 0.5 * glm::dvec2(size_px)));
        const PixelBox box{lower, lower + size_px};
        if (glm::any(glm::lessThan(box.lower, panel.lower)) || glm::any(glm::greaterThan(box.upper, panel.upper))) continue;
        if (!is_free({box.lower - 1, box.upper + 1}, pass.avoid)) continue;
        note(box, kLabel);
        return box;
      }
    }
  }
  return std::nullopt;
}

}  // namespace probewalk
