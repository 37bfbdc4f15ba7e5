// frames.csv: a header, then one row a frame. Time points are CLOCK_MONOTONIC nanoseconds, 0 = did not happen; derived
// columns end in their unit and are empty where the quantity does not exist.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "xr/latency/ledger.h"

namespace probewalk {

std::string frames_csv(const Ledger& ledger);

// The time points back; columns are found by name, unknown ones ignored. Throws BadInput naming `file` and the line.
std::vector<FrameRecord> parse_frames_csv(std::string_view text, const std::string& file);

}  // namespace probewalk
