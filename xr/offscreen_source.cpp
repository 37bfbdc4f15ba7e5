#include "xr/offscreen_source.h"

#include <fmt/format.h>

#include <chrono>
#include <thread>

#include "xr/latency/clock.h"

namespace probewalk {

OffscreenSource::OffscreenSource(const Device& device, const Pose& head, const OffscreenOptions& options)
    : head_(head),
      options_(options),
      images_(device, options.eye_size, view_count_of(options.layout)),
      pacer_(options.period_ns),
      start_ns_(now_ns()) {}

std::string OffscreenSource::description() const {
  return fmt::format("no display, {}x{} {}, {} of {:.3g} Hz", options_.eye_size.width, options_.eye_size.height,
                     options_.layout == ViewLayout::kMono     ? "in one view"
                     : options_.layout == ViewLayout::kStereo ? "an eye"
                                                              : "a view, insets in both eyes",
                     options_.in_real_time ? "at the pace" : "a fixed clock",
                     1e9 / static_cast<double>(options_.period_ns));
}

FrameTiming OffscreenSource::wait() {
  FrameTiming timing;
  timing.period_ns = options_.period_ns;
  timing.predicted_display_ns = start_ns_ + frame_++ * options_.period_ns;
  if (options_.in_real_time) {
    const FramePacer::Frame frame = pacer_.next(now_ns());
    if (const std::int64_t ahead_ns = frame.wake_ns - now_ns(); ahead_ns > 0) {
      std::this_thread::sleep_for(std::chrono::nanoseconds(ahead_ns));
    }
    timing.predicted_display_ns = frame.predicted_display_ns;
  }
  return timing;
}

std::vector<ViewPose> OffscreenSource::locate(const FrameTiming&, ViewPose* head) {
  return eyes_of(head_, options_.eyes, options_.eye_size, head, options_.layout);
}

}  // namespace probewalk
