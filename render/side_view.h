// One view more, beside those of a frame and from what that frame was drawn from: for who watches, not for the display.
#pragma once

#include <volk.h>

#include <cstdint>
#include <future>
#include <memory>

#include "render/buffer.h"
#include "render/device.h"
#include "render/frame_target.h"
#include "render/gpu_clock.h"
#include "render/guide_pass.h"
#include "render/image.h"
#include "render/resolve.h"
#include "render/stereo_tracer.h"

namespace probewalk {

class SideView {
 public:
  // A picture of one view; `tracer.views` is 1.
  SideView(const Device& device, const TracerOptions& tracer, VkFormat format);
  ~SideView();
  SideView(const SideView&) = delete;
  SideView& operator=(const SideView&) = delete;

  VkExtent2D extent() const { return tracer_.options().extent_px; }
  // The picture, left in VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL by what was recorded last.
  const FrameTarget& target() const { return target_; }

  // For FrameRenderer::submit_beside: the commands that draw a view, while the device does not run the last ones. What
  // guides need is made on a thread of its own when a picture first has some, which goes without until then, and is
  // given up when none has had any for a while.
  VkCommandBuffer record(const FrameConstants& constants, const Guides& guides);
  const TracerOptions& options() const { return tracer_.options(); }

 private:
  // What the next picture's guides are drawn by; null: it has none, or must go without.
  GuidePass* choose_guides(bool wanted);

  const Device& device_;
  StereoTracer tracer_;
  Resolve resolve_;
  Image image_;
  VkImageView view_ = VK_NULL_HANDLE;
  FrameTarget target_;
  Buffer constants_;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  std::unique_ptr<GuidePass> guides_;
  std::uint32_t pictures_without_guides_ = 0;
  std::future<std::unique_ptr<GuidePass>> guides_to_come_;  // last: its thread reads the others
};

}  // namespace probewalk
