// The size that the eyes are drawn at, frame by frame: fixed, or following what the device manages (eye_scale.h).
#pragma once

#include <volk.h>

#include <array>
#include <cmath>
#include <cstdint>

#include "render/frame_renderer.h"
#include "xr/eye_scale.h"

namespace probewalk {

class EyeResolution {
 public:
  // `fixed`: the scale of a display that does not adapt, within (0, 1].
  EyeResolution(VkExtent2D full, bool adapts, double fixed) : full_(full), adapts_(adapts), fixed_(fixed) {}

  double scale() const { return adapts_ ? eyes_.scale() : fixed_; }
  // Of the next frame: whole pixels, as near as they come to the full size's shape.
  VkExtent2D extent() const {
    const auto side = [&](std::uint32_t px) {
      return static_cast<std::uint32_t>(std::max(1.0, std::round(static_cast<double>(px) * scale())));
    };
    return {side(full_.width), side(full_.height)};
  }
  // The renderer's number of the frame that was drawn at the present scale.
  void drawn(std::uint64_t frame) { steps_of_[frame % kRemembered] = eyes_.steps(); }
  void finished(const FrameGpuTimes& times, std::int64_t period_ns) {
    if (adapts_) eyes_.add(times.whole.end_ns - times.whole.begin_ns, period_ns, steps_of_[times.frame % kRemembered]);
  }

 private:
  static constexpr std::size_t kRemembered = 64;  // as many times as the renderer keeps
  VkExtent2D full_;
  bool adapts_;
  double fixed_;
  EyeScale eyes_;
  std::array<int, kRemembered> steps_of_{};
};

}  // namespace probewalk
