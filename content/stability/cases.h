// The hard cases, by name: kinds of rays that have broken tracers, each at the places where it bites.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "content/stability/low_discrepancy.h"
#include "content/stability/places.h"
#include "content/stability/walk.h"

namespace probewalk::stability {

struct HardCase {
  std::string name;
  PlaceId place;
  std::string says;     // what is hard about it, one sentence
  double weight = 1.0;  // its share of the rays
  // Numbers that are none: no reference has an answer; what counts is that the walk ends and says nothing but
  // "unknown".
  bool hostile = false;
  // The ray runs exactly straight away from the probe: one look-up tells its answer (thesis 4.3).
  bool one_lookup = false;
  std::function<Ray(Random&, const Place&)> ray;
};

// Ordered by place.
std::vector<HardCase> hard_cases();

}  // namespace probewalk::stability
