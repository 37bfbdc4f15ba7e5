#include "render/copy_queue.h"

#include "render/check.h"

namespace probewalk {

CopyQueue::CopyQueue(const Device& device) : device_(device) {
  VkSemaphoreTypeCreateInfo type{VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO};
  type.semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE;
  const VkSemaphoreCreateInfo semaphore_info{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, &type, 0};
  check(vkCreateSemaphore(device.handle(), &semaphore_info, nullptr, &timeline_), "vkCreateSemaphore");
  for (Slot& slot : slots_) {
    VkCommandPoolCreateInfo pool_info{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    pool_info.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
    pool_info.queueFamilyIndex = device.copy_queue_family();
    check(vkCreateCommandPool(device.handle(), &pool_info, nullptr, &slot.pool), "vkCreateCommandPool");
    VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    allocate.commandPool = slot.pool;
    allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    allocate.commandBufferCount = 1;
    check(vkAllocateCommandBuffers(device.handle(), &allocate, &slot.commands), "vkAllocateCommandBuffers");
  }
}

CopyQueue::~CopyQueue() {
  // Not wait(): a lost device must not throw here.
  VkSemaphoreWaitInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO};
  info.semaphoreCount = 1;
  info.pSemaphores = &timeline_;
  info.pValues = &submitted_;
  vkWaitSemaphores(device_.handle(), &info, UINT64_MAX);
  for (const Slot& slot : slots_) vkDestroyCommandPool(device_.handle(), slot.pool, nullptr);
  vkDestroySemaphore(device_.handle(), timeline_, nullptr);
}

bool CopyQueue::is_full() const {
  return submitted_ - completed() >= kSlots;
}

std::uint64_t CopyQueue::submit(const std::function<void(VkCommandBuffer)>& record) {
  const Slot& slot = slots_[submitted_ % kSlots];
  check(vkResetCommandPool(device_.handle(), slot.pool, 0), "vkResetCommandPool");
  VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  check(vkBeginCommandBuffer(slot.commands, &begin), "vkBeginCommandBuffer");
  record(slot.commands);
  check(vkEndCommandBuffer(slot.commands), "vkEndCommandBuffer");
  VkCommandBufferSubmitInfo commands{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
  commands.commandBuffer = slot.commands;
  VkSemaphoreSubmitInfo signal = wait_info(submitted_ + 1);
  signal.stageMask = VK_PIPELINE_STAGE_2_COPY_BIT;
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
  VkSemaphoreWaitInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO};
  info.semaphoreCount = 1;
  info.pSemaphores = &timeline_;
  info.pValues = &submitted_;
  check(vkWaitSemaphores(device_.handle(), &info, UINT64_MAX), "vkWaitSemaphores");
}

VkSemaphoreSubmitInfo CopyQueue::wait_info(std::uint64_t number) const {
  VkSemaphoreSubmitInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO};
  info.semaphore = timeline_;
  info.value = number;
  info.stageMask = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
  return info;
}

}  // namespace probewalk
