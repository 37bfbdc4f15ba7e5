// How the overlay looks: the facts as triangles and letters, by Dear ImGui. No device, no window.
#pragma once

#include <volk.h>

#include "render/overlay_pass.h"
#include "xr/overlay/overlay_board.h"

struct ImGuiContext;

namespace probewalk {

class OverlayPanel {
 public:
  // Makes the letters, in some milliseconds. Any thread, also while other panels draw: they take turns.
  OverlayPanel();
  ~OverlayPanel();
  OverlayPanel(const OverlayPanel&) = delete;
  OverlayPanel& operator=(const OverlayPanel&) = delete;

  // Valid as long as the panel.
  OverlayAtlas atlas() const { return atlas_; }
  // For a screen of that size; the panel stays within it.
  OverlayPicture draw(const OverlayFacts& facts, VkExtent2D screen);

 private:
  ImGuiContext* context_ = nullptr;
  OverlayAtlas atlas_;
  bool is_measured_ = false;
};

}  // namespace probewalk
