// What `report --json` says of several runs.
#pragma once

#include <nlohmann/json.hpp>
#include <span>

#include "xr/latency/comparison.h"

namespace probewalk {

nlohmann::ordered_json comparison_json(std::span<const Run> runs, const Comparison& comparison);

}  // namespace probewalk
