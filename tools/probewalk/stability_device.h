// The device as a contender of the hard cases.
#pragma once

#include <span>
#include <vector>

#include "content/stability/places.h"
#include "content/stability/walk.h"
#include "render/device.h"
#include "render/walk_batch.h"

namespace probewalk {

class StabilityDevice {
 public:
  explicit StabilityDevice(const Device& device) : batch_(device) {}
  std::vector<stability::Answer> walk(const stability::Place& place, std::span<const stability::Ray> rays);

 private:
  WalkBatch batch_;
  std::string place_;  // whose probe is on the device
  std::vector<WalkRay> rays_;
};

}  // namespace probewalk
