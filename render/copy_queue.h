// Copies to the device beside the frames: on a queue of their own where the device has one, so that they run while
// frames are drawn. They finish in order; a timeline semaphore counts them.
#pragma once

#include <volk.h>

#include <array>
#include <cstdint>
#include <functional>

#include "render/device.h"

namespace probewalk {

class CopyQueue {
 public:
  explicit CopyQueue(const Device& device);
  // Waits for what runs.
  ~CopyQueue();
  CopyQueue(const CopyQueue&) = delete;
  CopyQueue& operator=(const CopyQueue&) = delete;

  // As many submits as may be under way are: another must wait.
  bool is_full() const;
  // Records copies and submits them; not when is_full(). Returns the submit's number, from 1.
  std::uint64_t submit(const std::function<void(VkCommandBuffer)>& record);
  std::uint64_t submitted() const { return submitted_; }
  // The last submit that has finished.
  std::uint64_t completed() const;
  // Blocks until all have finished.
  void wait() const;
  // What commands that read what submit `number` wrote must wait for, on whichever queue.
  VkSemaphoreSubmitInfo wait_info(std::uint64_t number) const;

 private:
  static constexpr std::size_t kSlots = 2;
  struct Slot {
    VkCommandPool pool = VK_NULL_HANDLE;
    VkCommandBuffer commands = VK_NULL_HANDLE;
  };

  const Device& device_;
  VkSemaphore timeline_ = VK_NULL_HANDLE;
  std::array<Slot, kSlots> slots_;
  std::uint64_t submitted_ = 0;
};

}  // namespace probewalk
