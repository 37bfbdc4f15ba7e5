// summary.json: the contract of `walk --report`. Keys are only ever added.
#pragma once

#include <string>
#include <string_view>

#include "xr/latency/ledger.h"
#include "xr/latency/run_info.h"

namespace probewalk {

constexpr int kSummarySchema = 1;

std::string summary_json(const Ledger& ledger, const RunInfo& info);

struct SummaryHead {
  RunInfo info;
  LedgerOptions options;
};
// What frames.csv does not say. Missing keys leave their defaults; a wrong type or another schema throws BadInput
// naming `file` and the key.
SummaryHead parse_summary_json(std::string_view text, const std::string& file);

}  // namespace probewalk
