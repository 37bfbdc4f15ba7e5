#include "render/pyramid_builder.h"

#include <algorithm>
#include <utility>

#include "content/probe/tracer_f32.h"
#include "render/commands.h"
#include "render/spirv.h"
#include "shaders/shared/pyramid_build.h"

namespace probewalk {
namespace {

constexpr std::uint32_t kMostGroups = 65535;  // in one dispatch on any device

}  // namespace

PyramidJob::PyramidJob(std::vector<Site> sites) : sites_(std::move(sites)) {
  for (const Site& site : sites_) top_ = std::max(top_, f32::pyramid_top(static_cast<int>(site.n_log2)));
}

PyramidBuilder::PyramidBuilder(const Device& device)
    : cells_(Pipeline::compute(device, nullptr, spirv::k_build_pyramid_cells_comp, {})),
      nodes_(Pipeline::compute(device, nullptr, spirv::k_build_pyramid_nodes_comp, {})) {}

std::uint64_t PyramidBuilder::record(VkCommandBuffer commands, PyramidJob& job, std::uint64_t budget_bytes) const {
  std::uint64_t read_bytes = 0;
  // Of the level before, maybe by an earlier frame.
  bool is_level_below_seen = job.level_ == 1;
  while (!job.is_done() && read_bytes < budget_bytes) {
    const PyramidJob::Site& site = job.sites_[job.site_];
    const std::uint32_t side = (1u << site.n_log2) >> job.level_;
    const std::uint32_t words = f32::pyramid_top(static_cast<int>(site.n_log2)) >= job.level_ ? side * side / 2 : 0;
    if (job.word_ < words) {
      // Whether all its samples are looked at, or none because it cannot be planar, only the device knows.
      const std::uint64_t word_bytes = std::uint64_t{2 * sizeof(float)} << (2 * job.level_);
      const std::uint32_t per_group = job.level_ == 1 ? kCellsGroup : 1;
      if (read_bytes > 0 && budget_bytes - read_bytes < word_bytes * per_group) break;
      const auto groups = static_cast<std::uint32_t>(
          std::clamp<std::uint64_t>((budget_bytes - read_bytes) / (word_bytes * per_group), 1,
                                    std::min((words - job.word_ + per_group - 1) / per_group, kMostGroups)));
      if (!std::exchange(is_level_below_seen, true)) make_visible_between_shaders(commands);
      const Pipeline& pipeline = job.level_ == 1 ? cells_ : nodes_;
      pipeline.bind(
          commands, nullptr,
          {site.geometry,
           static_cast<std::uint32_t>(job.level_) | site.n_log2 << 8 | (site.has_tiled_samples ? 1u << 16 : 0u),
           job.word_});
      vkCmdDispatch(commands, groups, 1, 1);
      const std::uint32_t made = std::min(groups * per_group, words - job.word_);
      read_bytes += made * word_bytes;
      job.word_ += made;
    }
    if (job.word_ < words) continue;
    job.word_ = 0;
    if (++job.site_ < job.sites_.size()) continue;
    job.site_ = 0;
    job.level_ += 2;
    is_level_below_seen = false;
  }
  return read_bytes;
}

void make_visible_between_shaders(VkCommandBuffer commands) {
  constexpr VkPipelineStageFlags2 kShaders = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
  constexpr VkAccessFlags2 kWritten = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
  memory_barrier(commands, kShaders, kWritten, kShaders, VK_ACCESS_2_SHADER_STORAGE_READ_BIT | kWritten);
}

}  // namespace probewalk
