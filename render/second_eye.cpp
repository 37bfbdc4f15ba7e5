#include "render/second_eye.h"

#include "render/commands.h"
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

VkDeviceSize starts(const SecondEyeOptions& options) {
  const VkDeviceSize columns = tiles(options.extent_px.width) + margin_tiles(options.extent_px.width);
  return columns * tiles(options.extent_px.height) * options.pairs;
}

}  // namespace

SecondEye::SecondEye(const Device& device, const StorageImageSet& images, const SecondEyeOptions& options)
    : images_(images),
      options_(options),
      surfaces_(device, sizeof(SeenSurface) * pixels(options), BufferMemory::kDevice),
      starts_(device, sizeof(std::uint32_t) * starts(options), BufferMemory::kDevice),
      list_(device, sizeof(RestHead) + sizeof(RestRay) * pixels(options), BufferMemory::kDevice,
            VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT),
      find_starts_(Pipeline::compute(device, &images, spirv::k_find_starts_comp, {})),
      ask_(Pipeline::compute(device, &images, spirv::k_ask_first_eye_comp,
                             tracing_constants({options.aov ? VK_TRUE : VK_FALSE, options.interleave,
                                                options.masked ? VK_TRUE : VK_FALSE},
                                               options.choice))),
      trace_rest_(Pipeline::compute(device, &images, spirv::k_trace_rest_comp,
                                    tracing_constants({options.aov ? VK_TRUE : VK_FALSE, options.interleave},
                                                      options.choice, {.shared_openings = options.shared_openings}))) {
}

bool SecondEye::suits(std::uint32_t views, bool foveated, const TracerChoice& choice) {
  return views % 2 == 0 && !foveated && !choice.is_baseline();
}

bool SecondEye::fits(VkExtent2D extent_px) {
  constexpr std::uint32_t kMaxSide_px = 1u << kRestSideBits;
  return extent_px.width <= kMaxSide_px && extent_px.height <= kMaxSide_px &&
         tiles(extent_px.width) + margin_tiles(extent_px.width) <= kSeenMostColumns;
}

void SecondEye::lend(PushConstants& push) const {
  push.surfaces = surfaces_.address();
  push.starts = starts_.address();
}

std::uint32_t SecondEye::columns_beyond(VkExtent2D extent_px) {
  return (margin_tiles(extent_px.width) + kSeenTile - 1) / kSeenTile;
}

void SecondEye::record(VkCommandBuffer commands, VkDeviceAddress frame, VkDeviceAddress openings,
                       VkExtent2D extent_px) const {
  constexpr VkPipelineStageFlags2 kCompute = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
  constexpr VkPipelineStageFlags2 kTransfer = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
  constexpr VkPipelineStageFlags2 kIndirect = VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT;
  constexpr VkAccessFlags2 kRead = VK_ACCESS_2_SHADER_STORAGE_READ_BIT, kWrite = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
  PushConstants push{.constants = frame, .list = list_.address(), .openings = openings};
  lend(push);

  // The last frame's rays have read the list.
  memory_barrier(commands, kCompute | kIndirect, 0, kTransfer, VK_ACCESS_2_TRANSFER_WRITE_BIT);
  const RestHead empty{0, 1, 1, 0};
  vkCmdUpdateBuffer(commands, list_.handle(), 0, sizeof(empty), &empty);
  memory_barrier(commands, kTransfer | kCompute, VK_ACCESS_2_TRANSFER_WRITE_BIT | kWrite, kCompute, kRead | kWrite);
  find_starts_.bind(commands, &images_, push);
  vkCmdDispatch(commands, 1, tiles(extent_px.height), options_.pairs);
  memory_barrier(commands, kCompute, kWrite, kCompute, kRead | kWrite);
  ask_.bind(commands, &images_, push);
  vkCmdDispatch(commands, tiles(extent_px.width), tiles(extent_px.height), options_.pairs);
  memory_barrier(commands, kCompute, kWrite, kCompute | kIndirect,
                 kRead | kWrite | VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT);
  trace_rest_.bind(commands, &images_, push);
  vkCmdDispatchIndirect(commands, list_.handle(), 0);
}

}  // namespace probewalk
