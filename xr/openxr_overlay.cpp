#include "xr/openxr_overlay.h"

#include <spdlog/spdlog.h>

#include <chrono>

#include "content/error.h"
#include "render/check.h"
#include "render/commands.h"
#include "render/image.h"

namespace probewalk {
namespace {

constexpr XrDuration kRedrawn_ns = 100'000'000;

template <typename Result>
bool is_ready(const std::future<Result>& future) {
  return future.valid() && future.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

XrPosef pose_of(glm::dvec3 position_m, const glm::dquat& q) {
  const glm::vec3 p(position_m);
  const glm::quat o(q);
  return {{o.x, o.y, o.z, o.w}, {p.x, p.y, p.z}};
}

}  // namespace

OpenXrOverlay::Drawing::Drawing(const Device& device, XrSession session, VkFormat format)
    : swapchain(device, session, {format, XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT, kExtent, 1}),
      pass(device, format, panel.atlas(), 1) {}

OpenXrOverlay::OpenXrOverlay(const Device& device, XrSession session, VkFormat format, const OverlayBoard& board)
    : device_(device), session_(session), format_(format), board_(board), views_(device) {}

OpenXrOverlay::~OpenXrOverlay() {
  if (making_.valid()) making_.wait();
  if (picture_to_come_.valid()) picture_to_come_.wait();
  if (pool_ == VK_NULL_HANDLE) return;
  device_.wait_idle_or_lost();
  hide();
}

bool OpenXrOverlay::is_idle() const {
  return drawn_ == VK_NULL_HANDLE || vkGetFenceStatus(device_.handle(), drawn_) != VK_NOT_READY;
}

void OpenXrOverlay::hide() {
  views_.forget();
  drawing_.reset();
  has_picture_ = false;
  next_at_ = 0;
  place_.forget();
  vkDestroyFence(device_.handle(), drawn_, nullptr);
  vkDestroyCommandPool(device_.handle(), pool_, nullptr);
  drawn_ = VK_NULL_HANDLE;
  pool_ = VK_NULL_HANDLE;
}

OpenXrOutcome OpenXrOverlay::update(XrSpace space, XrTime time, glm::dvec3 head_m, const glm::dquat& head) {
  if (is_ready(making_)) {
    try {
      drawing_ = making_.get();
    } catch (const NoDevice& error) {
      spdlog::warn("no overlay in the headset: {}", error.what());
      refused_ = true;
    }
  }
  if (!board_.is_shown(OverlayPlace::kHeadset)) {
    if (is_ready(picture_to_come_)) picture_to_come_.get();
    if (drawing_ && !picture_to_come_.valid() && is_idle()) hide();
    return {};
  }
  if (!drawing_) {
    if (!refused_ && !making_.valid()) {
      making_ =
          std::async(std::launch::async, [this] { return std::make_unique<Drawing>(device_, session_, format_); });
    }
    return {};
  }
  OpenXrOutcome outcome;
  if (is_ready(picture_to_come_) && is_idle()) {
    outcome = draw(picture_to_come_.get());
    if (outcome.result != XR_SUCCESS) return outcome;
    has_picture_ = true;
  }
  if (!picture_to_come_.valid() && time >= next_at_) {
    next_at_ = time + kRedrawn_ns;
    picture_to_come_ = std::async(std::launch::async, [this] { return drawing_->panel.draw(board_.facts(), kExtent); });
  }
  place_.follow(head_m, head);
  quad_.layerFlags = XR_COMPOSITION_LAYER_BLEND_TEXTURE_SOURCE_ALPHA_BIT;
  quad_.space = space;
  quad_.eyeVisibility = XR_EYE_VISIBILITY_BOTH;
  quad_.subImage = drawing_->swapchain.layer(0, kExtent);
  quad_.pose = pose_of(place_.position_m(), place_.orientation());
  quad_.size = {kWidth_m, kWidth_m * static_cast<float>(kExtent.height) / static_cast<float>(kExtent.width)};
  return outcome;
}

const XrCompositionLayerBaseHeader* OpenXrOverlay::layer() const {
  const bool shown = has_picture_ && board_.is_shown(OverlayPlace::kHeadset);
  return shown ? reinterpret_cast<const XrCompositionLayerBaseHeader*>(&quad_) : nullptr;
}

OpenXrOutcome OpenXrOverlay::draw(const OverlayPicture& picture) {
  const OpenXrOutcome acquired = drawing_->swapchain.acquire();
  if (acquired.result != XR_SUCCESS) return acquired;
  record(drawing_->swapchain.image(), picture);
  VkCommandBufferSubmitInfo commands{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
  commands.commandBuffer = commands_;
  VkSubmitInfo2 submit{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
  submit.commandBufferInfoCount = 1;
  submit.pCommandBufferInfos = &commands;
  device_.submit(submit, drawn_);
  const auto queue = device_.lock_queue();
  return drawing_->swapchain.release();
}

void OpenXrOverlay::record(VkImage image, const OverlayPicture& picture) {
  if (pool_ == VK_NULL_HANDLE) {
    pool_ = make_command_pool(device_, device_.queue_family());
    allocate_commands(device_, pool_, {&commands_, 1});
    const VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    check(vkCreateFence(device_.handle(), &fence, nullptr, &drawn_), "vkCreateFence");
  }
  check(vkResetFences(device_.handle(), 1, &drawn_), "vkResetFences");
  check(vkResetCommandPool(device_.handle(), pool_, 0), "vkResetCommandPool");
  begin_commands(commands_);
  VkImageMemoryBarrier2 barrier =
      colour_barrier(image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
  barrier.srcStageMask = VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT;
  barrier.dstStageMask = VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT;
  pipeline_barrier(commands_, barrier);
  // One sees through where there is no panel.
  drawing_->pass.record(commands_, 0, views_.of(image, format_, 1).front(), kExtent, picture,
                        VK_ATTACHMENT_LOAD_OP_CLEAR);
  check(vkEndCommandBuffer(commands_), "vkEndCommandBuffer");
}

}  // namespace probewalk
