// How long each stage of a frame took: worked out from the frame's time points alone, beside what the ledger makes of
// them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "xr/latency/frame_record.h"

namespace probewalk::test {

inline std::int64_t length(const Interval& interval) {
  return interval.end - interval.begin;
}
inline double ms(std::int64_t ns) {
  return static_cast<double>(ns) * 1e-6;
}

// In nanoseconds, of a frame's work and the wait that follows it.
inline std::map<std::string, std::int64_t> stages_of(const FrameRecord& work, const FrameRecord& next) {
  std::map<std::string, std::int64_t> stages{
      {"begin", length(work.begin)},         {"locate_early", length(work.locate_early)},
      {"record", length(work.record)},       {"locate_late", length(work.locate_late)},
      {"submit", length(work.submit)},       {"end", length(work.end)},
      {"ledger", length(work.ledger)},       {"wait", length(next.wait)},
      {"blocked", work.blocked_ns},          {"streaming", work.streaming_ns},
      {"gpu_trace", length(work.gpu_trace)}, {"gpu_resolve", length(work.gpu_resolve)},
  };
  stages["between_calls"] = next.wait.end - work.wait.end - stages["begin"] - stages["locate_early"] -
                            stages["record"] - stages["locate_late"] - stages["submit"] - stages["end"] -
                            stages["ledger"] - stages["wait"];
  return stages;
}

// `values` are some; p from 0 to 1.
template <typename Value>
Value at_rank(std::vector<Value> values, double p) {
  const auto rank = static_cast<std::ptrdiff_t>(p * static_cast<double>(values.size() - 1) + 0.5);
  std::ranges::nth_element(values, values.begin() + rank);
  return values[static_cast<std::size_t>(rank)];
}
template <typename Value>
Value median(std::vector<Value> values) {
  return at_rank(std::move(values), 0.5);
}

}  // namespace probewalk::test
