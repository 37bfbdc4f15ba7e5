// What the page of several runs says before it shows each: what was compared, whether it can be, what changed.
#pragma once

#include <span>
#include <string>

#include "xr/latency/comparison.h"

namespace probewalk {

std::string comparison_html(std::span<const Run> runs, const Comparison& comparison);

// The changes of one quantity's percentiles as bars of their intervals about "no change", for each later group.
std::string change_svg(const GroupComparison& pair, const std::string& base, const std::string& other);

}  // namespace probewalk
