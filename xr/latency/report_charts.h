// The pictures of the page, as inline SVG coloured by the page's style (light and dark).
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "xr/latency/ledger.h"
#include "xr/latency/run.h"

namespace probewalk {

// What all runs of a page share, so that their pictures can be compared by eye. Nanoseconds.
struct ChartScale {
  std::int64_t timeline_max_ns = 0;
  std::int64_t histogram_max_ns = 0;
};
ChartScale chart_scale(std::span<const Run> runs, std::span<const Summary> summaries);

// Frame time, CPU and device work over the run; the budget; missed and discarded frames; warm-up shaded. Long runs are
// drawn as the largest value of each column.
std::string timeline_svg(const Ledger& ledger, const Summary& summary, const ChartScale& scale);

// How often each length of a quantity came up, counts on a logarithmic axis so that single frames stay visible.
std::string histogram_svg(const QuantitySummary& quantity, std::int64_t period_ns, const ChartScale& scale);

}  // namespace probewalk
