#include "xr/latency/clock.h"

#include <cmath>
#include <ctime>

namespace probewalk {

std::int64_t now_ns() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return static_cast<std::int64_t>(time.tv_sec) * 1'000'000'000 + time.tv_nsec;
}

namespace {

// later - earlier of two stamps that wrap at `mask`, the shorter way round.
std::int64_t signed_ticks(std::uint64_t later, std::uint64_t earlier, std::uint64_t mask) {
  const std::uint64_t forward = (later - earlier) & mask;
  const std::uint64_t backward = (earlier - later) & mask;
  return forward <= backward ? static_cast<std::int64_t>(forward) : -static_cast<std::int64_t>(backward);
}

}  // namespace

DeviceClock::DeviceClock(double ns_per_tick, std::uint32_t valid_bits)
    : ns_per_tick_(ns_per_tick), mask_(valid_bits >= 64 ? ~0ull : (1ull << valid_bits) - 1) {}

void DeviceClock::calibrate(const ClockPair& pair) {
  if (pair_) {
    // What the old pair would have said about this moment, against what the new one says.
    const auto expected = to_monotonic_ns(pair.device_ticks);
    drift_ns_ = std::abs(*expected - pair.monotonic_ns);
  }
  pair_ = pair;
}

std::optional<std::int64_t> DeviceClock::to_monotonic_ns(std::uint64_t device_ticks) const {
  if (!pair_) return std::nullopt;
  const std::int64_t ticks = signed_ticks(device_ticks, pair_->device_ticks, mask_);
  return pair_->monotonic_ns + std::llround(static_cast<double>(ticks) * ns_per_tick_);
}

std::int64_t DeviceClock::error_ns() const { return pair_ ? pair_->deviation_ns + drift_ns_ : 0; }

std::int64_t DeviceClock::duration_ns(std::uint64_t begin_ticks, std::uint64_t end_ticks) const {
  return std::llround(static_cast<double>(signed_ticks(end_ticks, begin_ticks, mask_)) * ns_per_tick_);
}

}  // namespace probewalk
