// What darkens a view for its viewer's comfort, as functions of time alone.
#pragma once

#include <glm/glm.hpp>
#include <optional>

namespace probewalk {

// A blink: the view darkens, the jump happens in the dark, the view comes back.
class Blink {
 public:
  static constexpr double kDown_s = 0.12;
  static constexpr double kUp_s = 0.20;

  // False, and nothing changes, while one is on its way.
  bool start(glm::dvec3 target_m);
  // Returns the target once, at the darkest moment.
  std::optional<glm::dvec3> advance(double dt_s);
  float darkness() const;  // 0 = picture, 1 = black

 private:
  enum class Phase { kNone, kDown, kUp };
  Phase phase_ = Phase::kNone;
  double elapsed_s_ = 0.0;
  glm::dvec3 target_m_{0.0};
};

// Towards 1 while something is the case and back to 0 afterwards, over a short distance of time rather than at once; or
// towards how much of it is the case.
class Ramp {
 public:
  explicit Ramp(double up_s, double down_s) : up_s_(up_s), down_s_(down_s) {}
  void advance(bool up, double dt_s) { advance_towards(up ? 1.0 : 0.0, dt_s); }
  void advance_towards(double target, double dt_s);  // 0 to 1
  float value() const { return static_cast<float>(value_); }

 private:
  double up_s_, down_s_;
  double value_ = 0.0;
};

// Darkens a view whose head left the free air.
class WallFade {
 public:
  static constexpr double kFade_s = 0.15;
  void advance(bool head_free, double dt_s) { ramp_.advance(!head_free, dt_s); }
  float darkness() const { return ramp_.value(); }

 private:
  Ramp ramp_{kFade_s, kFade_s};
};

}  // namespace probewalk
