// How far from a view's axis rays are one a pixel (shaders/shared/foveation.h).
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace probewalk {

// Angles from the view's axis, radians, 0 < full <= half < pi/2.
struct Foveation {
  float full_rad = 0.0f;  // up to here a ray a pixel
  float half_rad = 0.0f;  // up to here one for 2 x 2 pixels, beyond one for 4 x 4
};

struct FoveationLevel {
  const char* name;
  std::optional<Foveation> foveation;  // none: a ray a pixel everywhere
};

// off, low, medium, high.
const std::vector<FoveationLevel>& foveation_levels();
// Throws BadInput, which names the levels.
std::optional<Foveation> foveation_of(const std::string& name);

}  // namespace probewalk
