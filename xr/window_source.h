// Frames to a window on the desktop: both eyes side by side, one of them, or a single view. Drag to look, WASD to walk, shift to run, Q and E
// (or the arrows) to turn, click on the floor to go there, R to recentre, F12 for a picture, Esc to leave.
#pragma once

#include "content/scene/space.h"
#include "xr/desktop_head.h"
#include "xr/eye_images.h"
#include "xr/eyes.h"
#include "xr/frame_pacer.h"
#include "xr/frame_source.h"
#include "xr/locomotion.h"
#include "xr/window.h"
#include "xr/window_layout.h"
#include "xr/window_swapchain.h"

namespace probewalk {

struct WindowOptions {
  VkExtent2D eye_size{640, 720};
  ShownEyes shown = ShownEyes::kBoth;
  EyeGeometry eyes;  // the viewer's: in their own metres
  ViewLayout views = ViewLayout::kStereo;  // or kMono, of which kLeft shows the one view
  LocomotionOptions locomotion;
  OverlayBoard* overlay = nullptr;  // shown and hidden by F1; outlives the source
};

// The window that shows eyes of this size without scaling them.
VkExtent2D window_size(const WindowOptions& options);

// The eyes keep their size when the window changes its own: the pictures are scaled.
class WindowSource final : public FrameSource {
 public:
  // `device` was made with the window's hooks; it, `window` and `floor` outlive the source.
  WindowSource(Window& window, const Device& device, const FloorMap& floor, const Pose& start,
               const WindowOptions& options);

  std::string kind() const override { return "window"; }
  std::string description() const override;
  SourceState poll() override;
  FrameTiming wait() override;
  void begin(FrameTiming&) override {}
  std::vector<ViewPose> locate(const FrameTiming& timing, ViewPose* head) override;
  VkExtent2D view_extent() const override { return options_.eye_size; }
  std::uint32_t view_count() const override { return view_count_of(options_.views); }
  VkFormat color_format() const override { return EyeImages::kFormat; }
  FrameTarget acquire(VkExtent2D drawn) override;
  void end(const FrameTiming& timing, const std::vector<ViewPose>& rendered_views) override;
  float fade() const override { return locomotion_.fade(); }
  std::optional<VignetteShape> vignette() const override { return locomotion_.vignette(); }
  const FloorArc* aim() const override { return locomotion_.aim(); }
  bool take_screenshot_request() override;
  bool take_lookups_request() override;

 private:
  // The ray through a place in the window, in the rig.
  std::optional<AimRay> ray_through(glm::dvec2 place) const;

  Window& window_;
  WindowOptions options_;
  EyeImages images_;
  WindowSwapchain swapchain_;
  FramePacer pacer_;
  Locomotion locomotion_;
  DesktopHead head_;
  WindowInput input_;
  FrameTarget target_;
  std::int64_t last_display_ns_ = 0;
  bool screenshot_ = false, lookups_ = false;
  bool lost_ = false;
};

}  // namespace probewalk
