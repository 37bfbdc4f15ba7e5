// The pyramids of probes that have arrived without them, built in place by the device from their samples and cuts
// (shaders/build_pyramid_*.comp): so much a frame.
#pragma once

#include <volk.h>

#include <cstdint>
#include <vector>

#include "render/device.h"
#include "render/pipeline.h"

namespace probewalk {

// How far the pyramids of some probes have come.
class PyramidJob {
 public:
  // A geometry block on the device whose pyramid is to be built.
  struct Site {
    VkDeviceAddress geometry = 0;
    std::uint32_t n_log2 = 0;
    bool has_tiled_samples = false;
  };

  PyramidJob() = default;
  explicit PyramidJob(std::vector<Site> sites);
  bool is_done() const { return level_ > top_; }

 private:
  friend class PyramidBuilder;

  std::vector<Site> sites_;
  int top_ = -1;
  // Where it goes on: all sites have the levels below.
  int level_ = 1;
  std::size_t site_ = 0;
  std::uint32_t word_ = 0;
};

class PyramidBuilder {
 public:
  explicit PyramidBuilder(const Device& device);

  // Records passes that read at most `budget_bytes` of samples, or as few as can be; returns how many. The words that
  // the job's sites read must be visible to compute shaders; what is written is not made so.
  std::uint64_t record(VkCommandBuffer commands, PyramidJob& job, std::uint64_t budget_bytes) const;

 private:
  Pipeline cells_, nodes_;
};

// What compute shaders have written so far is seen by those after.
void make_visible_between_shaders(VkCommandBuffer commands);

}  // namespace probewalk
