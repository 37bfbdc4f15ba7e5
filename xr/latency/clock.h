// The one clock: CLOCK_MONOTONIC, nanoseconds. Device clocks are brought onto it by calibration pairs.
#pragma once

#include <cstdint>
#include <optional>

namespace probewalk {

// CLOCK_MONOTONIC now.
std::int64_t now_ns();

// One reading of both clocks at the same moment, as VK_EXT_calibrated_timestamps gives it.
struct ClockPair {
  std::uint64_t device_ticks = 0;
  std::int64_t monotonic_ns = 0;
  std::int64_t deviation_ns = 0;  // the two readings lie at most this far apart
};

// Maps device time stamps to CLOCK_MONOTONIC. Calibrated anew every 64 frames or so: between two pairs it goes along
// the nominal period from the newest one, and the drift that the pairs themselves show counts into the error.
class DeviceClock {
 public:
  // ns_per_tick: VkPhysicalDeviceLimits::timestampPeriod. valid_bits: VkQueueFamilyProperties::timestampValidBits,
  // 1..64; stamps wrap at that many bits.
  DeviceClock(double ns_per_tick, std::uint32_t valid_bits);

  void calibrate(const ClockPair& pair);
  bool calibrated() const { return pair_.has_value(); }
  // None before the first calibration. Stamps up to half a wrap before or after the newest pair are understood.
  std::optional<std::int64_t> to_monotonic_ns(std::uint64_t device_ticks) const;
  // Bound on the error of to_monotonic_ns: the deviation of the newest pair and the drift seen since the one before.
  std::int64_t error_ns() const;
  // Durations need no calibration.
  std::int64_t duration_ns(std::uint64_t begin_ticks, std::uint64_t end_ticks) const;

 private:
  double ns_per_tick_;
  std::uint64_t mask_;
  std::optional<ClockPair> pair_;
  std::int64_t drift_ns_ = 0;
};

}  // namespace probewalk
