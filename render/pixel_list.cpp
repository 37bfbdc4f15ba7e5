#include "render/pixel_list.h"

#include "render/commands.h"
#include "shaders/shared/pixel_list.h"

namespace probewalk {
namespace {

constexpr VkPipelineStageFlags2 kCompute = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
constexpr VkPipelineStageFlags2 kIndirect = VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT;
constexpr VkPipelineStageFlags2 kTransfer = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
constexpr VkAccessFlags2 kRead = VK_ACCESS_2_SHADER_STORAGE_READ_BIT, kWrite = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;

}  // namespace

bool can_be_listed(VkExtent2D extent_px) {
  constexpr std::uint32_t kMaxSide_px = 1u << kListSideBits;
  return extent_px.width <= kMaxSide_px && extent_px.height <= kMaxSide_px;
}

Buffer make_pixel_list(const Device& device, VkDeviceSize entry_bytes, VkDeviceSize entries) {
  return Buffer(device, sizeof(PixelListHead) + entry_bytes * entries, BufferMemory::kDevice,
                VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT);
}

void empty_pixel_list(VkCommandBuffer commands, const Buffer& list) {
  memory_barrier(commands, kCompute | kIndirect, 0, kTransfer, VK_ACCESS_2_TRANSFER_WRITE_BIT);
  const PixelListHead empty{0, 1, 1, 0};
  vkCmdUpdateBuffer(commands, list.handle(), 0, sizeof(empty), &empty);
  memory_barrier(commands, kTransfer | kCompute, VK_ACCESS_2_TRANSFER_WRITE_BIT | kWrite, kCompute, kRead | kWrite);
}

void dispatch_pixel_list(VkCommandBuffer commands, const Buffer& list) {
  memory_barrier(commands, kCompute, kWrite, kCompute | kIndirect,
                 kRead | kWrite | VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT);
  vkCmdDispatchIndirect(commands, list.handle(), 0);
}

}  // namespace probewalk
