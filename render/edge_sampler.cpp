#include "render/edge_sampler.h"

#include <fmt/format.h>

#include <stdexcept>

#include "render/pixel_list.h"
#include "render/spirv.h"
#include "render/tracer_choice.h"
#include "shaders/shared/pixel_list.h"

namespace probewalk {
namespace {

constexpr std::uint32_t kTile = 8;  // local size of find_edges.comp, both ways

const EdgeSamplerOptions& checked(const EdgeSamplerOptions& options) {
  if (options.samples != 2 && options.samples != 4) {
    throw std::logic_error(fmt::format("{} samples: edges are sampled 2 or 4 times", options.samples));
  }
  if (!can_be_listed(options.extent_px)) {
    throw std::logic_error(fmt::format("edges of a picture of {} x {} pixels; at most {} a side fit the list",
                                       options.extent_px.width, options.extent_px.height, 1u << kListSideBits));
  }
  return options;
}

}  // namespace

EdgeSampler::EdgeSampler(const Device& device, const StorageImageSet& images, const EdgeSamplerOptions& options)
    : images_(images),
      options_(checked(options)),
      list_(make_pixel_list(device, sizeof(std::uint32_t),
                            VkDeviceSize{options.extent_px.width} * options.extent_px.height * options.views)),
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
  const PushConstants push{.constants = frame, .list = list_.address(), .openings = openings};

  empty_pixel_list(commands, list_);
  find_.bind(commands, &images_, push);
  vkCmdDispatch(commands, (extent_px.width + kTile - 1) / kTile, (extent_px.height + kTile - 1) / kTile,
                options_.views);
  sample_.bind(commands, &images_, push);
  dispatch_pixel_list(commands, list_);
}

}  // namespace probewalk
