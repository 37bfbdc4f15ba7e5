#include "render/one_shot.h"

#include <cstdint>

#include "render/check.h"
#include "render/commands.h"

namespace probewalk {
namespace {

// A command pool and a fence for as long as one batch of commands runs.
struct OneShot {
  explicit OneShot(const Device& owner) : device(owner.handle()) {
    pool = make_command_pool(owner, owner.queue_family(), VK_COMMAND_POOL_CREATE_TRANSIENT_BIT);
    const VkFenceCreateInfo fence_info{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, nullptr, 0};
    check(vkCreateFence(device, &fence_info, nullptr, &fence), "vkCreateFence");
  }
  ~OneShot() {
    vkDestroyFence(device, fence, nullptr);
    vkDestroyCommandPool(device, pool, nullptr);
  }
  OneShot(const OneShot&) = delete;
  OneShot& operator=(const OneShot&) = delete;

  VkDevice device;
  VkCommandPool pool = VK_NULL_HANDLE;
  VkFence fence = VK_NULL_HANDLE;
};

}  // namespace

void run_commands(const Device& device, const std::function<void(VkCommandBuffer)>& record) {
  const OneShot shot(device);
  VkCommandBuffer commands = VK_NULL_HANDLE;
  allocate_commands(device, shot.pool, {&commands, 1});
  begin_commands(commands);
  record(commands);
  check(vkEndCommandBuffer(commands), "vkEndCommandBuffer");

  VkCommandBufferSubmitInfo buffer_info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
  buffer_info.commandBuffer = commands;
  VkSubmitInfo2 submit{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
  submit.commandBufferInfoCount = 1;
  submit.pCommandBufferInfos = &buffer_info;
  device.submit(submit, shot.fence);
  check(vkWaitForFences(device.handle(), 1, &shot.fence, VK_TRUE, UINT64_MAX), "vkWaitForFences");
}

void make_visible_to_cpu(VkCommandBuffer commands) {
  memory_barrier(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_WRITE_BIT,
                 VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
}

}  // namespace probewalk
