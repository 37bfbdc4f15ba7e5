// How large the eyes are drawn, so that the device keeps its budget: numbers in, a scale out. No clock, no device.
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

namespace probewalk {

// Of both sides of a view. Steps of a twentieth: each costs or saves about a tenth of the rays.
inline constexpr int kEyeScaleSteps = 20;
inline constexpr int kLeastEyeScale_steps = 12;  // 0.6: below it, text and edges are lost rather than frames
inline constexpr double kLeastEyeScale = static_cast<double>(kLeastEyeScale_steps) / kEyeScaleSteps;

struct EyeScaleOptions {
  int least_steps = kLeastEyeScale_steps, most_steps = kEyeScaleSteps;
  // Shares of the period. Down as soon as the usual frame takes more than `most_load`; to a scale, or up to one, at
  // which frames are expected to take at most `wanted_load`. What lies between is left alone.
  double most_load = 0.9, wanted_load = 0.75;
  std::size_t frames_down = 9;  // the usual one of so many: a hitch alone moves nothing
  std::size_t frames_up = 90;   // of which the slowest but two must fit: a second or so
};

class EyeScale {
 public:
  explicit EyeScale(const EyeScaleOptions& options = {}) : options_(options), steps_(options.most_steps) {}

  int steps() const { return steps_; }
  double scale() const { return static_cast<double>(steps_) / kEyeScaleSteps; }

  // What a frame drawn at `drawn_steps` took on the device, in the order of frames. Those still under way when the
  // scale changed are told apart by their steps. A device's time grows with the number of rays, and some of it does
  // not: what is foretold upwards is too much, never too little.
  void add(std::int64_t gpu_busy_ns, std::int64_t period_ns, int drawn_steps);

 private:
  // Time of a frame at `steps`, from one at the present scale.
  double foretold_ns(double at_present_ns, int steps) const;
  void change(int steps);

  EyeScaleOptions options_;
  int steps_;
  std::deque<std::int64_t> recent_ns_;  // at the present scale, the newest last
};

}  // namespace probewalk
