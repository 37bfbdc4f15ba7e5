// The files of a run's report directory, each written whole or not at all:
//   frames.csv    one row a frame: every time point, every derived quantity
//   summary.json  the contract of `walk --report`
//   trace.json    Chrome trace events; opens in Perfetto
//   index.html    the page, self-contained
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "xr/latency/ledger.h"
#include "xr/latency/run_info.h"

namespace probewalk {

// Makes the directory when it is not there. Throws BadUsage when it cannot be written.
void write_run(const std::filesystem::path& directory, const Ledger& ledger, const RunInfo& info);

// A run as read back from its directory; the summary is derived anew from the frames.
struct Run {
  std::string name;  // of the directory
  RunInfo info;
  Ledger ledger;
};
// Throws BadInput naming the file and the line or key that cannot be used.
Run read_run(const std::filesystem::path& directory);

// Each alone, for tests and for other writers.
std::string frames_csv(const Ledger& ledger);
std::string summary_json(const Ledger& ledger, const RunInfo& info);
std::string trace_json(const Ledger& ledger);

}  // namespace probewalk
