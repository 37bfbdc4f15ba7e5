// What the page says of streaming: was what the wearer saw as fine as wanted, how long did it take to be, what did it
// cost, and what went wrong on the way.
#pragma once

#include <string>

#include "xr/latency/ledger.h"
#include "xr/latency/run.h"
#include "xr/latency/run_info.h"

namespace probewalk {

// "64.0 MiB", or what held the rooms within bounds where nothing was stated.
std::string budget_in_words(const StreamingFacts& facts);

// Empty when the run has no levels to speak of: nothing was streamed.
std::string streaming_section(const Run& run, const Summary& summary);

}  // namespace probewalk
