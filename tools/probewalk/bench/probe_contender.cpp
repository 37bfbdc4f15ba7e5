#include "tools/probewalk/bench/probe_contender.h"

#include "content/probe/device_probe.h"
#include "render/baseline_store.h"
#include "render/ray_batch.h"
#include "render/tracer_choice.h"

namespace probewalk::bench {
namespace {

std::uint64_t radiance_bytes(const ProbeSet& probes) {
  std::uint64_t bytes = 0;
  for (const DeviceProbe& probe : probes.probes()) bytes += device_block_bytes(probe.radiance);
  return bytes;
}

class ProbeContender final : public Contender {
 public:
  ProbeContender(const Device& device, const PackLevel& level, const BaselineMaps* maps, const TraceConstants& dials,
                 const TracerChoice& choice)
      : level_(level),
        choice_(choice),
        dials_(dials),
        baselines_(choice.needs_maps() ? std::make_unique<BaselineStore>(device, *maps, choice) : nullptr),
        batch_(device, {choice, baselines_.get()}) {}

  TraceRun trace(const ViewRays& rays) override {
    TracedRays traced = batch_.trace_timed(level_.store(), dials_, rays.rays, rays.spread_rad);
    return {std::move(traced.answers), traced.device_ns};
  }

  // The baselines read the probes' radiance, but not their geometry.
  std::uint64_t bytes_device() const override {
    if (!choice_.is_baseline()) return level_.store().device_bytes();
    return radiance_bytes(level_.probes()) + (baselines_ ? baselines_->device_bytes() : 0);
  }

 private:
  const PackLevel& level_;
  const TracerChoice choice_;
  const TraceConstants dials_;
  std::unique_ptr<BaselineStore> baselines_;
  RayBatch batch_;
};

}  // namespace

std::unique_ptr<Contender> make_probe_contender(const Device& device, const PackLevel& level, const BaselineMaps* maps,
                                                const TraceConstants& dials, const TracerChoice& choice) {
  return std::make_unique<ProbeContender>(device, level, maps, dials, choice);
}

}  // namespace probewalk::bench
