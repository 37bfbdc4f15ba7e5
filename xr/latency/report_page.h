// The report as one HTML file that needs nothing else: timeline, histogram, percentiles, worst frames, machine,
// definitions, what is not measured. One run, or several side by side.
#pragma once

#include <span>
#include <string>

#include "xr/latency/run.h"

namespace probewalk {

std::string report_page(std::span<const Run> runs);

}  // namespace probewalk
