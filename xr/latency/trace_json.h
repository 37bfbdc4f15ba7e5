// trace.json: the frames as Chrome trace events, for Perfetto (https://ui.perfetto.dev) and chrome://tracing.
#pragma once

#include <string>

#include "xr/latency/ledger.h"
#include "xr/latency/run_info.h"

namespace probewalk {

// Tracks: frames with their runtime and CPU calls, device passes, mirror, each loader thread with the rooms' levels it
// brought; counters of streaming; a mark for each missed or discarded frame. Spans of one track nest or follow one
// another. Device passes are left out when their clock was not calibrated: they cannot be placed.
std::string trace_json(const Ledger& ledger, const StreamingFacts& streaming = {});

}  // namespace probewalk
