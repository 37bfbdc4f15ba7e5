#include "render/ray_batch.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cstring>

#include "content/probe/device_probe.h"
#include "render/buffer.h"
#include "render/one_shot.h"
#include "render/spirv.h"

namespace probewalk {
namespace {

constexpr std::uint32_t kGroup = 64;  // local size of trace_rays.comp
// Keeps the buffers small and the dispatch within every device's limit of 65535 groups.
constexpr std::size_t kRaysPerDispatch = std::size_t{1} << 20;

BatchRay to_batch_ray(const WorldRay& ray) {
  BatchRay result{};
  split_position(ray.origin_m, result.origin_hi_m, result.origin_lo_m);
  result.unit_direction = glm::vec3(glm::normalize(ray.direction));
  return result;
}

}  // namespace

RayBatch::RayBatch(const Device& device)
    : device_(device), pipeline_(Pipeline::compute(device, nullptr, spirv::k_trace_rays_comp, {})) {}

std::vector<BatchAnswer> RayBatch::trace(const ProbeStore& store, const TraceConstants& dials,
                                         std::span<const WorldRay> rays, float spread_rad) const {
  std::int64_t ignored_ns = 0;
  return trace(store, dials, rays, spread_rad, ignored_ns);
}

std::vector<BatchAnswer> RayBatch::trace(const ProbeStore& store, const TraceConstants& dials,
                                         std::span<const WorldRay> rays, float spread_rad,
                                         std::int64_t& dispatches_ns) const {
  dispatches_ns = 0;
  std::vector<BatchAnswer> answers;
  if (rays.empty()) return answers;
  answers.reserve(rays.size());
  const std::size_t largest = std::min(rays.size(), kRaysPerDispatch);
  const Buffer constants(device_, sizeof(BatchConstants), BufferMemory::kShared);
  const Buffer ray_buffer(device_, largest * sizeof(BatchRay), BufferMemory::kShared);
  const Buffer answer_buffer(device_, largest * sizeof(BatchAnswer), BufferMemory::kReadback);
  for (std::size_t first = 0; first < rays.size(); first += largest) {
    const auto part = rays.subspan(first, std::min(largest, rays.size() - first));
    std::transform(part.begin(), part.end(), ray_buffer.mapped_as<BatchRay>().begin(), to_batch_ray);
    ray_buffer.flush();
    BatchConstants batch{};
    batch.grid = store.grid(0);
    batch.trace = dials;
    batch.rays_address = address_words(ray_buffer.address());
    batch.answers_address = address_words(answer_buffer.address());
    batch.ray_count = static_cast<std::uint32_t>(part.size());
    batch.spread_rad = spread_rad;
    std::memcpy(constants.mapped(), &batch, sizeof(batch));
    constants.flush();
    const auto begin = std::chrono::steady_clock::now();
    run_commands(device_, [&](VkCommandBuffer commands) {
      pipeline_.bind(commands, nullptr, {constants.address()});
      vkCmdDispatch(commands, (batch.ray_count + kGroup - 1) / kGroup, 1, 1);
      make_visible_to_cpu(commands);
    });
    dispatches_ns += (std::chrono::steady_clock::now() - begin) / std::chrono::nanoseconds(1);
    answer_buffer.invalidate();
    const auto done = answer_buffer.mapped_as<BatchAnswer>();
    answers.insert(answers.end(), done.begin(), done.begin() + static_cast<std::ptrdiff_t>(part.size()));
  }
  return answers;
}

}  // namespace probewalk
