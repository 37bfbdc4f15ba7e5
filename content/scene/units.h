// Which unit a scene is in, and whether y is up (design: rooms, steps 1 and 2).
#pragma once

#include <optional>
#include <string>

#include "content/scene/scene.h"

namespace probewalk {

struct UnitGuess {
  double scale = 1.0;                   // metres per file unit
  std::string statement;                // one sentence: the scale and why
  std::optional<std::string> warning;   // when it cannot be told or looks wrong
};

// `scene` is in file units, its bounds set. The guess rests on the extent and, where that is implausible for metres, on
// the height between floors and ceilings, measured with vertical rays from fixed points.
UnitGuess guess_unit(const Scene& scene);

// A warning when surfaces suggest that another axis than y points up. Nothing is turned.
std::optional<std::string> check_up_axis(const Scene& scene);

}  // namespace probewalk
