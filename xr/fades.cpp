#include "xr/fades.h"

#include <algorithm>

namespace probewalk {

bool Blink::start(glm::dvec3 target_m) {
  if (phase_ != Phase::kNone) return false;
  phase_ = Phase::kDown;
  elapsed_s_ = 0.0;
  target_m_ = target_m;
  return true;
}

std::optional<glm::dvec3> Blink::advance(double dt_s) {
  if (phase_ == Phase::kNone) return std::nullopt;
  elapsed_s_ += dt_s;
  if (phase_ == Phase::kDown && elapsed_s_ >= kDown_s) {
    phase_ = Phase::kUp;
    elapsed_s_ = 0.0;
    return target_m_;
  }
  if (phase_ == Phase::kUp && elapsed_s_ >= kUp_s) phase_ = Phase::kNone;
  return std::nullopt;
}

float Blink::darkness() const {
  switch (phase_) {
    case Phase::kDown:
      return static_cast<float>(std::min(1.0, elapsed_s_ / kDown_s));
    case Phase::kUp:
      return static_cast<float>(std::max(0.0, 1.0 - elapsed_s_ / kUp_s));
    case Phase::kNone:
      break;
  }
  return 0.0f;
}

void Ramp::advance_towards(double target, double dt_s) {
  const double wanted = std::clamp(target, 0.0, 1.0);
  value_ = std::clamp(wanted, value_ - dt_s / down_s_, value_ + dt_s / up_s_);
}

}  // namespace probewalk
