#include "xr/latency/worst_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "xr/latency/histogram.h"
#include "xr/latency/ledger.h"
#include "xr/latency/report_text.h"

namespace probewalk {
namespace {

// What an interval between two frame starts is made of. The first group tiles it; the others lie inside it.
enum Stage : std::size_t {
  kBegin,
  kLocateEarly,
  kRecord,
  kLocateLate,
  kSubmit,
  kEnd,
  kLedger,
  kBetweenCalls,
  kWait,  // tile it
  kStreaming,
  kMirror,
  kBlocked,  // inside those
  kGpuTrace,
  kGpuResolve,
  kGpuOther,  // on the device, beside them
  kStageCount
};
constexpr std::array<const char*, kStageCount> kStageNames{
    "begin", "locate_early", "record", "locate_late", "submit",    "end",         "ledger",   "between_calls",
    "wait",  "streaming",    "mirror", "blocked",     "gpu_trace", "gpu_resolve", "gpu_other"};
using StageTimes = std::array<std::int64_t, kStageCount>;

std::int64_t length(const Interval& interval) {
  return std::max<std::int64_t>(0, interval.end - interval.begin);
}

// `work` is the frame whose work fills the interval; `next` the one whose wait ends it.
StageTimes stage_times(const FrameRecord& work, const FrameRecord& next) {
  StageTimes t{};
  t[kBegin] = length(work.begin);
  t[kLocateEarly] = length(work.locate_early);
  t[kRecord] = length(work.record);
  t[kLocateLate] = length(work.locate_late);
  t[kSubmit] = length(work.submit);
  t[kEnd] = length(work.end);
  t[kLedger] = length(work.ledger);
  t[kWait] = length(next.wait);
  std::int64_t told = 0;
  for (std::size_t i = kBegin; i <= kLedger; ++i) told += t[i];
  t[kBetweenCalls] = std::max<std::int64_t>(0, next.wait.end - work.wait.end - t[kWait] - told);
  t[kStreaming] = work.streaming_ns;
  t[kMirror] = length(work.mirror);
  t[kBlocked] = work.blocked_ns;
  t[kGpuTrace] = length(work.gpu_trace);
  t[kGpuResolve] = length(work.gpu_resolve);
  t[kGpuOther] = std::max<std::int64_t>(0, length(work.gpu) - t[kGpuTrace] - t[kGpuResolve]);
  return t;
}

std::size_t largest(const StageTimes& excess, std::size_t from, std::size_t to) {
  return static_cast<std::size_t>(std::max_element(excess.begin() + static_cast<std::ptrdiff_t>(from),
                                                   excess.begin() + static_cast<std::ptrdiff_t>(to)) -
                                  excess.begin());
}

// The stage to blame: the tile that grew most; then what grew inside it, or the device where the CPU may only have
// waited for it (runtimes wait inside any of their calls), when that explains at least half.
std::size_t blame(const StageTimes& excess) {
  const std::size_t tile = largest(excess, kBegin, kStreaming);
  const std::size_t inner = largest(excess, kStreaming, kBlocked);
  if (2 * excess[inner] >= excess[tile]) return inner;
  const bool blocked = 2 * excess[kBlocked] >= excess[tile];
  const bool cpu_works = tile == kRecord || tile == kLocateEarly || tile == kLocateLate;
  if (blocked || !cpu_works) {
    const std::size_t device = largest(excess, kGpuTrace, kStageCount);
    if (2 * excess[device] >= excess[tile]) return device;
  }
  return blocked ? kBlocked : tile;
}

std::string in_words(std::size_t stage, const StageTimes& times, const StageTimes& medians, const FrameRecord& work,
                     const FrameRecord* before) {
  std::string text = stage == kStageCount ? std::string("no stage stands out")
                                          : fmt::format("{} took {} ms, {} ms more than its median", kStageNames[stage],
                                                        in_ms(times[stage]), in_ms(times[stage] - medians[stage]));
  if (stage == kWait) text += ": the runtime held the frame back";
  if (work.pipelines_built > 0) text += fmt::format("; {} pipeline build(s)", work.pipelines_built);
  if (before != nullptr && before->room != work.room) text += fmt::format("; room {} to {}", before->room, work.room);
  if (work.bytes_uploaded > 0) text += fmt::format("; {} uploaded", in_bytes(work.bytes_uploaded));
  if (work.discarded) text += "; discarded by the runtime";
  return text;
}

}  // namespace

std::vector<WorstFrame> worst_frames(std::span<const FrameRecord> frames, std::size_t first, bool has_deadlines,
                                     std::size_t count) {
  std::array<Histogram, kStageCount> stages;
  std::vector<WorstFrame> worst;
  for (std::size_t i = first + 1; i < frames.size(); ++i) {
    const FrameQuantities q = derive(frames[i], &frames[i - 1], has_deadlines);
    if (!q.frame_ns) continue;
    const StageTimes times = stage_times(frames[i - 1], frames[i]);
    for (std::size_t s = 0; s < kStageCount; ++s) stages[s].add(times[s]);
    WorstFrame frame;
    frame.frame_id = frames[i].frame_id;
    frame.index = i;
    frame.frame_ns = *q.frame_ns;
    frame.missed = q.missed;
    worst.push_back(std::move(frame));
  }
  const std::size_t kept = std::min(count, worst.size());
  std::partial_sort(worst.begin(), worst.begin() + static_cast<std::ptrdiff_t>(kept), worst.end(),
                    [](const WorstFrame& a, const WorstFrame& b) {
                      return a.frame_ns != b.frame_ns ? a.frame_ns > b.frame_ns : a.index < b.index;
                    });
  worst.resize(kept);

  StageTimes medians{};
  for (std::size_t s = 0; s < kStageCount; ++s) medians[s] = stages[s].percentile(0.5).value_or(0);
  for (WorstFrame& frame : worst) {
    const FrameRecord& work = frames[frame.index - 1];
    const FrameRecord* before = frame.index >= 2 ? &frames[frame.index - 2] : nullptr;
    const FrameQuantities q = derive(work, before, has_deadlines);
    frame.cpu_busy_ns = q.cpu_busy_ns;
    frame.gpu_busy_ns = q.gpu_busy_ns;
    const StageTimes times = stage_times(work, frames[frame.index]);
    StageTimes excess{};
    for (std::size_t s = 0; s < kStageCount; ++s) excess[s] = times[s] - medians[s];
    std::size_t stage = blame(excess);
    // Medians are known within 1 %, and a tenth of a millisecond is scheduling: below that nothing is to blame.
    if (excess[stage] < std::max<std::int64_t>(100'000, frame.frame_ns / 50)) stage = kStageCount;
    if (stage != kStageCount) {
      frame.stage = kStageNames[stage];
      frame.excess_ns = excess[stage];
    }
    frame.cause = in_words(stage, times, medians, work, before);
  }
  return worst;
}

}  // namespace probewalk
