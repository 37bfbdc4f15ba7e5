// What locomotion wants shown over a picture (render/guide_pass.h draws it).
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <span>

namespace probewalk {

// Angles from a view's axis, radians, 0 < clear < black < pi/2: the picture as it is up to the first, black from the
// second on.
struct VignetteShape {
  double clear_rad = 0.0;
  double black_rad = 0.0;
  bool operator==(const VignetteShape&) const = default;
};

// Where a teleport would lead: green where it lands, red where it does not.
struct AimGuide {
  std::span<const glm::dvec3> way_m;    // in the world, at most kGuidePoints
  std::optional<glm::dvec3> landing_m;  // on the floor: a ring; nothing = a cross where the way ends
  double scale = 1.0;                   // metres of the scene to one of the viewer's
  bool shows_way = true;                // false: the marker alone (a way that begins in the eye)
};

struct Guides {
  std::optional<AimGuide> aim;
  std::optional<VignetteShape> vignette;

  bool any() const { return aim.has_value() || vignette.has_value(); }
};

}  // namespace probewalk
