// One ray against one probe, the way every contender is given it, and what each of them says.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

#include "content/probe/brute_force.h"
#include "shaders/shared/probe_layout.h"

namespace probewalk::stability {

inline constexpr int kClassBehind = 3;  // a walk's own answer: the start lies behind the probe's surface
inline constexpr int kClasses = 4;
const char* class_name(int cls);  // "hit", "miss", "unknown", "behind"

// In the world's coordinates, as the device gets it: a float and what its rounding left.
struct Ray {
  glm::vec3 origin_hi_m{0.0f};
  glm::vec3 origin_lo_m{0.0f};
  glm::vec3 direction{0.0f};
  float t_start = 0.0f;  // in units of the direction
};

struct Answer {
  int cls = kClassUnknown;
  double t = 0.0;  // 1e30 of a miss
  double t_safe = 0.0;
  glm::dvec3 plane{0.0};
  std::uint32_t lookups = 0;

  bool is_finite() const { return std::isfinite(t + t_safe + plane.x + plane.y + plane.z); }
  // Equal but for the look-ups it took.
  bool same_bits(const Answer& other) const {
    return cls == other.cls && t == other.t && t_safe == other.t_safe && plane == other.plane;
  }
};

// The ray's origin relative to the probe without rounding.
glm::dvec3 exact_origin(const ProbeRecord& probe, const Ray& ray);

// Pyramid level of the first look-up: 0 = cell by cell; with kWithoutPlanes added, planar entries are gone through cell
// by cell, too, for the very answers of cell by cell.
Answer walk_in_float(const ProbeRecord& probe, const Ray& ray, int start_level);
Answer walk_in_double(const ProbeRecord& probe, glm::dvec3 x, glm::dvec3 d, double t_start, int start_level);
Answer from_brute_force(const BruteAnswer& answer);

// More look-ups than this no walk can take: at most four octants, in each at most a step for every line of its grid,
// and before each step at most a descent through all levels and the look at a plane (shaders/shared/tracer_walk.h).
std::uint32_t most_lookups(const ProbeRecord& probe, int start_level);

}  // namespace probewalk::stability
