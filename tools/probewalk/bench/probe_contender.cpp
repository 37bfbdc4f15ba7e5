#include "tools/probewalk/bench/probe_contender.h"

#include <tbb/parallel_for.h>

#include <chrono>

#include "content/baseline/host_tracer.h"

namespace probewalk::bench {
namespace {

class HostContender final : public Contender {
 public:
  HostContender(const PackLevel& level, const BaselineMaps* maps, const TraceConstants& dials, const TracerChoice& choice)
      : level_(level), tracer_(level.probes(), dials, choice, maps) {}

  TraceRun trace(const ViewRays& rays) override {
    TraceRun run;
    run.answers.resize(rays.rays.size());
    const auto begin = std::chrono::steady_clock::now();
    tbb::parallel_for(std::size_t{0}, rays.rays.size(), [&](std::size_t k) {
      run.answers[k] = tracer_.trace(rays.rays[k].origin_m, rays.rays[k].direction, rays.spread_rad);
    });
    run.device_ns = (std::chrono::steady_clock::now() - begin) / std::chrono::nanoseconds(1);
    return run;
  }

  std::uint64_t bytes_device() const override { return level_.store().device_bytes(); }

 private:
  const PackLevel& level_;
  HostTracer tracer_;
};

}  // namespace

std::unique_ptr<Contender> make_probe_contender(const Device&, const PackLevel& level, const BaselineMaps* maps,
                                                const TraceConstants& dials, const TracerChoice& choice) {
  return std::make_unique<HostContender>(level, maps, dials, choice);
}

}  // namespace probewalk::bench
