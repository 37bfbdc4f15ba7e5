#include "render/second_eye.h"

#include "render/commands.h"
#include "render/pixel_list.h"
#include "render/spirv.h"
#include "render/tracer_choice.h"
#include "shaders/shared/seen_surface.h"

namespace probewalk {
namespace {

std::uint32_t tiles(std::uint32_t side_px) { return (side_px + kSeenTile - 1) / kSeenTile; }

std::uint32_t margin_tiles(std::uint32_t width_px) {
  return static_cast<std::uint32_t>(seen_margin(static_cast<int>(tiles(width_px))));
}

VkDeviceSize pixels(const SecondEyeOptions& options) {
  return VkDeviceSize{options.extent_px.width} * options.extent_px.height * options.pairs;
}

VkDeviceSize depths(const SecondEyeOptions& options) {
  const VkDeviceSize columns = tiles(options.extent_px.width) + margin_tiles(options.extent_px.width);
  return columns * tiles(options.extent_px.height) * options.pairs;
}

}  // namespace

SecondEye::SecondEye(const Device& device, const StorageImageSet& images, const SecondEyeOptions& options)
    : images_(images),
      options_(options),
      surfaces_(device, sizeof(SeenSurface) * pixels(options), BufferMemory::kDevice),
      depths_(device, sizeof(float) * depths(options), BufferMemory::kDevice),
      list_(make_pixel_list(device, sizeof(RestRay), pixels(options))),
      find_near_depths_(Pipeline::compute(device, &images, spirv::k_find_near_depths_comp, {})),
      ask_(Pipeline::compute(device, &images, spirv::k_ask_first_eye_comp,
                             tracing_constants({options.aov ? VK_TRUE : VK_FALSE, options.interleave,
                                                options.masked ? VK_TRUE : VK_FALSE},
                                               options.choice))),
      trace_rest_(Pipeline::compute(device, &images, spirv::k_trace_rest_comp,
                                    tracing_constants({options.aov ? VK_TRUE : VK_FALSE, options.interleave},
                                                      options.choice, {.shared_openings = options.shared_openings}))) {
}

bool SecondEye::suits(VkExtent2D extent_px, std::uint32_t views, bool foveated, const TracerChoice& choice) {
  return views % 2 == 0 && !foveated && !choice.is_baseline() && can_be_listed(extent_px) &&
         tiles(extent_px.width) + margin_tiles(extent_px.width) <= kSeenMostColumns;
}

void SecondEye::lend(PushConstants& push) const {
  push.surfaces = surfaces_.address();
  push.depths = depths_.address();
}

std::uint32_t SecondEye::columns_beyond(VkExtent2D extent_px) {
  return (margin_tiles(extent_px.width) + kSeenTile - 1) / kSeenTile;
}

void SecondEye::record(VkCommandBuffer commands, VkDeviceAddress frame, VkDeviceAddress openings,
                       VkExtent2D extent_px) const {
  PushConstants push{.constants = frame, .list = list_.address(), .openings = openings};
  lend(push);

  empty_pixel_list(commands, list_);
  find_near_depths_.bind(commands, &images_, push);
  vkCmdDispatch(commands, 1, tiles(extent_px.height), options_.pairs);
  memory_barrier(commands, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                 VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_READ_BIT);
  ask_.bind(commands, &images_, push);
  vkCmdDispatch(commands, tiles(extent_px.width), tiles(extent_px.height), options_.pairs);
  trace_rest_.bind(commands, &images_, push);
  dispatch_pixel_list(commands, list_);
}

}  // namespace probewalk
