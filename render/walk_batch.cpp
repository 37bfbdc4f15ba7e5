#include "render/walk_batch.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "render/one_shot.h"
#include "render/spirv.h"

namespace probewalk {
namespace {

constexpr std::uint32_t kGroup = 64;  // local size of walk_rays.comp
// Keeps the buffers small and the dispatch within every device's limit of 65535 groups.
constexpr std::size_t kRaysPerDispatch = std::size_t{1} << 16;

}  // namespace

WalkBatch::WalkBatch(const Device& device)
    : device_(device),
      pipeline_(Pipeline::compute(device, nullptr, spirv::k_walk_rays_comp, {})),
      arena_(device),
      constants_(device, sizeof(WalkConstants), BufferMemory::kShared),
      rays_(device, kRaysPerDispatch * sizeof(WalkRay), BufferMemory::kShared),
      ends_(device, kRaysPerDispatch * sizeof(WalkEnd), BufferMemory::kReadback) {}

void WalkBatch::set_probe(const DeviceProbe& probe) {
  blocks_.reset();
  ProbeBlocks& blocks = blocks_.emplace(device_, arena_, std::vector<DeviceProbe>{probe}, false);
  if (!blocks.is_complete()) {
    run_commands(device_, [&](VkCommandBuffer commands) {
      blocks.copy(commands, std::numeric_limits<std::uint64_t>::max());
      VkMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
      barrier.srcStageMask = VK_PIPELINE_STAGE_2_COPY_BIT;
      barrier.srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
      barrier.dstStageMask = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
      barrier.dstAccessMask = VK_ACCESS_2_SHADER_STORAGE_READ_BIT;
      VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
      dependency.memoryBarrierCount = 1;
      dependency.pMemoryBarriers = &barrier;
      vkCmdPipelineBarrier2(commands, &dependency);
    });
    blocks.take_staging();
  }
  record_ = probe.record;
  record_.geometry_address = address_words(blocks.addresses().front().geometry);
  record_.radiance_address = address_words(blocks.addresses().front().radiance);
}

std::vector<WalkEnd> WalkBatch::walk(std::span<const WalkRay> rays, int start_level) {
  if (!blocks_) throw std::logic_error("rays are to be walked before there is a probe");
  std::vector<WalkEnd> ends;
  ends.reserve(rays.size());
  for (std::size_t first = 0; first < rays.size(); first += kRaysPerDispatch) {
    const auto part = rays.subspan(first, std::min(kRaysPerDispatch, rays.size() - first));
    std::memcpy(rays_.mapped(), part.data(), part.size_bytes());
    rays_.flush();
    WalkConstants batch{};
    batch.probe = record_;
    batch.rays_address = address_words(rays_.address());
    batch.ends_address = address_words(ends_.address());
    batch.ray_count = static_cast<std::uint32_t>(part.size());
    batch.start_level = start_level;
    std::memcpy(constants_.mapped(), &batch, sizeof(batch));
    constants_.flush();
    run_commands(device_, [&](VkCommandBuffer commands) {
      pipeline_.bind(commands, nullptr, {constants_.address()});
      vkCmdDispatch(commands, (batch.ray_count + kGroup - 1) / kGroup, 1, 1);
      make_visible_to_cpu(commands);
    });
    ends_.invalidate();
    const auto done = ends_.mapped_as<WalkEnd>();
    ends.insert(ends.end(), done.begin(), done.begin() + static_cast<std::ptrdiff_t>(part.size()));
  }
  return ends;
}

}  // namespace probewalk
