#include "tools/probewalk/stability_device.h"

#include <fmt/format.h>

namespace probewalk {

std::vector<stability::Answer> StabilityDevice::walk(const stability::Place& place,
                                                     std::span<const stability::Ray> rays) {
  const std::string name = fmt::format("{} {}", place.name, place.geometry.n);
  if (place_ != name) {
    batch_.set_probe(place.device);
    place_ = name;
  }
  rays_.clear();
  for (const stability::Ray& ray : rays) {
    rays_.push_back({ray.origin_hi_m, ray.t_start, ray.origin_lo_m, 0.0f, ray.direction, 0.0f});
  }
  std::vector<stability::Answer> answers;
  answers.reserve(rays.size());
  for (const WalkEnd& end : batch_.walk(rays_, kStartLevel)) {
    answers.push_back({end.status, end.t, end.t_safe, glm::dvec3(end.plane), end.lookups});
  }
  return answers;
}

}  // namespace probewalk
