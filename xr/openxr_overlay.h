// The overlay for the wearer: a quad in the room, a layer of its own over the picture. While it is hidden there is no
// swapchain, no panel and no layer; all of it is made on a thread of its own when it is first shown. It is drawn ten
// times a second, laid out by another thread than the frame's.
#pragma once

#include <volk.h>

#include <cstdint>
#include <future>
#include <memory>
#include <optional>

#include "render/device.h"
#include "render/overlay_pass.h"
#include "render/target_views.h"
#include "xr/openxr_api.h"
#include "xr/openxr_swapchain.h"
#include "xr/overlay/overlay_board.h"
#include "xr/overlay/overlay_panel.h"
#include "xr/overlay/panel_place.h"

namespace probewalk {

class OpenXrOverlay {
 public:
  static constexpr VkExtent2D kExtent{408, 440};
  static constexpr float kWidth_m = 0.6f;

  // All outlive this. `format`: an sRGB format of the session's.
  OpenXrOverlay(const Device& device, XrSession session, VkFormat format, const OverlayBoard& board);
  ~OpenXrOverlay();
  OpenXrOverlay(const OpenXrOverlay&) = delete;
  OpenXrOverlay& operator=(const OpenXrOverlay&) = delete;

  // Once a frame that is drawn, before it ends, without the device's queue locked; the head is in `space`. Draws when a
  // new picture is there.
  OpenXrOutcome update(XrSpace space, XrTime time, glm::dvec3 head_m, const glm::dquat& head);
  // The layer over the frame under way; null: none. Valid until the next update.
  const XrCompositionLayerBaseHeader* layer() const;

 private:
  struct Drawing {
    Drawing(const Device& device, XrSession session, VkFormat format);
    OpenXrSwapchain swapchain;
    OverlayPanel panel;
    OverlayPass pass;
  };
  bool is_idle() const;  // the device has done what was submitted last
  void hide();
  OpenXrOutcome draw(const OverlayPicture& picture);
  void record(VkImage image, const OverlayPicture& picture);

  const Device& device_;
  const XrSession session_;
  const VkFormat format_;
  const OverlayBoard& board_;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  VkFence drawn_ = VK_NULL_HANDLE;
  TargetViews views_;  // of the swapchain's images
  std::unique_ptr<Drawing> drawing_;
  bool has_picture_ = false;  // the swapchain has been drawn into
  bool refused_ = false;      // the runtime has no room for it: not asked again
  XrTime next_at_ = 0;
  PanelPlace place_;
  XrCompositionLayerQuad quad_{XR_TYPE_COMPOSITION_LAYER_QUAD};
  // Last: their threads use what is above.
  std::future<std::unique_ptr<Drawing>> making_;
  std::future<OverlayPicture> picture_to_come_;
};

}  // namespace probewalk
