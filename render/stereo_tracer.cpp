#include "render/stereo_tracer.h"

#include <algorithm>
#include <numeric>
#include <type_traits>

#include "content/probe/tracer_f32.h"
#include "render/one_shot.h"
#include "render/spirv.h"

namespace probewalk {
namespace {

constexpr std::uint32_t kTile = 8;  // local size of trace_stereo.glsl, both ways

// Rows of tiles a view, made up so that the interleave divides those of all views.
std::uint32_t tile_rows(std::uint32_t height_px, std::uint32_t views, std::uint32_t interleave) {
  const std::uint32_t rows = (height_px + kTile - 1) / kTile;
  const std::uint32_t step = interleave / std::gcd(interleave, views);
  return (rows + step - 1) / step * step;
}

Image make_output(const Device& device, const TracerOptions& options, VkFormat format) {
  return Image(
      device, {format, options.extent_px, options.views, VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
}

TracerOptions checked(TracerOptions options) {
  check_setup(options.setup);
  options.second_from_first = options.second_from_first &&
                              SecondEye::suits(options.extent_px, options.views, options.foveation.has_value(),
                                               options.setup.choice);
  return options;
}

TracerOptions one_texel(TracerOptions options) {
  options.extent_px = {1, 1};
  return options;
}

}  // namespace

StereoTracer::StereoTracer(const Device& device, const TracerOptions& options)
    : options_(checked(options)),
      interleave_(choose_interleave(device)),
      radiance_(make_output(device, options, VK_FORMAT_R16G16B16A16_SFLOAT)),
      distance_(make_output(device, options, VK_FORMAT_R32_SFLOAT)),
      aov_(make_output(device, options.aov ? options : one_texel(options), VK_FORMAT_R32G32B32A32_UINT)),
      images_(device, VK_SHADER_STAGE_COMPUTE_BIT, {radiance_.view(), distance_.view(), aov_.view()}),
      pipeline_(Pipeline::compute(
          device, &images_,
          tracing_module(options.setup.choice, spirv::k_trace_stereo_comp, spirv::k_trace_stereo_baseline_comp),
          tracing_constants({options.aov ? VK_TRUE : VK_FALSE, interleave_, options.foveation ? VK_TRUE : VK_FALSE,
                             options.masked ? VK_TRUE : VK_FALSE},
                            options.setup.choice, {options.shared_openings, options_.second_from_first}))) {
  if (options.shared_openings) {
    constexpr std::size_t kCorners = std::extent_v<decltype(f32::CellCandidates::probe)>;
    openings_ = Buffer(device, sizeof(f32::CandidatePlace) * kCorners * options.views, BufferMemory::kDevice);
    find_openings_.emplace(
        Pipeline::compute(device, nullptr, spirv::k_find_openings_comp, tracing_constants({}, options.setup.choice)));
  }
  if (options_.second_from_first) {
    second_eyes_ = std::make_unique<SecondEye>(
        device, images_,
        SecondEyeOptions{options.extent_px, options.views / 2, options.aov, interleave_, options.masked,
                         options.shared_openings, options.setup.choice});
  }
  if (options.foveation) {
    fill_.emplace(Pipeline::compute(device, &images_, spirv::k_fill_blocks_comp,
                                    {options.aov ? VK_TRUE : VK_FALSE, options.masked ? VK_TRUE : VK_FALSE}));
  }
  if (options.samples != 1) {
    edges_ = std::make_unique<EdgeSampler>(
        device, images_,
        EdgeSamplerOptions{options.extent_px, options.views, options.aov, options.samples, interleave_, options.masked,
                           options.foveation.has_value(), options.shared_openings, options.setup.choice});
  }
  // The images stay in the general layout for good.
  run_commands(device, [&](VkCommandBuffer commands) {
    for (const Image* image : {&radiance_, &distance_, &aov_}) {
      transition(commands, image->handle(), VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL);
    }
  });
}

void StereoTracer::record(VkCommandBuffer commands, VkDeviceAddress frame, VkExtent2D extent_px) const {
  VkMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
  VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  dependency.memoryBarrierCount = 1;
  dependency.pMemoryBarriers = &barrier;
  // Whoever reads or wrote the last frame's images comes first.
  barrier.srcStageMask =
      VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT | VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_COPY_BIT;
  barrier.srcAccessMask = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
  barrier.dstStageMask = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
  vkCmdPipelineBarrier2(commands, &dependency);

  PushConstants push{.constants = frame};
  if (find_openings_) {
    push.openings = openings_.address();
    find_openings_->bind(commands, nullptr, push);
    vkCmdDispatch(commands, options_.views, 1, 1);
    barrier.srcStageMask = barrier.dstStageMask = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
    barrier.srcAccessMask = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_2_SHADER_STORAGE_READ_BIT;
    vkCmdPipelineBarrier2(commands, &dependency);
  }
  const std::uint32_t columns = (extent_px.width + kTile - 1) / kTile;
  if (second_eyes_) second_eyes_->lend(push);
  pipeline_.bind(commands, &images_, push);
  const std::uint32_t views = second_eyes_ ? options_.views / 2 : options_.views;
  const std::uint32_t beyond = second_eyes_ ? SecondEye::columns_beyond(extent_px) : 0;
  vkCmdDispatch(commands, columns + beyond, tile_rows(extent_px.height, views, interleave_), views);
  if (second_eyes_) second_eyes_->record(commands, frame, push.openings, extent_px);

  if (fill_) {
    barrier.srcStageMask = barrier.dstStageMask = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
    barrier.srcAccessMask = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
    vkCmdPipelineBarrier2(commands, &dependency);
    fill_->bind(commands, &images_, {frame});
    vkCmdDispatch(commands, columns, (extent_px.height + kTile - 1) / kTile, options_.views);
  }
  if (edges_) edges_->record(commands, frame, openings_.address(), extent_px);

  barrier.srcStageMask = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
  barrier.srcAccessMask = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
  barrier.dstStageMask = VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT | VK_PIPELINE_STAGE_2_COPY_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_TRANSFER_READ_BIT;
  vkCmdPipelineBarrier2(commands, &dependency);
}

}  // namespace probewalk
