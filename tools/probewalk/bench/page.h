// The page: one HTML file, with the pictures of the worst views beside it.
#pragma once

#include <string>

#include "tools/probewalk/bench/bench_summary.h"

namespace probewalk::bench {

std::string bench_page(const BenchSummary& summary);

}  // namespace probewalk::bench
