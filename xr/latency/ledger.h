// The books of one run: takes the time points of every frame and derives what the report states. Pure: numbers in,
// numbers out. The definitions are those of `quantity_definitions()`, which every report prints.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "xr/latency/frame_record.h"
#include "xr/latency/histogram.h"
#include "xr/latency/run_info.h"
#include "xr/latency/worst_frames.h"

namespace probewalk {

struct LedgerOptions {
  // The first frames of the run: kept, counted, written to frames.csv, left out of every statistic.
  std::uint64_t warmup_frames = 0;
  // False for a display without deadlines (offscreen on a fixed clock): its predicted display times are no moments of
  // the real clock, so prediction horizon, deadline margin and missed frames do not exist.
  bool has_deadlines = true;
};

// What is derived from one frame and the one before it. Empty = the display lacks it, or it was not measured.
struct FrameQuantities {
  std::optional<std::int64_t> frame_ns;               // wait_end(n) - wait_end(n-1)
  std::optional<std::int64_t> cpu_wait_ns;            // of the frame thread
  std::optional<std::int64_t> cpu_busy_ns;            // wait_end to end_end less time blocked; rendered frames only
  std::optional<std::int64_t> gpu_busy_ns;            // gpu_begin to gpu_end
  std::optional<std::int64_t> gpu_trace_ns;           // the trace pass
  std::optional<std::int64_t> prediction_horizon_ns;  // predicted_display - end of the locate that gave the pose used
  std::optional<std::int64_t> deadline_margin_ns;     // (predicted_display - period) - gpu_end
  std::optional<double> pose_error_mm;
  std::optional<double> pose_error_deg;
  std::uint32_t missed = 0;           // refreshes between the frame before and this one that no frame was made for
  std::optional<bool> within_budget;  // cpu_busy and gpu_busy both <= period
};
// `previous` is null for the first frame that counts.
FrameQuantities derive(const FrameRecord& frame, const FrameRecord* previous, bool has_deadlines);

// One quantity over the run. The histogram holds integers: a value in `unit` is one of them divided by `scale`.
struct QuantitySummary {
  std::string name;  // key in summary.json: "frame", "cpu_busy", ..., "pose_error_mm"
  std::string unit;  // of the values in summary.json: "ns", "mm", "deg"
  double scale = 1.0;
  Histogram histogram;
};

struct Summary {
  std::uint64_t frames = 0;                                // without warm-up
  std::uint64_t warmup_frames = 0;                         // frames + warmup_frames = frames added
  std::int64_t period_ns = 0;                              // median
  std::array<std::uint64_t, kPoseAnswers> pose_answers{};  // frames by PoseAnswer
  std::uint64_t early_pose_frames = 0;                     // shown with the early pose: the late one was not valid
  std::uint64_t missed = 0;
  std::uint64_t discarded = 0;
  std::uint64_t not_rendered = 0;
  std::uint64_t stale_run_max = 0;  // consecutive refreshes without a new frame
  std::optional<double> within_budget_fraction;
  std::optional<std::int64_t> clock_error_ns;  // largest; empty = device clock not calibrated
  std::vector<QuantitySummary> quantities;     // in the order of quantity_definitions()
  std::vector<WorstFrame> worst;               // at most ten, longest first
  // Scale of the eyes' sides over the rendered frames; empty = none was rendered.
  std::optional<double> eye_scale_min, eye_scale_mean;
  // Streaming. Bytes count the whole run, warm-up included.
  std::uint64_t bytes_uploaded = 0;
  std::uint64_t device_bytes_max = 0;
  std::optional<double> coarse_frame_fraction;  // level_shown < level_wanted, nothing shown included
  std::uint64_t coarse_run_max = 0;             // the most such frames after one another
  std::uint64_t coarse_run_first = 0;           // frame_id of the first of these
  std::int64_t coarse_run_max_ns = 0;           // the longest time that such frames were shown without a break
  std::optional<std::int64_t> frame_thread_p99_ns;

  const QuantitySummary& quantity(std::string_view name) const;
};

class Ledger {
 public:
  explicit Ledger(LedgerOptions options = {}) : options_(options) {}
  // Frames in the order of their waits.
  void add(const FrameRecord& frame) { frames_.push_back(frame); }
  const std::vector<FrameRecord>& frames() const { return frames_; }
  // Index of the first frame that counts.
  std::size_t first_counted() const;
  const LedgerOptions& options() const { return options_; }
  Summary summary() const;

 private:
  LedgerOptions options_;
  std::vector<FrameRecord> frames_;
};

// How long rooms and levels took from first wanted to first drawable: of every one that was waited for, and in short.
Histogram need_to_resident_histogram(const StreamingFacts& facts);
struct NeedToResident {
  std::uint64_t count = 0;
  std::optional<std::int64_t> p50_ns, p99_ns;
};
NeedToResident need_to_resident(const StreamingFacts& facts);

// What each quantity means, in the words that reports print. The order is that of every table.
struct QuantityDefinition {
  const char* name;
  const char* unit;
  const char* text;
};
std::span<const QuantityDefinition> quantity_definitions();

}  // namespace probewalk
