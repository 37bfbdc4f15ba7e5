// What the marches' tests share: the marches by name, their rules, and rays in a box of a room.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "content/baseline/march_instance.h"
#include "support/low_discrepancy.h"

namespace probewalk::test {

using march32::MarchRules;
using march32::WalkState;

inline constexpr float kFar_m = 50.0f;

inline MarchRules plain_rules(float epsilon_m = 0.05f) {
  return {.epsilon_rule = kEpsilonFixed,
          .reject_backfaces = false,
          .backward_trace = false,
          .epsilon_m = epsilon_m,
          .step_m = 0.01f,
          .farthest_m = kFar_m,
          .max_steps = 100000};
}

struct Ray {
  glm::vec3 x;  // relative to the probe
  glm::vec3 d;
};

using March = std::function<WalkState(const BaselineRecord&, const MarchRules&, const Ray&, float)>;

struct NamedMarch {
  std::string name;
  March march;
};

inline WalkState flat(const BaselineRecord& map, const MarchRules& rules, const Ray& ray, float t_start = 0) {
  return march32::march_2d(map, rules, ray.x, ray.d, t_start, false);
}
inline WalkState hierarchical(const BaselineRecord& map, const MarchRules& rules, const Ray& ray, float t_start = 0) {
  return march32::march_2d(map, rules, ray.x, ray.d, t_start, true);
}
inline WalkState two_level(const BaselineRecord& map, const MarchRules& rules, const Ray& ray, float t_start = 0) {
  return march32::march_two_level(map, rules, ray.x, ray.d, t_start);
}
inline WalkState steps(const BaselineRecord& map, const MarchRules& rules, const Ray& ray, float t_start = 0) {
  return march32::march_3d(map, rules, ray.x, ray.d, t_start);
}

inline std::vector<NamedMarch> marches() {
  return {{"march-2d", flat}, {"march-2d-hierarchical", hierarchical}, {"two-level", two_level}, {"march-3d", steps}};
}

inline const glm::dvec3 kLow(-3, -1.5, -2), kHigh(3, 1.5, 2);

inline Ray room_ray(Random& random, glm::dvec3 probe) {
  const glm::dvec3 from(random(-2.9, 2.9), random(-1.4, 1.4), random(-1.9, 1.9));
  return {glm::vec3(from - probe), glm::vec3(random.direction())};
}

}  // namespace probewalk::test
