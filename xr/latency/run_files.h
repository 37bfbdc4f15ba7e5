// The files of a run's report directory, each written whole or not at all:
//   frames.csv    one row a frame: every time point, every derived quantity
//   summary.json  the contract of `walk --report`
//   trace.json    Chrome trace events; opens in Perfetto
//   index.html    the page, self-contained
#pragma once

#include <filesystem>

#include "xr/latency/run.h"

namespace probewalk {

// Makes the directory a run is written to, if need be. Throws BadInput when nothing can be written there.
void make_run_folder(const std::filesystem::path& directory);
// Makes the directory when it is not there. Throws BadInput naming the file that cannot be written and why.
void write_run(const std::filesystem::path& directory, const Ledger& ledger, const RunInfo& info);

// A run from its frames.csv and summary.json; everything derived is derived anew. Throws BadInput naming the file and
// the line or key that cannot be used.
Run read_run(const std::filesystem::path& directory);

}  // namespace probewalk
