// trace.json: the frames as Chrome trace events, for Perfetto (https://ui.perfetto.dev) and chrome://tracing.
#pragma once

#include <string>

#include "xr/latency/ledger.h"

namespace probewalk {

// Tracks: runtime and CPU calls, device passes, mirror; counters of streaming; a mark for each missed or discarded
// frame. Device passes are left out when their clock was not calibrated: they cannot be placed.
std::string trace_json(const Ledger& ledger);

}  // namespace probewalk
