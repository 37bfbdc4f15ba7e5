// A run on an invented clock: every time point known, every answer computable by hand.
#pragma once

#include "xr/latency/ledger.h"

namespace probewalk {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kPeriod = 10 * kMs;

// Frame i of a display at 100 Hz: wakes at 10 i ms, is busy for 5 ms of which 1 ms blocked, draws for 4 ms.
//   wait 2 | begin 0.25 | early 0.25 | record 2 | late 0.25 | submit 1.25 | end 1   (ms)
inline FrameRecord synthetic_frame(std::uint64_t i) {
  const std::int64_t start = 1'000 * kMs + static_cast<std::int64_t>(i) * kPeriod;
  FrameRecord f;
  f.frame_id = i;
  std::int64_t t = start - 2 * kMs;
  const auto take = [&t](std::int64_t duration) {
    const Interval interval{t, t + duration};
    t += duration;
    return interval;
  };
  f.wait = take(2 * kMs);
  f.begin = take(kMs / 4);
  f.locate_early = take(kMs / 4);
  f.record = take(2 * kMs);
  f.locate_late = take(kMs / 4);
  f.submit = take(5 * kMs / 4);
  f.end = take(kMs);
  f.ledger = take(kMs / 10);
  f.blocked_ns = kMs;
  f.process_cpu_ns = static_cast<std::int64_t>(i) * 6 * kMs;
  f.gpu = {start + 3 * kMs, start + 7 * kMs};
  f.gpu_trace = {start + 3 * kMs, start + 6 * kMs};
  f.gpu_resolve = {start + 6 * kMs, start + 7 * kMs};
  f.clock_calibrated = true;
  f.clock_deviation_ns = 20;
  f.predicted_display = start + 25 * kMs;
  f.period = kPeriod;
  f.room = 0;
  f.level_shown = 1;
  f.level_wanted = 1;
  return f;
}

// Moves everything of a frame later.
inline void delay(FrameRecord& f, std::int64_t by) {
  for (Interval* interval : {&f.wait, &f.begin, &f.locate_early, &f.record, &f.locate_late, &f.submit, &f.end,
                             &f.ledger, &f.gpu, &f.gpu_trace, &f.gpu_resolve, &f.mirror}) {
    if (interval->begin != 0) interval->begin += by;
    if (interval->end != 0) interval->end += by;
  }
  f.predicted_display += by;
}

}  // namespace probewalk
