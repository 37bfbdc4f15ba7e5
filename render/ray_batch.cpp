#include "render/ray_batch.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "content/probe/device_probe.h"
#include "render/buffer.h"
#include "render/gpu_clock.h"
#include "render/one_shot.h"
#include "render/spirv.h"

namespace probewalk {
namespace {

constexpr std::uint32_t kGroup = 64;  // local size of trace_rays.glsl
// Keeps the buffers small and the dispatch within every device's limit of 65535 groups.
constexpr std::size_t kRaysPerDispatch = std::size_t{1} << 20;

BatchRay to_batch_ray(const WorldRay& ray) {
  BatchRay result{};
  split_position(ray.origin_m, result.origin_hi_m, result.origin_lo_m);
  result.unit_direction = glm::vec3(glm::normalize(ray.direction));
  return result;
}

const TracerSetup& checked(const TracerSetup& setup) {
  check_setup(setup);
  return setup;
}

}  // namespace

RayBatch::RayBatch(const Device& device, const TracerSetup& setup)
    : device_(device),
      setup_(checked(setup)),
      interleave_(choose_interleave(device)),
      pipeline_(Pipeline::compute(
          device, nullptr, tracing_module(setup.choice, spirv::k_trace_rays_comp, spirv::k_trace_rays_baseline_comp),
          tracing_constants({0, interleave_}, setup.choice))) {}

std::vector<BatchAnswer> RayBatch::trace(const ProbeStore& store, const TraceConstants& dials,
                                         std::span<const WorldRay> rays, float spread_rad) const {
  return trace_timed(store, dials, rays, spread_rad).answers;
}

TracedRays RayBatch::trace_timed(const ProbeStore& store, const TraceConstants& dials, std::span<const WorldRay> rays,
                                 float spread_rad) const {
  TracedRays result;
  std::vector<BatchAnswer>& answers = result.answers;
  if (rays.empty()) return result;
  answers.reserve(rays.size());
  const std::size_t largest = std::min(rays.size(), kRaysPerDispatch);
  const Buffer constants(device_, sizeof(BatchConstants), BufferMemory::kShared);
  const Buffer ray_buffer(device_, largest * sizeof(BatchRay), BufferMemory::kShared);
  const Buffer answer_buffer(device_, largest * sizeof(BatchAnswer), BufferMemory::kReadback);
  const GpuClock clock(device_);
  PassTimer timer(device_, 1);
  for (std::size_t first = 0; first < rays.size(); first += largest) {
    const auto part = rays.subspan(first, std::min(largest, rays.size() - first));
    std::transform(part.begin(), part.end(), ray_buffer.mapped_as<BatchRay>().begin(), to_batch_ray);
    ray_buffer.flush();
    BatchConstants batch{};
    batch.grid = store.grid(0);
    batch.trace = with_choice(dials, setup_.choice);
    batch.rays_address = address_words(ray_buffer.address());
    batch.answers_address = address_words(answer_buffer.address());
    batch.ray_count = static_cast<std::uint32_t>(part.size());
    batch.spread_rad = spread_rad;
    batch.baseline_address = baseline_address(setup_);
    std::memcpy(constants.mapped(), &batch, sizeof(batch));
    constants.flush();
    const std::uint32_t groups = (batch.ray_count + kGroup - 1) / kGroup;
    timer.reset();
    run_commands(device_, [&](VkCommandBuffer commands) {
      pipeline_.bind(commands, nullptr, {constants.address()});
      timer.begin(commands, 0);
      vkCmdDispatch(commands, (groups + interleave_ - 1) / interleave_ * interleave_, 1, 1);
      timer.end(commands, 0);
      timer.bring(commands);  // makes the answers visible, too
    });
    const GpuInterval interval = timer.read(0, clock);
    result.device_ns += interval.end_ns - interval.begin_ns;
    answer_buffer.invalidate();
    const auto done = answer_buffer.mapped_as<BatchAnswer>();
    answers.insert(answers.end(), done.begin(), done.begin() + static_cast<std::ptrdiff_t>(part.size()));
  }
  return result;
}

}  // namespace probewalk
