// A pack's probes at one of its levels, in this process's memory and on the device.
#pragma once

#include <cstddef>
#include <vector>

#include "content/pack/pack_io.h"
#include "content/probe/probe_set.h"
#include "render/device.h"
#include "render/probe_store.h"

namespace probewalk::bench {

// Geometry sizes of the levels, coarse to fine: of each, the largest of any room.
std::vector<int> level_sizes(const Manifest& manifest);

class PackLevel {
 public:
  // A room that has fewer levels shows its finest. Throws BadInput.
  PackLevel(const Device& device, const Pack& pack, std::size_t level, DeviceSamples samples = kDefaultSamples);

  DeviceSamples samples() const { return samples_; }
  const ProbeSet& probes() const { return probes_; }
  const ProbeStore& store() const { return store_; }

 private:
  DeviceSamples samples_;
  ProbeSet probes_;
  ProbeStore store_;
};

}  // namespace probewalk::bench
