// The second of two eyes, from what the first has seen where that answers its rays (shaders/first_eye.glsl).
#pragma once

#include <volk.h>

#include <cstdint>

#include "content/baseline/method.h"
#include "render/buffer.h"
#include "render/device.h"
#include "render/image.h"
#include "render/pipeline.h"

namespace probewalk {

struct SecondEyeOptions {
  VkExtent2D extent_px{};        // of a view, at most
  std::uint32_t pairs = 1;       // of views: 0 and 1, 2 and 3
  bool aov = false;              // also write class, probe and counts
  std::uint32_t interleave = 1;  // see kInterleave in trace_stereo.glsl
  bool masked = false;           // as in TracerOptions
  bool shared_openings = false;  // as in TracerOptions
  TracerChoice choice;           // no baseline
};

// How the second eye's rays are answered, in options and reports.
inline constexpr const char* kSecondEyeFromFirst = "from-first";
inline constexpr const char* kSecondEyeTraced = "traced";

// Keeps 28 bytes a pixel of the first eyes on the device.
class SecondEye {
 public:
  // `images` as in trace_stereo.glsl: radiance, distance, aov. They must outlive this.
  SecondEye(const Device& device, const StorageImageSet& images, const SecondEyeOptions& options);

  // Whether views so drawn are pairs of eyes of which the second can go by the first: not of a baseline, not where the
  // first eye has rays for only some of its pixels, and not wider than can be looked through.
  static bool suits(VkExtent2D extent_px, std::uint32_t views, bool foveated, const TracerChoice& choice);

  // What the first eyes' rays are traced with, beside the frame: where they leave what they see, and how many groups there
  // are behind a picture's columns of tiles that look beyond its edge.
  void lend(PushConstants& push) const;
  static std::uint32_t columns_beyond(VkExtent2D extent_px);

  // After the first eyes' rays, whose writes this waits for. `frame` and `extent_px` as for StereoTracer::record;
  // `openings`: of the views, 0 without shared_openings. The caller's barrier makes the pictures visible.
  void record(VkCommandBuffer commands, VkDeviceAddress frame, VkDeviceAddress openings, VkExtent2D extent_px) const;

 private:
  const StorageImageSet& images_;
  SecondEyeOptions options_;
  Buffer surfaces_, depths_, list_;  // shaders/shared/seen_surface.h
  Pipeline find_near_depths_, ask_, trace_rest_;
};

}  // namespace probewalk
