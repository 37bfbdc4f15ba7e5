#include "xr/frame_book.h"

#include <algorithm>

namespace probewalk {

void FrameBook::add(const FrameRecord& record, std::uint64_t drawn) {
  open_.push_back({record, drawn});
  while (open_.size() > kPatience) {
    ledger_.add(open_.front().record);
    open_.pop_front();
  }
}

void FrameBook::add(const FrameGpuTimes& times) {
  const auto entry = std::ranges::find(open_, times.frame, &Entry::drawn);
  if (entry == open_.end()) return;
  FrameRecord& record = entry->record;
  record.gpu = {times.whole.begin_ns, times.whole.end_ns};
  record.gpu_trace = {times.trace.begin_ns, times.trace.end_ns};
  record.gpu_resolve = {times.resolve.begin_ns, times.resolve.end_ns};
  record.clock_calibrated = times.calibrated;
  record.clock_deviation_ns = times.max_deviation_ns;
}

void FrameBook::add(const PoseError& error) {
  const auto entry = std::ranges::find_if(
      open_, [&](const Entry& e) { return e.record.predicted_display == error.predicted_display_ns; });
  if (entry == open_.end()) return;
  entry->record.pose_answer = error.answer;
  if (error.answer != PoseAnswer::kMeasured) return;
  entry->record.pose_error_mm = error.position_mm;
  entry->record.pose_error_deg = error.angle_deg;
}

void FrameBook::add(const MirrorShown& shown) {
  const auto entry = std::ranges::find_if(open_, [&](const Entry& e) { return e.record.frame_id == shown.frame_id; });
  if (entry == open_.end()) return;
  entry->record.mirror_shown = shown.interval;
  entry->record.mirror_presented = shown.presented;
}

void FrameBook::add_ledger_time(const Interval& interval) {
  if (!open_.empty()) open_.back().record.ledger = interval;
}

void FrameBook::close() {
  for (const Entry& entry : open_) ledger_.add(entry.record);
  open_.clear();
}

}  // namespace probewalk
