// Enter and leave of a piece of work on the one clock.
#pragma once

#include "xr/latency/clock.h"
#include "xr/latency/frame_record.h"

namespace probewalk {

template <typename Work>
Interval timed(const Work& work) {
  Interval interval;
  interval.begin = now_ns();
  work();
  interval.end = now_ns();
  return interval;
}

}  // namespace probewalk
