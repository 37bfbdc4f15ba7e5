// Extra rays where a traced picture has edges: lists the pixels, traces the list, blends. Others stay as they are.
#pragma once

#include <volk.h>

#include <cstdint>

#include "content/baseline/method.h"
#include "render/buffer.h"
#include "render/device.h"
#include "render/pipeline.h"

namespace probewalk {

struct EdgeSamplerOptions {
  VkExtent2D extent_px{};  // of each view
  std::uint32_t views = 2;
  bool aov = false;
  std::uint32_t samples = 4;     // rays of a pixel at an edge, the first one's included: 2 or 4
  std::uint32_t interleave = 1;  // see kInterleave in trace_stereo.glsl
  bool masked = false;           // hidden tiles get none
  bool foveated = false;         // tiles with a ray for several pixels get no more (shaders/shared/foveation.h)
  bool shared_openings = false;  // as in TracerOptions
  TracerChoice choice;           // how rays are answered; its maps are named by the FrameConstants
};

class EdgeSampler {
 public:
  // `images`: radiance, distance and counts, as trace_stereo.comp binds them; outlive this.
  EdgeSampler(const Device& device, const StorageImageSet& images, const EdgeSamplerOptions& options);

  // After the dispatch that has written the images, without a barrier between. Its own writes are left to the caller's
  // next barrier. `frame` is the device address of the FrameConstants, whose size `extent_px` is: within the options'.
  // `openings`: of the views (StereoTracer); 0 without shared_openings.
  void record(VkCommandBuffer commands, VkDeviceAddress frame, VkDeviceAddress openings, VkExtent2D extent_px) const;

 private:
  const StorageImageSet& images_;
  EdgeSamplerOptions options_;
  Buffer list_;  // PixelListHead, then a word for every pixel that may be an edge's
  Pipeline find_, sample_;
};

}  // namespace probewalk
