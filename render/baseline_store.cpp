#include "render/baseline_store.h"

#include <cstring>
#include <span>

#include "render/one_shot.h"

namespace probewalk {
namespace {

// Words that the device reads, from memory that it may not share with the CPU. Nothing needs no memory.
Buffer upload(const Device& device, std::span<const std::byte> bytes) {
  if (bytes.empty()) return {};
  Buffer result(device, bytes.size(), BufferMemory::kDevice);
  if (result.mapped() != nullptr) {
    std::memcpy(result.mapped(), bytes.data(), bytes.size());
    result.flush();
    return result;
  }
  const Buffer staging(device, bytes.size(), BufferMemory::kStaging);
  std::memcpy(staging.mapped(), bytes.data(), bytes.size());
  staging.flush();
  run_commands(device, [&](VkCommandBuffer commands) {
    const VkBufferCopy region{0, 0, bytes.size()};
    vkCmdCopyBuffer(commands, staging.handle(), result.handle(), 1, &region);
  });
  return result;
}

template <typename T>
void append(std::vector<std::byte>& bytes, const std::vector<T>& values) {
  const auto more = std::as_bytes(std::span(values));
  bytes.insert(bytes.end(), more.begin(), more.end());
}

}  // namespace

BaselineNeeds baseline_needs(const TracerChoice& choice) {
  BaselineNeeds needs;
  needs.distance = choice.needs_maps();
  needs.minimum = choice.method == kMethodMarch2dHierarchical || choice.method == kMethodTwoLevel;
  const bool marches = choice.method == kMethodMarch3d || choice.method == kMethodMarch2d || needs.minimum;
  needs.normal = marches && (choice.reject_backfaces || choice.epsilon_rule == kEpsilonDynamic);
  return needs;
}

BaselineStore::BaselineStore(const Device& device, const BaselineMaps& maps, const TracerChoice& choice) {
  const BaselineNeeds needs = baseline_needs(choice);
  std::vector<BaselineRecord> records;
  for (const BaselineMap& map : maps.probes) {
    BaselineRecord record = map.record;
    std::vector<std::byte> bytes;
    if (needs.distance) append(bytes, map.distance_m);
    const std::size_t minimum = bytes.size();
    if (needs.minimum) append(bytes, map.minimum_m);
    const std::size_t normal = bytes.size();
    if (needs.normal) append(bytes, map.normal);
    maps_.push_back(upload(device, bytes));
    const VkDeviceAddress address = maps_.back().address();
    if (needs.distance) record.distance_address = address_words(address);
    if (needs.minimum) record.minimum_address = address_words(address + minimum);
    if (needs.normal) record.normal_address = address_words(address + normal);
    records.push_back(record);
  }
  records_ = upload(device, std::as_bytes(std::span(records)));
  BaselineConstants constants = baseline_constants_for(choice, maps);
  constants.records_address = address_words(records_.address());
  constants_ = upload(device, std::as_bytes(std::span(&constants, 1)));
}

std::uint64_t BaselineStore::device_bytes() const {
  std::uint64_t bytes = constants_.size_bytes() + records_.size_bytes();
  for (const Buffer& map : maps_) bytes += map.size_bytes();
  return bytes;
}

}  // namespace probewalk
