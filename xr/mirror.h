// What the wearer sees, on the desktop. The headset never waits for it: the frame thread hands a copy of the eyes over
// when one is due and the last has been shown, and goes on; a thread of the mirror's own brings it to the window.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "render/device.h"
#include "render/frame_target.h"
#include "render/image.h"
#include "xr/latency/frame_record.h"
#include "xr/mirror_pacer.h"
#include "xr/window.h"
#include "xr/window_layout.h"
#include "xr/window_swapchain.h"

namespace probewalk {

class Mirror {
 public:
  // `window` and `device` (made with the window's hooks) outlive the mirror. `eye` and `views` are those of the
  // headset. `overlay`, if any, outlives it, too.
  Mirror(Window& window, const Device& device, VkExtent2D eye, std::uint32_t views, VkFormat format, ShownEyes shown,
         const OverlayBoard* overlay);
  ~Mirror();
  Mirror(const Mirror&) = delete;
  Mirror& operator=(const Mirror&) = delete;

  // Window events; once a frame, on the thread that made the window.
  WindowInput poll() { return window_.poll(); }
  // After the frame's submit and before its image goes back to the runtime. Fills in what the record says about the
  // mirror: nothing when no picture was due. None is shown when the headset was late (mirror_pacer.h) or the mirror still
  // busy with the last one; take_shown() tells of those that were handed over.
  void offer(const FrameTarget& target, FrameRecord& record);
  // The same for a picture of the mirror's own, which `draw` submits only when one is due; it is left alone until the
  // next call of `draw`. Nothing: not now.
  void offer_drawn(FrameRecord& record, const std::function<std::optional<FrameTarget>()>& draw);
  // Waits until the last picture handed over is no longer read.
  void settle();
  // What became of pictures since the last call.
  std::vector<MirrorShown> take_shown();
  ShownEyes shown() const { return shown_; }

 private:
  struct Picture {
    FrameTarget eyes;
    VkExtent2D window{};
    std::uint64_t frame_id = 0;
  };
  void copy(const FrameTarget& target);
  void show_pictures();

  Window& window_;
  const Device& device_;
  const VkExtent2D eye_;
  const ShownEyes shown_;
  MirrorPacer pacer_;
  Image copy_;  // of the eyes; none where they are not shown
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  VkFence copied_ = VK_NULL_HANDLE;
  WindowSwapchain swapchain_;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Picture> next_;  // handed over, not shown yet
  std::vector<MirrorShown> shown_pictures_;
  std::atomic<bool> busy_ = false;
  std::atomic<bool> is_lost_ = false;  // window or surface gone: nothing is mirrored any more
  bool stop_ = false;
  std::thread thread_;  // last: it uses the others
};

}  // namespace probewalk
