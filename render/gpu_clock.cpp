#include "render/gpu_clock.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "render/check.h"
#include "render/one_shot.h"

namespace probewalk {
namespace {

constexpr std::uint32_t kFramesPerCalibration = 64;

bool offers_monotonic_clock(const Device& device) {
  if (!device.has_calibrated_timestamps()) return false;
  std::uint32_t count = 0;
  check(vkGetPhysicalDeviceCalibrateableTimeDomainsEXT(device.physical(), &count, nullptr),
        "vkGetPhysicalDeviceCalibrateableTimeDomainsEXT");
  std::vector<VkTimeDomainEXT> domains(count);
  check(vkGetPhysicalDeviceCalibrateableTimeDomainsEXT(device.physical(), &count, domains.data()),
        "vkGetPhysicalDeviceCalibrateableTimeDomainsEXT");
  const auto has = [&](VkTimeDomainEXT domain) {
    return std::find(domains.begin(), domains.end(), domain) != domains.end();
  };
  return has(VK_TIME_DOMAIN_DEVICE_EXT) && has(VK_TIME_DOMAIN_CLOCK_MONOTONIC_EXT);
}

std::uint64_t valid_bits_mask(const Device& device) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device.physical(), &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device.physical(), &count, families.data());
  const std::uint32_t bits = families[device.queue_family()].timestampValidBits;
  return bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
}

}  // namespace

GpuClock::GpuClock(const Device& device)
    : device_(device), calibrated_(offers_monotonic_clock(device)), valid_bits_mask_(valid_bits_mask(device)) {
  if (calibrated_) calibrate();
  ticks_until_calibration_ = kFramesPerCalibration;
}

void GpuClock::tick() {
  if (!calibrated_ || --ticks_until_calibration_ > 0) return;
  calibrate();
  ticks_until_calibration_ = kFramesPerCalibration;
}

void GpuClock::calibrate() {
  std::array<VkCalibratedTimestampInfoEXT, 2> infos{};
  infos[0] = {VK_STRUCTURE_TYPE_CALIBRATED_TIMESTAMP_INFO_EXT, nullptr, VK_TIME_DOMAIN_DEVICE_EXT};
  infos[1] = {VK_STRUCTURE_TYPE_CALIBRATED_TIMESTAMP_INFO_EXT, nullptr, VK_TIME_DOMAIN_CLOCK_MONOTONIC_EXT};
  std::array<std::uint64_t, 2> stamps{};
  std::uint64_t deviation_ns = 0;
  check(vkGetCalibratedTimestampsEXT(device_.handle(), 2, infos.data(), stamps.data(), &deviation_ns),
        "vkGetCalibratedTimestampsEXT");
  base_ticks_ = stamps[0] & valid_bits_mask_;
  base_ns_ = static_cast<std::int64_t>(stamps[1]);
  max_deviation_ns_ = std::max(max_deviation_ns_, static_cast<std::int64_t>(deviation_ns));
}

std::int64_t GpuClock::to_ns(std::uint64_t device_ticks) const {
  // Relative to the last calibration, across a wrap of the counter in either direction.
  const std::uint64_t forward = (device_ticks - base_ticks_) & valid_bits_mask_;
  const bool is_before = forward > valid_bits_mask_ / 2;
  const std::uint64_t distance = is_before ? (base_ticks_ - device_ticks) & valid_bits_mask_ : forward;
  const double period_ns = static_cast<double>(device_.timestamp_period_ns());
  const std::int64_t distance_ns = std::llround(static_cast<double>(distance) * period_ns);
  return base_ns_ + (is_before ? -distance_ns : distance_ns);
}

PassTimer::PassTimer(const Device& device, std::uint32_t passes)
    : device_(&device),
      passes_(passes),
      ticks_(device, VkDeviceSize{2} * passes * sizeof(std::uint64_t), BufferMemory::kReadback) {
  VkQueryPoolCreateInfo info{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
  info.queryType = VK_QUERY_TYPE_TIMESTAMP;
  info.queryCount = 2 * passes;
  check(vkCreateQueryPool(device.handle(), &info, nullptr, &pool_), "vkCreateQueryPool");
}

PassTimer::~PassTimer() {
  if (pool_ != VK_NULL_HANDLE) vkDestroyQueryPool(device_->handle(), pool_, nullptr);
}

PassTimer::PassTimer(PassTimer&& other) noexcept
    : device_(other.device_),
      pool_(std::exchange(other.pool_, VK_NULL_HANDLE)),
      passes_(other.passes_),
      ticks_(std::move(other.ticks_)) {}

void PassTimer::reset() {
  vkResetQueryPool(device_->handle(), pool_, 0, 2 * passes_);
}

void PassTimer::begin(VkCommandBuffer commands, std::uint32_t pass) const {
  vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool_, 2 * pass);
}

void PassTimer::end(VkCommandBuffer commands, std::uint32_t pass) const {
  vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool_, 2 * pass + 1);
}

void PassTimer::bring(VkCommandBuffer commands) const {
  vkCmdCopyQueryPoolResults(commands, pool_, 0, 2 * passes_, ticks_.handle(), 0, sizeof(std::uint64_t),
                            VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT);
  make_visible_to_cpu(commands);
}

GpuInterval PassTimer::read(std::uint32_t pass, const GpuClock& clock) const {
  ticks_.invalidate();
  const auto ticks = ticks_.mapped_as<const std::uint64_t>().subspan(std::size_t{2} * pass, 2);
  return {clock.to_ns(ticks[0]), clock.to_ns(ticks[1])};
}

}  // namespace probewalk
