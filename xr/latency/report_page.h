// The report as one HTML file that needs nothing else: timeline, histogram, percentiles, worst frames, machine,
// definitions, what is not measured. One run, or several and how they compare.
#pragma once

#include <span>
#include <string>

#include "xr/latency/comparison.h"
#include "xr/latency/run.h"

namespace probewalk {

// `comparison`: of these runs, where there is more than one.
std::string report_page(std::span<const Run> runs, const Comparison& comparison = {});

}  // namespace probewalk
