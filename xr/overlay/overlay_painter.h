// Brings the overlay into a window's picture. While it is hidden there is no panel, no memory and no pipeline; it is
// made on a thread of its own when first shown, and the picture goes without it until then.
#pragma once

#include <volk.h>

#include <cstdint>
#include <future>
#include <memory>

#include "render/device.h"
#include "render/overlay_pass.h"
#include "xr/overlay/overlay_board.h"
#include "xr/overlay/overlay_panel.h"

namespace probewalk {

class OverlayPainter {
 public:
  // Both outlive the painter; a board of null is never shown. Of `slots` pictures each may be on the device at once.
  OverlayPainter(const Device& device, const OverlayBoard* board, std::uint32_t slots)
      : device_(device), board_(board), slots_(slots) {}

  // Once a picture, before it is recorded: whether there is something to paint. The slots take turns, and the device is
  // done with what was recorded last for the one that is next.
  bool prepare(VkFormat format);
  // After prepare said so: draws over `screen`, in VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL.
  void paint(VkCommandBuffer commands, std::uint32_t slot, VkImageView screen, VkExtent2D extent);
  // Whether anything is held for it.
  bool is_held() const { return drawing_ != nullptr || making_.valid(); }

 private:
  struct Drawing {
    Drawing(const Device& device, VkFormat format, std::uint32_t slots) : pass(device, format, panel.atlas(), slots) {}
    OverlayPanel panel;
    OverlayPass pass;
  };

  const Device& device_;
  const OverlayBoard* board_;
  const std::uint32_t slots_;
  std::unique_ptr<Drawing> drawing_;
  std::future<std::unique_ptr<Drawing>> making_;
  std::uint32_t hidden_pictures_ = 0;
};

}  // namespace probewalk
