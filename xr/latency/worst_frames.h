// The longest frames of a run, and what made each long: the stage that took most more than it usually does.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "xr/latency/frame_record.h"

namespace probewalk {

struct WorstFrame {
  std::uint64_t frame_id = 0;
  std::size_t index = 0;      // in the frames given
  std::int64_t frame_ns = 0;  // wait_end(n) - wait_end(n-1): filled by the work of the frame before and by this wait
  std::optional<std::int64_t> cpu_busy_ns, gpu_busy_ns;  // of the frame before
  std::uint32_t missed = 0;
  std::string stage;           // "record", "gpu_trace", "wait", "streaming", ...; empty when none stands out
  std::int64_t excess_ns = 0;  // over that stage's median
  std::string cause;           // in words: the stage, and upload, room switch or pipeline build where there was one
};

// At most `count`, longest first. `first` is the index of the first frame that counts.
std::vector<WorstFrame> worst_frames(std::span<const FrameRecord> frames, std::size_t first, bool has_deadlines,
                                     std::size_t count = 10);

}  // namespace probewalk
