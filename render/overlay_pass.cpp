#include "render/overlay_pass.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "render/commands.h"
#include "render/spirv.h"

namespace probewalk {
namespace {

constexpr VkDeviceSize kLeastPicture_bytes = 64 << 10;

}  // namespace

OverlayPass::OverlayPass(const Device& device, VkFormat format, const OverlayAtlas& atlas, std::uint32_t slots)
    : device_(device),
      atlas_px_(atlas.extent),
      atlas_(device, (atlas.coverage.size() + 3) / 4 * 4, BufferMemory::kShared),
      pictures_(slots),
      pipeline_(Pipeline::blended(device, nullptr, spirv::k_overlay_vert, spirv::k_overlay_frag, format)) {
  std::memcpy(atlas_.mapped(), atlas.coverage.data(), atlas.coverage.size());
  atlas_.flush();
}

void OverlayPass::record(VkCommandBuffer commands, std::uint32_t slot, VkImageView screen, VkExtent2D extent,
                         const OverlayPicture& picture, VkAttachmentLoadOp load) {
  const VkDeviceSize vertex_bytes = picture.vertices.size() * sizeof(OverlayVertex);
  const VkDeviceSize index_bytes = picture.indices.size() * sizeof(std::uint32_t);
  const VkDeviceSize bytes = sizeof(OverlayHead) + vertex_bytes + index_bytes;
  Buffer& buffer = pictures_.at(slot);
  if (buffer.size_bytes() < bytes) {
    buffer = Buffer(device_, std::max(std::bit_ceil(bytes), kLeastPicture_bytes), BufferMemory::kShared);
  }
  OverlayHead head{};
  head.screen_px = {static_cast<int>(extent.width), static_cast<int>(extent.height)};
  head.atlas_px = {static_cast<int>(atlas_px_.width), static_cast<int>(atlas_px_.height)};
  head.atlas_address = address_words(atlas_.address());
  head.index_address = address_words(buffer.address() + sizeof(head) + vertex_bytes);
  std::memcpy(buffer.mapped(), &head, sizeof(head));
  std::memcpy(buffer.mapped() + sizeof(head), picture.vertices.data(), vertex_bytes);
  std::memcpy(buffer.mapped() + sizeof(head) + vertex_bytes, picture.indices.data(), index_bytes);
  buffer.flush();

  begin_drawing(commands, screen, extent, load);
  pipeline_.bind(commands, nullptr, {buffer.address()});
  for (const OverlayPicture::Part& part : picture.parts) {
    vkCmdSetScissor(commands, 0, 1, &part.clip);
    vkCmdDraw(commands, part.indices, 1, part.first_index, 0);
  }
  vkCmdEndRendering(commands);
}

}  // namespace probewalk
