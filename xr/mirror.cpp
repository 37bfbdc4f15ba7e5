#include "xr/mirror.h"

#include <spdlog/spdlog.h>

#include <cmath>
#include <utility>

#include "render/check.h"
#include "render/commands.h"
#include "xr/latency/clock.h"

namespace probewalk {

Mirror::Mirror(Window& window, const Device& device, VkExtent2D eye, std::uint32_t views, VkFormat format,
               ShownEyes shown, const OverlayBoard* overlay)
    : window_(window),
      device_(device),
      eye_(eye),
      shown_(shown),
      pacer_(static_cast<std::int64_t>(std::llround(1e9 / window.refresh_hz()))),
      // SAMPLED: our images have a view, and a view wants a use that is not copying alone.
      copy_(shown == ShownEyes::kSpectator
                ? Image()
                : Image(device, {format, eye, views,
                                 VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT |
                                     VK_IMAGE_USAGE_SAMPLED_BIT})),
      swapchain_(device, window.create_surface(device.instance()), 1, WindowSwapchain::Sharing::kBesideHeadset,
                 overlay) {
  pool_ = make_command_pool(device, device.queue_family());
  allocate_commands(device, pool_, {&commands_, 1});
  const VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  check(vkCreateFence(device.handle(), &fence, nullptr, &copied_), "vkCreateFence");
  thread_ = std::thread([this] { show_pictures(); });
}

Mirror::~Mirror() {
  {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
  spdlog::info("mirror: {} pictures, presenting one took {:.2f} ms at most",
               swapchain_.presented(), static_cast<double>(swapchain_.longest_present_ns()) * 1e-6);
  device_.wait_idle_or_lost();
  vkDestroyFence(device_.handle(), copied_, nullptr);
  vkDestroyCommandPool(device_.handle(), pool_, nullptr);
}

void Mirror::offer(const FrameTarget& target, FrameRecord& record) {
  offer_drawn(record, [&] {
    copy(target);
    FrameTarget copied = target;
    copied.image = copy_.handle();
    copied.final_layout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    return std::optional(copied);
  });
}

void Mirror::offer_drawn(FrameRecord& record, const std::function<std::optional<FrameTarget>()>& draw) {
  const std::int64_t now = now_ns();
  const MirrorPacer::Turn turn = pacer_.next(now, record.predicted_display, record.period);
  if (is_lost_ || turn == MirrorPacer::Turn::kNotDue) return;
  const VkExtent2D window = window_.framebuffer_extent();
  if (window.width == 0 || window.height == 0) return;
  record.mirror.begin = now;
  if (turn == MirrorPacer::Turn::kTaken && !busy_) {
    if (const auto eyes = draw()) {
      busy_ = true;
      {
        const std::scoped_lock lock(mutex_);
        next_ = Picture{*eyes, window, record.frame_id};
      }
      changed_.notify_all();
    }
  }
  record.mirror.end = now_ns();
}

void Mirror::settle() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !busy_; });
}

std::vector<MirrorShown> Mirror::take_shown() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(shown_pictures_, {});
}

void Mirror::copy(const FrameTarget& target) {
  check(vkResetCommandPool(device_.handle(), pool_, 0), "vkResetCommandPool");
  check(vkResetFences(device_.handle(), 1, &copied_), "vkResetFences");
  begin_commands(commands_);
  transition(commands_, target.image, target.final_layout, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
  transition(commands_, copy_.handle(), VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
  VkImageCopy region{};
  const std::uint32_t first = shown_ == ShownEyes::kRight && target.layers > 1 ? 1 : 0;
  const std::uint32_t count = shown_ == ShownEyes::kBoth ? target.layers : 1;
  region.srcSubresource = region.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, first, count};
  region.extent = {target.extent.width, target.extent.height, 1};
  vkCmdCopyImage(commands_, target.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, copy_.handle(),
                 VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
  transition(commands_, copy_.handle(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
  transition(commands_, target.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, target.final_layout);
  check(vkEndCommandBuffer(commands_), "vkEndCommandBuffer");
  VkCommandBufferSubmitInfo commands{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
  commands.commandBuffer = commands_;
  VkSubmitInfo2 submit{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
  submit.commandBufferInfoCount = 1;
  submit.pCommandBufferInfos = &commands;
  device_.submit(submit, copied_);
}

// On the mirror's thread.
void Mirror::show_pictures() {
  for (;;) {
    Picture picture;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return stop_ || next_.has_value(); });
      if (stop_) return;
      picture = *next_;
      next_.reset();
    }
    MirrorShown shown{picture.frame_id, {now_ns(), 0}, false};
    const std::uint64_t presented_before = swapchain_.presented();
    try {
      // A copy of the eyes; a picture of the mirror's own is waited for where it is copied to the window.
      if (shown_ != ShownEyes::kSpectator) {
        check(vkWaitForFences(device_.handle(), 1, &copied_, VK_TRUE, UINT64_MAX), "vkWaitForFences");
      }
      const VkExtent2D shape = shown_ == ShownEyes::kSpectator ? picture.eyes.extent : eye_;
      is_lost_ = !swapchain_.present(0, picture.eyes, window_layout(shown_, shape, picture.window), picture.window);
      if (is_lost_) spdlog::warn("the mirror's window is gone; the headset goes on");
    } catch (const Error& error) {
      spdlog::warn("the mirror ends: {}", error.what());
      is_lost_ = true;
    }
    shown.interval.end = now_ns();
    shown.presented = swapchain_.presented() > presented_before;
    {
      const std::scoped_lock lock(mutex_);
      shown_pictures_.push_back(shown);
      busy_ = false;
    }
    changed_.notify_all();
  }
}

}  // namespace probewalk
