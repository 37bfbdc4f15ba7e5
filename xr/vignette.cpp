#include "xr/vignette.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <numbers>

#include "content/error.h"

namespace probewalk {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
// Beyond the corners of most headsets' views, so that closing begins at their rim.
constexpr double kOpen_rad = 60.0 * kDegree;
constexpr double kSoft_rad = 12.0 * kDegree;  // from clear to black

}  // namespace

const std::vector<VignetteLevel>& vignette_levels() {
  static const std::vector<VignetteLevel> levels{
      {"off", 0.0}, {"low", 36.0 * kDegree}, {"medium", 28.0 * kDegree}, {"high", 18.0 * kDegree}};
  return levels;
}

double vignette_clear_rad(const std::string& name) {
  std::vector<std::string> names;
  for (const VignetteLevel& level : vignette_levels()) {
    if (level.name == name) return level.clear_rad;
    names.emplace_back(level.name);
  }
  throw BadInput(fmt::format("there is no vignette \"{}\"; it is one of {}", name, fmt::join(names, ", ")));
}

void Vignette::advance(double motion, double dt_s) {
  if (clear_rad_ > 0.0) closed_.advance_towards(motion, dt_s);
}

std::optional<VignetteShape> Vignette::shape() const {
  const double closed = closed_.value();
  if (closed <= 0.0) return std::nullopt;
  const double clear_rad = std::lerp(kOpen_rad, clear_rad_, closed);
  return VignetteShape{clear_rad, clear_rad + kSoft_rad};
}

}  // namespace probewalk
