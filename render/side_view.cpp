#include "render/side_view.h"

#include <chrono>
#include <cstring>

#include "render/check.h"
#include "render/commands.h"

namespace probewalk {
namespace {

constexpr std::uint32_t kGuideRest_pictures = 500;  // from one teleport to the next it pays to keep them

}  // namespace

SideView::SideView(const Device& device, const TracerOptions& tracer, VkFormat format)
    : device_(device),
      tracer_(device, tracer),
      resolve_(device, tracer_.radiance(), format),
      image_(device,
             {format, tracer.extent_px, 1, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT}),
      view_(make_layer_view(device, image_.handle(), format, 0)),
      constants_(device, sizeof(FrameConstants), BufferMemory::kShared) {
  target_.image = image_.handle();
  target_.format = format;
  target_.extent = tracer.extent_px;
  target_.layers = 1;
  target_.final_layout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
  pool_ = make_command_pool(device, device.queue_family());
  allocate_commands(device, pool_, {&commands_, 1});
}

SideView::~SideView() {
  vkDestroyCommandPool(device_.handle(), pool_, nullptr);
  vkDestroyImageView(device_.handle(), view_, nullptr);
}

GuidePass* SideView::choose_guides(bool wanted) {
  if (guides_to_come_.valid() && guides_to_come_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    guides_ = guides_to_come_.get();
  }
  if (wanted) {
    pictures_without_guides_ = 0;
    if (!guides_ && !guides_to_come_.valid()) {
      guides_to_come_ = std::async(std::launch::async, [this] {
        return std::make_unique<GuidePass>(device_, tracer_.distance(), target_.format, 1);
      });
    }
    return guides_.get();
  }
  if (guides_ && ++pictures_without_guides_ > kGuideRest_pictures) guides_.reset();
  return nullptr;
}

VkCommandBuffer SideView::record(const FrameConstants& constants, const Guides& guides) {
  std::memcpy(constants_.mapped(), &constants, sizeof(constants));
  constants_.flush();
  check(vkResetCommandPool(device_.handle(), pool_, 0), "vkResetCommandPool");
  begin_commands(commands_);
  tracer_.record(commands_, constants_.address(), extent());
  // Whoever copied the last picture comes first.
  VkImageMemoryBarrier2 copied =
      colour_barrier(target_.image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
  copied.srcStageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
  copied.dstStageMask = VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT;
  copied.dstAccessMask = VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT;
  pipeline_barrier(commands_, copied);
  resolve_.record(commands_, constants_.address(), target_, {&view_, 1});
  if (GuidePass* guide_pass = choose_guides(guides.any())) {
    guide_pass->record(commands_, 0, constants_.address(), tracer_.distance(), target_, {&view_, 1}, guides);
  }
  check(vkEndCommandBuffer(commands_), "vkEndCommandBuffer");
  return commands_;
}

}  // namespace probewalk
