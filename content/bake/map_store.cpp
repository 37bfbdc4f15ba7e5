#include "content/bake/map_store.h"

#include <chrono>
#include <optional>
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

ProbeGeometry MapStore::geometry(glm::dvec3 position_m, int n, MapInputs* inputs) {
  MapInputs own;
  std::optional<ProbeGeometry> map = state_.load_geometry(position_m, n, own);
  if (!map) {
    const Stopwatch watch(baking_seconds_);
    InputRecorder recorder(cells_, rays_, nullptr);
    map = bake_geometry(rays_, position_m, n, &rays_cast_);
    own = recorder.take();
    state_.store(*map, own);
  }
  if (inputs) inputs->join(own);
  return std::move(*map);
}

ProbeRadiance MapStore::radiance(glm::dvec3 position_m, int r, MapInputs* inputs) {
  MapInputs own;
  std::optional<ProbeRadiance> map = state_.load_radiance(position_m, r, own);
  if (!map) {
    const Stopwatch watch(baking_seconds_);
    InputRecorder recorder(cells_, rays_, &light_);
    map = bake_radiance(rays_, light_, position_m, r, radiance_scale_, &rays_cast_);
    own = recorder.take();
    baked_texels_ += std::uint64_t(r) * r;
    state_.store(position_m, *map, own);
  }
  if (inputs) inputs->join(own);
  return std::move(*map);
}

}  // namespace probewalk
