#include "xr/eye_scale.h"

#include <algorithm>

namespace probewalk {
namespace {

constexpr std::size_t kSpared = 2;  // hitches among frames_up that do not hold the scale down

}  // namespace

double EyeScale::foretold_ns(double at_present_ns, int steps) const {
  const double ratio = static_cast<double>(steps) / steps_;
  return at_present_ns * ratio * ratio;
}

void EyeScale::change(int steps) {
  steps_ = steps;
  recent_ns_.clear();
}

void EyeScale::add(std::int64_t gpu_busy_ns, std::int64_t period_ns, int drawn_steps) {
  if (drawn_steps != steps_ || gpu_busy_ns <= 0 || period_ns <= 0) return;
  recent_ns_.push_back(gpu_busy_ns);
  if (recent_ns_.size() > options_.frames_up) recent_ns_.pop_front();
  const auto period = static_cast<double>(period_ns);

  if (recent_ns_.size() >= options_.frames_down && steps_ > options_.least_steps) {
    std::vector<std::int64_t> last(recent_ns_.end() - static_cast<std::ptrdiff_t>(options_.frames_down),
                                   recent_ns_.end());
    const auto middle = last.begin() + static_cast<std::ptrdiff_t>(last.size() / 2);
    std::nth_element(last.begin(), middle, last.end());
    const auto usual_ns = static_cast<double>(*middle);
    if (usual_ns > options_.most_load * period) {
      int steps = steps_ - 1;
      while (steps > options_.least_steps && foretold_ns(usual_ns, steps) > options_.wanted_load * period) --steps;
      change(steps);
      return;
    }
  }
  if (recent_ns_.size() < options_.frames_up || steps_ >= options_.most_steps) return;
  std::vector<std::int64_t> all(recent_ns_.begin(), recent_ns_.end());
  const auto slow = all.end() - 1 - static_cast<std::ptrdiff_t>(std::min(kSpared, all.size() - 1));
  std::nth_element(all.begin(), slow, all.end());
  if (foretold_ns(static_cast<double>(*slow), steps_ + 1) <= options_.wanted_load * period) change(steps_ + 1);
}

}  // namespace probewalk
