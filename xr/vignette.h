// The comfort vignette: a view that moves in another way than its viewer's body is narrowed meanwhile, because what the
// eye's rim sees moving is what makes people sick (Fernandes and Feiner 2016, Combating VR Sickness through Subtle
// Dynamic Field-of-View Modification).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/guides.h"
#include "xr/fades.h"

namespace probewalk {

struct VignetteLevel {
  const char* name;
  double clear_rad;  // from a view's axis, what stays clear at full speed; 0 = no vignette
};

// off, low, medium, high.
const std::vector<VignetteLevel>& vignette_levels();
// Throws BadInput, which names the levels.
double vignette_clear_rad(const std::string& name);

class Vignette {
 public:
  static constexpr double kClose_s = 0.15;
  static constexpr double kOpen_s = 0.40;

  // 0 = it never closes.
  explicit Vignette(double clear_rad) : clear_rad_(clear_rad) {}
  // `motion`: how fast the view is moved against its viewer's body, 0 at rest to 1 at a walker's speed and more.
  void advance(double motion, double dt_s);
  // Nothing while it is open.
  std::optional<VignetteShape> shape() const;

 private:
  double clear_rad_;
  Ramp closed_{kClose_s, kOpen_s};
};

}  // namespace probewalk
