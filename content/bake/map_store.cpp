#include "content/bake/map_store.h"

#include <chrono>
#include <utility>

namespace probewalk {
namespace {

class Stopwatch {
 public:
  explicit Stopwatch(double& seconds) : seconds_(seconds) {}
  ~Stopwatch() { seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

ProbeGeometry MapStore::geometry(glm::dvec3 position_m, int n) {
  if (std::optional<ProbeGeometry> kept = state_.load_geometry(position_m, n)) return std::move(*kept);
  const Stopwatch watch(baking_seconds_);
  ProbeGeometry map = bake_geometry(rays_, position_m, n, &rays_cast_);
  state_.store(map);
  return map;
}

ProbeRadiance MapStore::radiance(glm::dvec3 position_m, int r) {
  if (std::optional<ProbeRadiance> kept = state_.load_radiance(position_m, r)) return std::move(*kept);
  const Stopwatch watch(baking_seconds_);
  ProbeRadiance map = bake_radiance(rays_, light_, position_m, r, radiance_scale_, &rays_cast_);
  baked_texels_ += std::uint64_t(r) * r;
  state_.store(position_m, map);
  return map;
}

}  // namespace probewalk
