#include "content/stability/agreement.h"

#include <algorithm>
#include <cmath>

#include "content/stability/low_discrepancy.h"

namespace probewalk::stability {

double distance_error(const Answer& answer, const Answer& reference, double scale_m) {
  return std::abs(answer.t - reference.t) / std::max(kSmallest * scale_m, std::abs(reference.t));
}

bool same_answer(const Answer& answer, const Answer& reference, double scale_m) {
  return answer.cls == reference.cls &&
         (answer.cls == kClassMiss || distance_error(answer, reference, scale_m) < kSameDistance);
}

bool is_tie(const Reference& reference, glm::dvec3 x, glm::dvec3 d, double t_start, const Answer& answer,
            double scale_m, double tie) {
  // A float's place is as uncertain as it is far away: beyond ten times the place's size that is what counts.
  const double reach = tie * std::max(scale_m, 0.1 * glm::length(x)), speed = glm::length(d);
  constexpr int kBeside = 32;
  for (int k = 0; k < kBeside; ++k) {
    const glm::dvec3 moved = x + reach * hammersley_direction(k, kBeside);
    const glm::dvec3 turned = d + tie * speed * hammersley_direction((k * 13) % kBeside, kBeside);
    if (same_answer(answer, reference(moved, turned, t_start), scale_m)) return true;
  }
  const Answer own = reference(x, d, t_start);
  if (own.cls != kClassMiss) {
    const double behind = own.t + std::max(reach / speed, tie * own.t);
    if (same_answer(answer, reference(x, d, behind), scale_m)) return true;
  }
  // Few rays need the closer look, at all distances: along a line of the grid the other answer may take one ray in a
  // thousand of those beside. Much nearer than floats resolve there is nothing to be found.
  constexpr int kCloser = 1 << 15;
  constexpr double kResolved = 1e-8;
  Random random(1);
  for (int k = 0; k < kCloser && tie > kResolved; ++k) {
    const glm::dvec3 moved = x + reach * random() * random.direction();
    const glm::dvec3 turned = d + tie * speed * random() * random.direction();
    if (same_answer(answer, reference(moved, turned, t_start), scale_m)) return true;
  }
  if (answer.cls == kClassMiss) return false;
  // From one side of the ray to the other in small steps: does the distance run through the contender's without a jump?
  for (int k = 0; k < kBeside; ++k) {
    const glm::dvec3 offset = reach * hammersley_direction(k, kBeside);
    const glm::dvec3 turn = tie * speed * hammersley_direction((k * 13) % kBeside, kBeside);
    constexpr int kSteps = 16;
    Answer before = reference(x - offset, d - turn, t_start);
    for (int step = 1; step <= kSteps; ++step) {
      const double side = 2.0 * step / kSteps - 1.0;
      const Answer here = reference(x + side * offset, d + side * turn, t_start);
      const bool between = (before.t - answer.t) * (here.t - answer.t) <= 0.0;
      const bool of_class = before.cls == answer.cls && here.cls == answer.cls;
      const bool same_surface = glm::length(before.plane - here.plane) <= 1e-3 * glm::length(here.plane);
      if (of_class && same_surface && between) return true;
      before = here;
    }
  }
  return false;
}

}  // namespace probewalk::stability
