#include "xr/overlay/overlay_board.h"

#include <algorithm>
#include <utility>

namespace probewalk {
namespace {

constexpr double kMs = 1e-6;  // of a nanosecond

float ms_of(const std::optional<std::int64_t>& ns) {
  return ns ? static_cast<float>(static_cast<double>(*ns) * kMs) : -1.0f;
}

OverlayRow row_of(const char* name, const Histogram& histogram) {
  const auto at = [&](double p, std::uint64_t n_min) -> std::optional<double> {
    const auto value = histogram.count() >= n_min ? histogram.percentile(p) : std::nullopt;
    return value ? std::optional(static_cast<double>(*value) * kMs) : std::nullopt;
  };
  const auto max_ms = histogram.count() > 0 ? std::optional(static_cast<double>(histogram.max()) * kMs) : std::nullopt;
  return {name, histogram.count(), at(0.5, 2), at(0.9, 10), at(0.99, 100), max_ms};
}

}  // namespace

void OverlayBoard::show(bool shown, OverlayPlace place) {
  shown_[static_cast<std::size_t>(place)] = shown;
  if (is_shown()) return;
  const std::scoped_lock lock(mutex_);
  books_.reset();
}

void OverlayBoard::note(const Ledger& ledger, OverlayStatus status) {
  if (!is_shown()) return;
  // A drawing thread that reads just now has the frame before; the next note brings both up to date.
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock.owns_lock()) return;
  if (!books_) {
    books_.emplace();
    books_->ring.reserve(kFrames);
  }
  const std::size_t end = std::min(ledger.frames().size(), books_->read + kFramesAtOnce);
  for (; books_->read < end; ++books_->read) take(ledger, books_->read);
  books_->status = std::move(status);
}

void OverlayBoard::take(const Ledger& ledger, std::size_t index) {
  const FrameRecord& frame = ledger.frames()[index];
  const FrameRecord* before = index > 0 ? &ledger.frames()[index - 1] : nullptr;
  const FrameQuantities found = derive(frame, before, ledger.options().has_deadlines);
  const OverlayFrame shown{ms_of(found.frame_ns), ms_of(found.cpu_busy_ns), ms_of(found.gpu_busy_ns), found.missed};
  if (books_->ring.size() < kFrames) {
    books_->ring.push_back(shown);
  } else {
    books_->ring[books_->next] = shown;
  }
  books_->next = (books_->next + 1) % kFrames;
  books_->period_ns = ledger.options().has_deadlines ? frame.period : 0;
  // The first frame that counts has none before it that does.
  if (index < ledger.options().warmup_frames) return;
  const auto add = [](Histogram& histogram, const std::optional<std::int64_t>& value) {
    if (value) histogram.add(*value);
  };
  if (index > ledger.options().warmup_frames) {
    add(books_->frame_ns, found.frame_ns);
    books_->missed += found.missed;
  }
  add(books_->cpu_busy_ns, found.cpu_busy_ns);
  add(books_->gpu_busy_ns, found.gpu_busy_ns);
  add(books_->horizon_ns, found.prediction_horizon_ns);
  ++books_->counted;
}

OverlayFacts OverlayBoard::facts() const {
  const std::scoped_lock lock(mutex_);
  OverlayFacts facts;
  if (!books_) return facts;
  facts.status = books_->status;
  const std::size_t n = books_->ring.size(), first = n < kFrames ? 0 : books_->next;
  for (std::size_t i = 0; i < n; ++i) facts.frames.push_back(books_->ring[(first + i) % n]);
  facts.budget_ms = static_cast<double>(books_->period_ns) * kMs;
  facts.frames_counted = books_->counted;
  facts.missed = books_->missed;
  facts.rows = {row_of("frame", books_->frame_ns), row_of("cpu busy", books_->cpu_busy_ns),
                row_of("gpu busy", books_->gpu_busy_ns)};
  if (books_->horizon_ns.count() > 0) facts.rows.push_back(row_of("horizon", books_->horizon_ns));
  return facts;
}

}  // namespace probewalk
