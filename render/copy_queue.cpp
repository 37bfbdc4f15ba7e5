#include "render/copy_queue.h"

#include "render/check.h"
#include "render/commands.h"

namespace probewalk {

CopyQueue::CopyQueue(const Device& device) : device_(device), timeline_(make_timeline(device)) {
  for (Slot& slot : slots_) {
    slot.pool = make_command_pool(device, device.copy_queue_family());
    allocate_commands(device, slot.pool, {&slot.commands, 1});
  }
}

CopyQueue::~CopyQueue() {
  // Unchecked: a lost device must not throw here.
  wait_for_timeline(device_, timeline_, submitted_);
  for (const Slot& slot : slots_) vkDestroyCommandPool(device_.handle(), slot.pool, nullptr);
  vkDestroySemaphore(device_.handle(), timeline_, nullptr);
}

bool CopyQueue::is_full() const {
  return submitted_ - completed() >= kSlots;
}

std::uint64_t CopyQueue::submit(const std::function<void(VkCommandBuffer)>& record) {
  const Slot& slot = slots_[submitted_ % kSlots];
  check(vkResetCommandPool(device_.handle(), slot.pool, 0), "vkResetCommandPool");
  begin_commands(slot.commands);
  record(slot.commands);
  check(vkEndCommandBuffer(slot.commands), "vkEndCommandBuffer");
  VkCommandBufferSubmitInfo commands{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
  commands.commandBuffer = slot.commands;
  const VkSemaphoreSubmitInfo signal = semaphore_info(timeline_, submitted_ + 1, VK_PIPELINE_STAGE_2_COPY_BIT);
  VkSubmitInfo2 info{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
  info.commandBufferInfoCount = 1;
  info.pCommandBufferInfos = &commands;
  info.signalSemaphoreInfoCount = 1;
  info.pSignalSemaphoreInfos = &signal;
  device_.submit_copies(info);
  return ++submitted_;
}

std::uint64_t CopyQueue::completed() const {
  std::uint64_t done = 0;
  check(vkGetSemaphoreCounterValue(device_.handle(), timeline_, &done), "vkGetSemaphoreCounterValue");
  return done;
}

void CopyQueue::wait() const {
  check(wait_for_timeline(device_, timeline_, submitted_), "vkWaitSemaphores");
}

VkSemaphoreSubmitInfo CopyQueue::wait_info(std::uint64_t number) const {
  return semaphore_info(timeline_, number, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT);
}

}  // namespace probewalk
