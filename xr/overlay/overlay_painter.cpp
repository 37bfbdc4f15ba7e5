#include "xr/overlay/overlay_painter.h"

#include <chrono>

namespace probewalk {

bool OverlayPainter::prepare(VkFormat format) {
  const bool shown = board_ != nullptr && board_->is_shown(OverlayPlace::kWindow);
  if (making_.valid() && making_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    drawing_ = making_.get();
  }
  if (!shown) {
    // Pictures with it may still be on the device until every slot has come round.
    if (drawing_ && ++hidden_pictures_ > slots_) drawing_.reset();
    return false;
  }
  hidden_pictures_ = 0;
  if (!drawing_ && !making_.valid()) {
    making_ =
        std::async(std::launch::async, [this, format] { return std::make_unique<Drawing>(device_, format, slots_); });
  }
  return drawing_ != nullptr;
}

void OverlayPainter::paint(VkCommandBuffer commands, std::uint32_t slot, VkImageView screen, VkExtent2D extent) {
  drawing_->pass.record(commands, slot, screen, extent, drawing_->panel.draw(board_->facts(), extent));
}

}  // namespace probewalk
