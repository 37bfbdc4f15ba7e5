// results.json, results.csv and index.html in the output folder; each appears whole or not at all.
#pragma once

#include "tools/probewalk/bench/bench_summary.h"

namespace probewalk::bench {

std::vector<BenchRow> rows_of(const BenchSummary& summary);

// Throws BadInput when they cannot be written.
void write_bench_files(const BenchSummary& summary);

}  // namespace probewalk::bench
