// When two answers to one ray are the same, and when their difference is a tie.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "content/probe/brute_force.h"
#include "shaders/shared/probe_layout.h"
#include "support/low_discrepancy.h"

namespace probewalk::test {

inline constexpr int kClassBehind = 3;  // a walk's own answer: the start lies behind the surface

inline bool same_class(int cls, BruteAnswer::Class brute) {
  switch (brute) {
    case BruteAnswer::Class::kHit: return cls == kClassHit;
    case BruteAnswer::Class::kMiss: return cls == kClassMiss;
    case BruteAnswer::Class::kUnknown: return cls == kClassUnknown;
    case BruteAnswer::Class::kBehind: return cls == kClassBehind;
  }
  return false;
}

// Same class, and the same distance but for conditioning.
inline bool same_answer(int cls, double t, const BruteAnswer& expected) {
  return same_class(cls, expected.cls) &&
         (cls == kClassMiss || std::abs(t - expected.t) < 1e-2 * std::max(1e-3, expected.t));
}

// A difference is a tie where brute force gives the tracer's answer for a ray `tie_m` beside: there the answer jumps
// (an edge shared by two surfaces, a wall's rim), and the sides of the jump are told apart by rounding alone.
inline bool is_tie(const BruteForceProbe& brute, glm::dvec3 x, glm::dvec3 d, double t_start, int cls, double t,
                   double tie_m) {
  for (int k = 0; k < 32; ++k) {
    const glm::dvec3 beside = tie_m * hammersley_direction(k, 32),
                     turned = tie_m * hammersley_direction((k * 13) % 32, 32);
    if (same_answer(cls, t, brute.trace(x + beside, d + turned, t_start))) return true;
  }
  return false;
}

}  // namespace probewalk::test
