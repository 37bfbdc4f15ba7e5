// The page's pictures: what a method costs against how wrong it is.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/probewalk/bench/bench_row.h"

namespace probewalk::bench {

enum class Cost { kTime, kLookups };
enum class ErrorKind { kMedian, kFailed, kFlip };

// Both axes logarithmic; sizes of one method are joined, the front of all is dashed. An error of 0 stands at the left edge.
// Empty when no row has that error.
std::string pareto_svg(const std::vector<BenchRow>& rows, Cost cost, ErrorKind error);

// The colours and marks of the methods that the rows have.
std::string legend_html(const std::vector<BenchRow>& rows);

// What the charts add to the style of the reports.
extern const char* const kBenchStyle;

}  // namespace probewalk::bench
