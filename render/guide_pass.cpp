#include "render/guide_pass.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "render/commands.h"
#include "render/spirv.h"
#include "shaders/shared/guides.h"

namespace probewalk {
namespace {

// In the viewer's metres.
constexpr double kHalfWidth_m = 0.012;
constexpr double kRingRadius_m = 0.25;
constexpr double kCrossRadius_m = 0.10;
constexpr double kLift_m = 0.01;   // of the ring over the floor
constexpr double kSlack_m = 0.03;  // the ring lies on what the trace met
// A way that ends in a wall ends up to a column of the floor's map behind what is seen of it.
constexpr double kCrossSlack_m = 0.25;
// Linear; their lightness differs, too, and the marker's shape, for those who cannot tell the two apart.
const glm::vec3 kLands(0.03f, 0.75f, 0.16f);
const glm::vec3 kLandsNowhere(0.75f, 0.03f, 0.02f);

void put_aim(const AimGuide& aim, GuideConstants& constants) {
  if (aim.way_m.empty() && !aim.landing_m) return;
  const glm::dvec3 end_m = aim.landing_m ? *aim.landing_m : aim.way_m.back();
  const bool lands = aim.landing_m.has_value();
  constants.origin_hi_m = glm::vec3(end_m);
  constants.origin_lo_m = glm::vec3(end_m - glm::dvec3(constants.origin_hi_m));
  constants.half_width_m = static_cast<float>(kHalfWidth_m * aim.scale);
  constants.slack_m = static_cast<float>(kSlack_m * aim.scale);
  constants.color = lands ? kLands : kLandsNowhere;
  constants.marker_m = glm::vec3(0.0f, lands ? static_cast<float>(kLift_m * aim.scale) : 0.0f, 0.0f);
  constants.marker_radius_m = static_cast<float>((lands ? kRingRadius_m : kCrossRadius_m) * aim.scale);
  constants.marker_lies = lands ? 1 : 0;
  constants.marker_slack_m = static_cast<float>((lands ? kSlack_m : kCrossSlack_m) * aim.scale);
  if (!aim.shows_way) return;
  constants.points = static_cast<int>(std::min<std::size_t>(aim.way_m.size(), kGuidePoints));
  for (int i = 0; i < constants.points; ++i) {
    constants.point_m[i] = glm::vec3(aim.way_m[static_cast<std::size_t>(i)] - end_m);
  }
}

GuideConstants constants_of(const Guides& guides) {
  GuideConstants constants{};
  if (guides.aim) put_aim(*guides.aim, constants);
  if (guides.vignette) {
    constants.vignette_clear = static_cast<float>(std::tan(guides.vignette->clear_rad));
    constants.vignette_black = static_cast<float>(std::tan(guides.vignette->black_rad));
  }
  return constants;
}

}  // namespace

GuidePass::Slot::Slot(const Device& device, const Image& distance)
    : images(device, VK_SHADER_STAGE_FRAGMENT_BIT, {distance.view()}),
      constants(device, sizeof(GuideConstants), BufferMemory::kShared) {}

GuidePass::GuidePass(const Device& device, const Image& distance, VkFormat format, std::uint32_t slots)
    : pipeline_([&] {
        for (std::uint32_t i = 0; i < slots; ++i) slots_.emplace_back(device, distance);
        return Pipeline::blended(device, &slots_.front().images, spirv::k_guides_vert, spirv::k_guides_frag, format);
      }()) {}

void GuidePass::record(VkCommandBuffer commands, std::uint32_t slot, VkDeviceAddress frame, const Image& distance,
                       const FrameTarget& target, std::span<const VkImageView> layer_views, const Guides& guides) {
  const Slot& mine = slots_.at(slot);
  const GuideConstants constants = constants_of(guides);
  std::memcpy(mine.constants.mapped(), &constants, sizeof(constants));
  mine.constants.flush();
  mine.images.show(0, distance.view());

  VkImageMemoryBarrier2 barrier =
      colour_barrier(target.image, target.final_layout, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
  // After the picture's own last barrier, which ends with copies.
  barrier.srcStageMask = VK_PIPELINE_STAGE_2_COPY_BIT | VK_PIPELINE_STAGE_2_BLIT_BIT;
  barrier.dstStageMask = VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT;
  pipeline_barrier(commands, barrier);

  const auto draw = [&](int first_quad, int end_quad) {
    vkCmdDraw(commands, static_cast<std::uint32_t>(6 * (end_quad - first_quad)), 1,
              static_cast<std::uint32_t>(6 * first_quad), 0);
  };
  for (std::uint32_t layer = 0; layer < target.layers; ++layer) {
    begin_drawing(commands, layer_views[layer], target.extent, VK_ATTACHMENT_LOAD_OP_LOAD);
    pipeline_.bind(commands, &mine.images, {frame, layer, 0, mine.constants.address()});
    if (constants.marker_radius_m > 0.0f) draw(0, kGuideVignetteQuad);
    if (guides.vignette) draw(kGuideVignetteQuad, kGuideQuads);
    vkCmdEndRendering(commands);
  }

  barrier = colour_barrier(target.image, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, target.final_layout);
  barrier.srcStageMask = VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT;
  barrier.srcAccessMask = VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT;
  barrier.dstStageMask = VK_PIPELINE_STAGE_2_COPY_BIT | VK_PIPELINE_STAGE_2_BLIT_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_TRANSFER_READ_BIT;
  pipeline_barrier(commands, barrier);
}

}  // namespace probewalk
