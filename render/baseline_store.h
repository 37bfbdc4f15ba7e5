// The maps of the baselines on the device: made only when a method is asked for that reads them, and of them only what the
// method reads.
#pragma once

#include <volk.h>

#include <cstdint>
#include <vector>

#include "content/baseline/baseline_maps.h"
#include "render/buffer.h"
#include "render/device.h"

namespace probewalk {

// Which of a probe's maps a choice reads.
struct BaselineNeeds {
  bool distance = false, minimum = false, normal = false;
};
BaselineNeeds baseline_needs(const TracerChoice& choice);

class BaselineStore {
 public:
  // Copies to the device and waits. Throws VulkanError when there is no room.
  BaselineStore(const Device& device, const BaselineMaps& maps, const TracerChoice& choice);

  // Of the BaselineConstants that the choice traces with.
  VkDeviceAddress constants_address() const { return constants_.address(); }
  std::uint64_t device_bytes() const;

 private:
  Buffer constants_, records_;
  std::vector<Buffer> maps_;  // one a probe
};

}  // namespace probewalk
