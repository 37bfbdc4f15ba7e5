#include "xr/latency/ledger.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace probewalk {
namespace {

constexpr std::array<QuantityDefinition, 9> kDefinitions{{
    {"frame", "ns", "wait_end(n) - wait_end(n-1): from one frame's start to the next one's."},
    {"cpu_busy", "ns",
     "wait_end to end_end, less the time blocked on a swapchain image, on the device or for its queue. The ledger's "
     "own questions come after it. Rendered frames only."},
    {"cpu_wait", "ns",
     "Time that the frame thread stands in its wait for the frame (runtime_wait_begin and _end are those of the "
     "runtime's call, which may be made ahead on a thread of its own)."},
    {"gpu_busy", "ns", "gpu_begin to gpu_end, from device time stamps. Rendered frames only."},
    {"gpu_trace", "ns", "The trace pass alone, from device time stamps."},
    {"prediction_horizon", "ns",
     "predicted_display - locate_late_end: how far ahead the pose used was predicted (locate_early_end where the late "
     "pose was not valid)."},
    {"deadline_margin", "ns",
     "deadline - gpu_end, where deadline = predicted_display - period: the application's convention, not the "
     "compositor's. Negative = late."},
    {"pose_error_mm", "mm",
     "Position: the pose used against the runtime's own answer for the same display time once it has passed. What the "
     "wearer would feel before reprojection."},
    {"pose_error_deg", "deg", "Orientation: the same, as the angle between the two."},
}};

// Pose errors are kept in millionths.
constexpr double kPoseScale = 1e6;

std::optional<std::int64_t> length(const Interval& interval) {
  if (interval.begin == 0 || interval.end == 0) return std::nullopt;
  return interval.end - interval.begin;
}

// Device times may start at an arbitrary zero; only an empty interval did not happen.
std::optional<std::int64_t> device_length(const Interval& interval) {
  if (interval.end <= interval.begin) return std::nullopt;
  return interval.end - interval.begin;
}

std::optional<std::int64_t> scaled(const std::optional<double>& value) {
  if (!value) return std::nullopt;
  return std::llround(std::min(*value, 1e12) * kPoseScale);
}

std::array<std::optional<std::int64_t>, kDefinitions.size()> in_definition_order(const FrameQuantities& q) {
  return {q.frame_ns,           q.cpu_busy_ns,           q.cpu_wait_ns,
          q.gpu_busy_ns,        q.gpu_trace_ns,          q.prediction_horizon_ns,
          q.deadline_margin_ns, scaled(q.pose_error_mm), scaled(q.pose_error_deg)};
}

}  // namespace

std::span<const QuantityDefinition> quantity_definitions() {
  return kDefinitions;
}

FrameQuantities derive(const FrameRecord& frame, const FrameRecord* previous, bool has_deadlines) {
  FrameQuantities q;
  if (previous != nullptr && previous->wait.end != 0 && frame.wait.end != 0) {
    q.frame_ns = frame.wait.end - previous->wait.end;
  }
  q.cpu_wait_ns = length(frame.wait);
  if (frame.should_render && frame.wait.end != 0 && frame.end.end != 0) {
    q.cpu_busy_ns = std::max<std::int64_t>(0, frame.end.end - frame.wait.end - frame.blocked_ns);
  }
  if (frame.should_render) q.gpu_busy_ns = device_length(frame.gpu);
  q.gpu_trace_ns = device_length(frame.gpu_trace);
  if (has_deadlines && frame.predicted_display != 0) {
    const Interval& located = frame.early_pose ? frame.locate_early : frame.locate_late;
    if (located.end != 0) q.prediction_horizon_ns = frame.predicted_display - located.end;
    if (q.gpu_busy_ns && frame.clock_calibrated) {
      q.deadline_margin_ns = frame.predicted_display - frame.period - frame.gpu.end;
    }
    if (previous != nullptr && previous->predicted_display != 0 && frame.period > 0) {
      const double periods = static_cast<double>(frame.predicted_display - previous->predicted_display) /
                             static_cast<double>(frame.period);
      if (periods >= 1.5) q.missed = static_cast<std::uint32_t>(std::min(std::round(periods) - 1.0, 4e9));
    }
  }
  if (frame.pose_error_mm >= 0.0) q.pose_error_mm = frame.pose_error_mm;
  if (frame.pose_error_deg >= 0.0) q.pose_error_deg = frame.pose_error_deg;
  if (frame.period > 0 && q.cpu_busy_ns && q.gpu_busy_ns) {
    q.within_budget = *q.cpu_busy_ns <= frame.period && *q.gpu_busy_ns <= frame.period;
  }
  return q;
}

const QuantitySummary& Summary::quantity(std::string_view name) const {
  const auto found = std::ranges::find(quantities, name, &QuantitySummary::name);
  if (found == quantities.end()) throw std::out_of_range("no quantity named " + std::string(name));
  return *found;
}

Histogram need_to_resident_histogram(const StreamingFacts& facts) {
  Histogram durations;
  for (const std::int64_t duration : facts.need_to_resident_ns) durations.add(duration);
  return durations;
}

NeedToResident need_to_resident(const StreamingFacts& facts) {
  const Histogram durations = need_to_resident_histogram(facts);
  NeedToResident need{.count = durations.count()};
  for (const PercentileRank& rank : percentile_ranks()) {
    if (rank.p == 0.5) need.p50_ns = durations.percentile(rank);
    if (rank.p == 0.99) need.p99_ns = durations.percentile(rank);
  }
  return need;
}

std::size_t Ledger::first_counted() const {
  return static_cast<std::size_t>(std::min<std::uint64_t>(options_.warmup_frames, frames_.size()));
}

Summary Ledger::summary() const {
  const std::size_t first = first_counted();
  Summary summary;
  summary.warmup_frames = first;
  summary.frames = frames_.size() - first;
  for (const QuantityDefinition& definition : kDefinitions) {
    const bool is_time = std::string_view(definition.unit) == "ns";
    summary.quantities.push_back({definition.name, definition.unit, is_time ? 1.0 : kPoseScale, {}});
  }

  Histogram streaming;
  std::vector<std::int64_t> periods;
  double eye_scale_sum = 0.0;
  std::uint64_t scaled_frames = 0;
  std::uint64_t budgeted = 0, within_budget = 0, levelled = 0, coarse = 0, stale_run = 0, coarse_run = 0;
  std::int64_t coarse_since = 0;  // display time of the run's first frame
  std::uint64_t coarse_first = 0;
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    const FrameRecord& frame = frames_[i];
    summary.bytes_uploaded += frame.bytes_uploaded;
    summary.device_bytes_max = std::max(summary.device_bytes_max, frame.device_bytes);
    if (i < first) continue;

    const FrameQuantities q = derive(frame, i > first ? &frames_[i - 1] : nullptr, options_.has_deadlines);
    const auto values = in_definition_order(q);
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (values[k]) summary.quantities[k].histogram.add(*values[k]);
    }
    streaming.add(frame.streaming_ns);
    if (frame.period > 0) periods.push_back(frame.period);
    if (q.within_budget) {
      ++budgeted;
      within_budget += *q.within_budget ? 1 : 0;
    }
    if (frame.level_wanted >= 0) {  // shown below 0: nothing at all, which is no finer than coarse
      ++levelled;
      const bool is_coarse = frame.level_shown < frame.level_wanted;
      coarse += is_coarse ? 1 : 0;
      if (is_coarse && coarse_run++ == 0) {
        coarse_since = frame.predicted_display;
        coarse_first = frame.frame_id;
      }
      if (coarse_run > 0) {  // what is coarse stays on the display until the next frame
        const std::int64_t shown_until = frame.predicted_display + (is_coarse ? frame.period : 0);
        summary.coarse_run_max_ns = std::max(summary.coarse_run_max_ns, shown_until - coarse_since);
        if (coarse_run > summary.coarse_run_max) {
          summary.coarse_run_max = coarse_run;
          summary.coarse_run_first = coarse_first;
        }
      }
      if (!is_coarse) coarse_run = 0;
    }
    if (frame.clock_calibrated && q.gpu_busy_ns) {
      summary.clock_error_ns = std::max(summary.clock_error_ns.value_or(0), frame.clock_deviation_ns);
    }
    ++summary.pose_answers[std::min(static_cast<std::size_t>(frame.pose_answer), kPoseAnswers - 1)];
    summary.early_pose_frames += frame.early_pose ? 1 : 0;
    if (frame.should_render) {
      summary.eye_scale_min = std::min(summary.eye_scale_min.value_or(frame.eye_scale), frame.eye_scale);
      eye_scale_sum += frame.eye_scale;
      ++scaled_frames;
    }
    summary.missed += q.missed;
    summary.not_rendered += frame.should_render ? 0 : 1;
    // A discarded frame was never shown: its own refresh goes on with what was there.
    stale_run += q.missed;
    summary.discarded += frame.discarded ? 1 : 0;
    stale_run += frame.discarded ? 1 : 0;
    summary.stale_run_max = std::max(summary.stale_run_max, stale_run);
    if (!frame.discarded) stale_run = 0;
  }
  if (scaled_frames > 0) summary.eye_scale_mean = eye_scale_sum / static_cast<double>(scaled_frames);

  if (!periods.empty()) {
    const auto middle = periods.begin() + static_cast<std::ptrdiff_t>(periods.size() / 2);
    std::nth_element(periods.begin(), middle, periods.end());
    summary.period_ns = *middle;
  }
  if (budgeted > 0) summary.within_budget_fraction = static_cast<double>(within_budget) / static_cast<double>(budgeted);
  if (levelled > 0) summary.coarse_frame_fraction = static_cast<double>(coarse) / static_cast<double>(levelled);
  for (const PercentileRank& rank : percentile_ranks()) {
    if (std::string_view(rank.name) == "p99") summary.frame_thread_p99_ns = streaming.percentile(rank);
  }
  summary.worst = worst_frames(frames_, first, options_.has_deadlines);
  return summary;
}

}  // namespace probewalk
