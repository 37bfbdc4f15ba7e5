// Frames without a display: a fixed clock, images of its own. The same path gives the same frames on any machine.
#pragma once

#include "content/scene/space.h"
#include "xr/eye_images.h"
#include "xr/eyes.h"
#include "xr/frame_pacer.h"
#include "xr/frame_source.h"

namespace probewalk {

inline constexpr std::int64_t kDefaultPeriod_ns = 13'888'889;  // 72 Hz

struct OffscreenOptions {
  VkExtent2D eye_size{640, 720};
  std::int64_t period_ns = kDefaultPeriod_ns;
  bool in_real_time = false;  // frames begin when a display of this period would let them
  EyeGeometry eyes;
  ViewLayout layout = ViewLayout::kStereo;
};

// Frame i (from 0) has the display time start + i * period, however long frames take: it has no deadlines, and wait
// does not block. In real time it stands in for a display that has gone: paced and late like one.
class OffscreenSource final : public FrameSource {
 public:
  // The head stays at `head`; a walk that replays a path moves it.
  OffscreenSource(const Device& device, const Pose& head, const OffscreenOptions& options);

  std::string kind() const override { return "offscreen"; }
  std::string description() const override;
  SourceState poll() override { return SourceState::kRunning; }
  FrameTiming wait() override;
  void begin(FrameTiming&) override {}
  std::vector<ViewPose> locate(const FrameTiming& timing, ViewPose* head) override;
  VkExtent2D view_extent() const override { return options_.eye_size; }
  std::uint32_t view_count() const override { return view_count_of(options_.layout); }
  VkFormat color_format() const override { return EyeImages::kFormat; }
  FrameTarget acquire(VkExtent2D drawn) override { return images_.next(drawn); }
  void end(const FrameTiming&, const std::vector<ViewPose>&) override {}

 private:
  Pose head_;
  OffscreenOptions options_;
  EyeImages images_;
  FramePacer pacer_;
  std::int64_t start_ns_;
  std::int64_t frame_ = 0;
};

}  // namespace probewalk
