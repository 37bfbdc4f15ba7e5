#include "content/stability/walk.h"

#include <algorithm>

#include "content/probe/tracer_f32.h"
#include "content/probe/tracer_f64.h"

namespace probewalk::stability {

const char* class_name(int cls) {
  static constexpr const char* kNames[kClasses] = {"hit", "miss", "unknown", "behind"};
  return cls >= 0 && cls < kClasses ? kNames[cls] : "none";
}

glm::dvec3 exact_origin(const ProbeRecord& probe, const Ray& ray) {
  return (glm::dvec3(ray.origin_hi_m) - glm::dvec3(probe.position_hi_m)) +
         (glm::dvec3(ray.origin_lo_m) - glm::dvec3(probe.position_lo_m));
}

Answer walk_in_float(const ProbeRecord& probe, const Ray& ray, int start_level) {
  const glm::vec3 x = f32::relative_origin(probe, ray.origin_hi_m, ray.origin_lo_m);
  const f32::WalkState s = f32::walk_probe(probe, x, ray.direction, ray.t_start, start_level);
  return {s.status, s.t, s.t_safe, glm::dvec3(s.plane), s.lookups};
}

Answer walk_in_double(const ProbeRecord& probe, glm::dvec3 x, glm::dvec3 d, double t_start, int start_level) {
  const f64::WalkState s = f64::walk_probe(probe, x, d, t_start, start_level);
  return {s.status, s.t, s.t_safe, s.plane, s.lookups};
}

Answer from_brute_force(const BruteAnswer& answer) {
  switch (answer.cls) {
    case BruteAnswer::Class::kHit:
      return {kClassHit, answer.t, answer.t, answer.plane, 0};
    case BruteAnswer::Class::kMiss:
      return {kClassMiss, 1e30, answer.t, {}, 0};
    case BruteAnswer::Class::kUnknown:
      return {kClassUnknown, answer.t, answer.t, answer.plane, 0};
    case BruteAnswer::Class::kBehind:
      return {kClassBehind, answer.t, answer.t, answer.plane, 0};
  }
  return {};
}

std::uint32_t most_lookups(const ProbeRecord& probe, int start_level) {
  const std::uint32_t n = 1u << probe.n_log2;
  const auto top =
      static_cast<std::uint32_t>(std::clamp(start_level % kWithoutPlanes, 0, static_cast<int>(probe.n_log2) - 1));
  return 4 * (n + 1) * (top + 2);
}

}  // namespace probewalk::stability
