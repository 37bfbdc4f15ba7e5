// One run: what took part, and its frames.
#pragma once

#include <string>

#include "xr/latency/ledger.h"
#include "xr/latency/run_info.h"

namespace probewalk {

struct Run {
  std::string name;  // its directory's
  RunInfo info;
  Ledger ledger;
};

}  // namespace probewalk
