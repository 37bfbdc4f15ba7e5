// Lays flat triangles and letters over a finished picture. Everything is read from buffers by address: no vertex
// input, no descriptors, no samplers.
#pragma once

#include <volk.h>

#include <cstdint>
#include <span>
#include <vector>

#include "render/buffer.h"
#include "render/device.h"
#include "render/pipeline.h"
#include "shaders/shared/overlay_layout.h"

namespace probewalk {

// Triangles by three indices each, in the order in which they are laid over one another.
struct OverlayPicture {
  struct Part {
    VkRect2D clip{};  // within the screen
    std::uint32_t first_index = 0, indices = 0;
  };
  std::vector<OverlayVertex> vertices;
  std::vector<std::uint32_t> indices;
  std::vector<Part> parts;
};

// How much of each texel the letters cover.
struct OverlayAtlas {
  VkExtent2D extent{};
  std::span<const std::uint8_t> coverage;  // row-major
};

class OverlayPass {
 public:
  // `format`: an sRGB format, whose attachment encodes. Of `slots` pictures each may be on the device at once.
  OverlayPass(const Device& device, VkFormat format, const OverlayAtlas& atlas, std::uint32_t slots);

  // Draws over `screen`, a view of a colour attachment in VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, or over nothing with
  // VK_ATTACHMENT_LOAD_OP_CLEAR. The device must be done with what was recorded last for `slot`. Barriers are the
  // caller's.
  void record(VkCommandBuffer commands, std::uint32_t slot, VkImageView screen, VkExtent2D extent,
              const OverlayPicture& picture, VkAttachmentLoadOp load = VK_ATTACHMENT_LOAD_OP_LOAD);

 private:
  const Device& device_;
  VkExtent2D atlas_px_;
  Buffer atlas_;
  std::vector<Buffer> pictures_;  // one a slot, as large as it has needed to be
  Pipeline pipeline_;
};

}  // namespace probewalk
