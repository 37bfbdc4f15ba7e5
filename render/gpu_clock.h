// Device time stamps on the CPU's clock.
#pragma once

#include <volk.h>

#include <cstdint>

#include "render/buffer.h"
#include "render/device.h"

namespace probewalk {

struct GpuInterval {
  std::int64_t begin_ns = 0;
  std::int64_t end_ns = 0;
};

// Converts device ticks to CLOCK_MONOTONIC nanoseconds by VK_EXT_calibrated_timestamps (VK_KHR_ likewise). Without it
// times start at an arbitrary zero: only their differences mean something, and calibrated() says so.
class GpuClock {
 public:
  explicit GpuClock(const Device& device);

  bool calibrated() const { return calibrated_; }
  // Largest deviation that any calibration so far has reported, ns.
  std::int64_t max_deviation_ns() const { return max_deviation_ns_; }
  // To be called once a frame: calibrates anew every 64 calls, since the two clocks drift apart.
  void tick();
  std::int64_t to_ns(std::uint64_t device_ticks) const;

 private:
  void calibrate();

  const Device& device_;
  bool calibrated_ = false;
  std::uint32_t ticks_until_calibration_ = 0;
  std::uint64_t base_ticks_ = 0;
  std::int64_t base_ns_ = 0;
  std::int64_t max_deviation_ns_ = 0;
  std::uint64_t valid_bits_mask_ = ~std::uint64_t{0};
};

// Time stamps around the passes of one frame. Each pass must have a command buffer of its own: rasterisers that defer
// work charge a draw to whatever follows it in the same buffer (seen on llvmpipe). The device itself brings the stamps
// to where the CPU reads them: vkGetQueryPoolResults makes some drivers (lavapipe) wait for all that is in flight.
class PassTimer {
 public:
  PassTimer(const Device& device, std::uint32_t passes);
  ~PassTimer();
  PassTimer(PassTimer&& other) noexcept;
  PassTimer& operator=(PassTimer&&) = delete;

  // Once a frame, on the CPU, while the GPU does not use the timer.
  void reset();
  void begin(VkCommandBuffer commands, std::uint32_t pass) const;
  void end(VkCommandBuffer commands, std::uint32_t pass) const;
  // Once a frame, after all passes; in a command buffer after theirs, where a pass draws. All that was written before
  // can be read through mapped memory, too, once the commands have finished.
  void bring(VkCommandBuffer commands) const;
  // Once bring()'s commands have finished, and no sooner.
  GpuInterval read(std::uint32_t pass, const GpuClock& clock) const;

 private:
  const Device* device_;
  VkQueryPool pool_ = VK_NULL_HANDLE;
  std::uint32_t passes_;
  Buffer ticks_;  // two a pass
};

}  // namespace probewalk
