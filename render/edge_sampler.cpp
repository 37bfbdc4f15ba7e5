#include "render/edge_sampler.h"

#include <fmt/format.h>

#include <stdexcept>

#include "render/commands.h"
#include "render/spirv.h"
#include "render/tracer_choice.h"
#include "shaders/shared/edge_list.h"

namespace probewalk {
namespace {

constexpr std::uint32_t kTile = 8;  // local size of find_edges.comp, both ways

VkDeviceSize list_bytes(const EdgeSamplerOptions& options) {
  constexpr std::uint32_t kMaxSide_px = 1u << kEdgeSideBits;
  if (options.samples != 2 && options.samples != 4) {
    throw std::logic_error(fmt::format("{} samples: edges are sampled 2 or 4 times", options.samples));
  }
  if (options.extent_px.width > kMaxSide_px || options.extent_px.height > kMaxSide_px) {
    throw std::logic_error(fmt::format("edges of a picture of {} x {} pixels; at most {} a side fit the list",
                                       options.extent_px.width, options.extent_px.height, kMaxSide_px));
  }
  return sizeof(EdgeListHead) +
         sizeof(std::uint32_t) * VkDeviceSize{options.extent_px.width} * options.extent_px.height * options.views;
}

}  // namespace

EdgeSampler::EdgeSampler(const Device& device, const StorageImageSet& images, const EdgeSamplerOptions& options)
    : images_(images),
      options_(options),
      list_(device, list_bytes(options), BufferMemory::kDevice, VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT),
      find_(Pipeline::compute(
          device, &images, spirv::k_find_edges_comp,
          {options.interleave, options.foveated ? VK_TRUE : VK_FALSE, options.masked ? VK_TRUE : VK_FALSE})),
      sample_(Pipeline::compute(
          device, &images,
          tracing_module(options.choice, spirv::k_sample_edges_comp, spirv::k_sample_edges_baseline_comp),
          tracing_constants({options.aov ? VK_TRUE : VK_FALSE, options.interleave, options.samples}, options.choice,
                            {.shared_openings = options.shared_openings}))) {
}

void EdgeSampler::record(VkCommandBuffer commands, VkDeviceAddress frame, VkDeviceAddress openings,
                         VkExtent2D extent_px) const {
  constexpr VkPipelineStageFlags2 kCompute = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
  constexpr VkAccessFlags2 kRead = VK_ACCESS_2_SHADER_STORAGE_READ_BIT, kWrite = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
  const PushConstants push{.constants = frame, .list = list_.address(), .openings = openings};

  // The last frame's rays have read the list.
  memory_barrier(commands, kCompute | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT, 0, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                 VK_ACCESS_2_TRANSFER_WRITE_BIT);
  const EdgeListHead empty{0, 1, 1, 0};
  vkCmdUpdateBuffer(commands, list_.handle(), 0, sizeof(empty), &empty);
  memory_barrier(commands, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT | kCompute, VK_ACCESS_2_TRANSFER_WRITE_BIT | kWrite,
                 kCompute, kRead | kWrite);
  find_.bind(commands, &images_, push);
  vkCmdDispatch(commands, (extent_px.width + kTile - 1) / kTile, (extent_px.height + kTile - 1) / kTile,
                options_.views);
  memory_barrier(commands, kCompute, kWrite, kCompute | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT,
                 kRead | kWrite | VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT);
  sample_.bind(commands, &images_, push);
  vkCmdDispatchIndirect(commands, list_.handle(), 0);
}

}  // namespace probewalk
