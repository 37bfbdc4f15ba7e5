// When a display that does not pace its application lets the next frame begin: pure numbers, no clock.
#pragma once

#include <algorithm>
#include <cstdint>

namespace probewalk {

// Ticks lie `period` apart. A frame begins at a tick and is shown at the next one; a frame that is late begins at once,
// its display time is the first tick that it can still reach.
class FramePacer {
 public:
  struct Frame {
    std::int64_t wake_ns = 0;
    std::int64_t predicted_display_ns = 0;
  };
  explicit FramePacer(std::int64_t period_ns) : period_ns_(period_ns) {}
  std::int64_t period_ns() const { return period_ns_; }

  Frame next(std::int64_t now_ns) {
    if (tick_ns_ == 0) tick_ns_ = now_ns;
    const std::int64_t elapsed = std::max<std::int64_t>(0, now_ns - tick_ns_);
    // The tick at or after now; the first one after the last frame's in any case.
    const std::int64_t late_ticks = elapsed / period_ns_;
    Frame frame;
    frame.wake_ns = std::max(now_ns, tick_ns_);
    frame.predicted_display_ns = tick_ns_ + (late_ticks + 1) * period_ns_;
    tick_ns_ = frame.predicted_display_ns;
    return frame;
  }

 private:
  std::int64_t period_ns_;
  std::int64_t tick_ns_ = 0;  // when the next frame may begin
};

}  // namespace probewalk
