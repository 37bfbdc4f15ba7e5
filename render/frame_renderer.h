// Draws frames: trace, then resolve (and depth, where the display takes it). Two frames may be in flight. A frame is
//   record(target) -> write(constants, the later the better) -> submit()
// on one thread; the poses are read by the device only when the commands run.
#pragma once

#include <volk.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "render/depth_range.h"
#include "render/device.h"
#include "render/frame_target.h"
#include "render/gpu_clock.h"
#include "render/guide_pass.h"
#include "render/hidden_tiles.h"
#include "render/probe_store.h"
#include "render/side_view.h"
#include "render/stereo_tracer.h"

namespace probewalk {

inline constexpr std::uint32_t kFrameSlots = 2;
// From one teleport to the next it pays to keep what draws the aim.
inline constexpr std::uint64_t kGuideRest_frames = 500;

struct FrameRendererOptions {
  TracerOptions tracer;
  VkFormat target_format = VK_FORMAT_R8G8B8A8_SRGB;
  VkFormat depth_format = VK_FORMAT_UNDEFINED;  // no depth is drawn, and nothing is kept for it
};

// What a frame is drawn with, beside what the store holds.
struct FrameSettings {
  TraceConstants trace{};  // radiance_scale as the pack says; what the tracer's choice says of the dials goes over it
  float exposure = 1.0f;   // cd/m^2 * exposure = 1 is display white before the tone curve (exposure_from_ev)
  float fade = 0.0f;       // 0 = picture, 1 = black
  DepthRange depth;        // of the depth image, if there is one
};

// Device times of a finished frame.
struct FrameGpuTimes {
  std::uint64_t frame = 0;     // number that submit() returned
  GpuInterval trace, resolve;  // depth counts as resolve
  GpuInterval whole;           // from the first pass's begin to the last one's end
  bool calibrated = false;     // on CLOCK_MONOTONIC; else only differences mean something
  std::int64_t max_deviation_ns = 0;
};

class FrameRenderer {
 public:
  // `store` must have been made for kFrameSlots slots, and is driven by this from now on.
  FrameRenderer(const Device& device, ProbeStore& store, const FrameRendererOptions& options);
  // Waits for the frames in flight.
  ~FrameRenderer();
  FrameRenderer(const FrameRenderer&) = delete;
  FrameRenderer& operator=(const FrameRenderer&) = delete;

  // Whether frames recorded from now on are timed on the device; they are unless told otherwise.
  void set_timed(bool timed);
  // Waits until the frame before the last has finished, takes in what has streamed, records the passes. The target has
  // the options' formats, as many layers as there are views, and an extent within theirs; its images outlive the
  // renderer. Guides are drawn over the picture. What they need is made on a thread of its own when a frame first has
  // some, which goes without until then, and is given up when none has had any for kGuideRest_frames.
  void record(const FrameTarget& target, const Guides& guides = {});
  // Writes the views' poses and the settings; callable again until submit. As many views as in the options.
  void write(std::span<const ViewConstants> views, const FrameSettings& settings);
  // Shows the look-ups of each pixel instead of the picture, or the picture again. What that needs is made on a thread
  // of its own, and the picture stays until it is there; nothing of it is kept while the picture is shown.
  void show_lookups(bool shown);
  // What the headset's optics hide of each view, from the next write on; only where options.tracer.masked. Tiles are
  // found anew when the meshes, the fields of view or the extent change, which takes a millisecond or so.
  void hide(std::vector<HiddenMesh> meshes);
  // Returns the frame's number, from 1.
  std::uint64_t submit();

  // One view more from what the frame submitted last was drawn from, with the same settings, and guides of its own;
  // after the frame, so that it holds up none of its passes. False, and nothing is done, while the device is still at
  // the last one of `side`, which must always be given to the same renderer and outlive its work (wait()).
  bool submit_beside(SideView& side, const ViewConstants& view, const FrameSettings& settings,
                     const Guides& guides = {});

  // How long the last record waited for the device.
  std::int64_t blocked_ns() const;
  // What the last record() spent on probes that arrive, move and go: copies, builds, the table, and the store's lock.
  std::int64_t streaming_ns() const;
  // Bytes that the recorded frame copies to the device.
  std::uint64_t bytes_copied() const;
  // Times of the oldest finished frame that was timed and has not been taken yet, if any. Does not block. Times not
  // taken before their slot is used again (two frames later) are kept, up to 64 of them.
  std::optional<FrameGpuTimes> take_times();
  // Waits until all frames submitted have finished.
  void wait();

  // Radiance, distance and counts of the last frame; read them after wait().
  const StereoTracer& tracer() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace probewalk
