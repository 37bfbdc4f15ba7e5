// Traces every pixel of N views against the resident probes, in one dispatch (z = view).
#pragma once

#include <volk.h>

#include <cstdint>
#include <memory>
#include <optional>

#include "render/buffer.h"
#include "render/device.h"
#include "render/edge_sampler.h"
#include "render/foveation.h"
#include "render/image.h"
#include "render/pipeline.h"
#include "render/second_eye.h"
#include "render/tracer_choice.h"

namespace probewalk {

struct TracerOptions {
  VkExtent2D extent_px{};              // of each view, at most
  std::uint32_t views = 2;             // 1 .. kMaxViews
  bool aov = false;                    // also write class, probe and counts
  std::uint32_t samples = 1;           // rays of a pixel at an edge: 1, 2 or 4
  std::optional<Foveation> foveation;  // rays for several pixels towards the rim
  bool masked = false;                 // hidden tiles have no rays: the FrameConstants name them (hidden_tiles.h)
  TracerSetup setup;                   // how rays are answered
  // Rays of a view read what their first probe is chosen from instead of finding it each for itself: the same answers to
  // the bit. Off because it was not measurably faster; `probewalk bench` measures it.
  bool shared_openings = false;
  // Of each pair of views the second goes by what the first has seen where that answers its rays. Changes nothing where
  // the views do not suit it (second_eye.h). Off here, so that views are traced each by itself unless somebody asks.
  bool second_from_first = false;
};

// Distance of a miss, metres.
inline constexpr float kMissDistance_m = 1e30f;

class StereoTracer {
 public:
  StereoTracer(const Device& device, const TracerOptions& options);

  // `frame` is the device address of a FrameConstants whose size is `extent_px` (within the options') and whose view
  // count is the options'; its contents are read when the commands run. Of the images only that much is written, from
  // the upper left corner. Leaves them in VK_IMAGE_LAYOUT_GENERAL, visible to fragment shaders and copies.
  void record(VkCommandBuffer commands, VkDeviceAddress frame, VkExtent2D extent_px) const;

  const TracerOptions& options() const { return options_; }
  // One layer a view.
  // RGBA16F, linear, times radiance_scale; alpha 1. Of a pixel with several rays the radiance that is shown as they are
  // on average.
  const Image& radiance() const { return radiance_; }
  // R32F, metres along the ray through the pixel's centre; kMissDistance_m = miss.
  const Image& distance() const { return distance_; }
  // RGBA32UI: class, probe (0xffffffff = none) of the ray through the pixel's centre; look-ups, tries | rays << 8 |
  // attribute reads << 16 of all its rays, 0 where foveation gave a pixel none. One texel without options().aov.
  const Image& aov() const { return aov_; }

 private:
  TracerOptions options_;
  std::uint32_t interleave_;  // see kInterleave in trace_stereo.glsl
  Image radiance_, distance_, aov_;
  StorageImageSet images_;
  Buffer openings_;  // with shared_openings
  std::optional<Pipeline> find_openings_;
  Pipeline pipeline_;                        // of all views, or of the first of each pair
  std::unique_ptr<SecondEye> second_eyes_;  // with second_from_first
  std::optional<Pipeline> fill_;        // with foveation
  std::unique_ptr<EdgeSampler> edges_;  // with more than one sample
};

}  // namespace probewalk
