// What the overlay shows, as the frame thread notes it down; the thread that draws reads it. Nothing is kept and
// nothing is noted while the overlay is hidden.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "xr/latency/histogram.h"
#include "xr/latency/ledger.h"

namespace probewalk {

// One frame of the graph. Negative = not measured.
struct OverlayFrame {
  float frame_ms = -1.0f;
  float cpu_busy_ms = -1.0f;
  float gpu_busy_ms = -1.0f;
  std::uint32_t missed = 0;  // refreshes before it without a frame
};

// How the walk stands now.
struct OverlayStatus {
  std::string display, method, room, credits;
  std::int32_t level_shown = -1, level_wanted = -1;  // -1 = none
  std::uint32_t queue_depth = 0;                     // levels asked for and not shown yet
  std::uint64_t bytes_in_flight = 0, device_bytes = 0;
  std::uint64_t budget_bytes = 0;  // 0 = no limit
  std::size_t troubled_levels = 0;
  std::string last_error;  // of the source, with the trouble past or present; empty = none so far
  float eye_scale = 1.0f;
  bool shows_lookups = false;
};

// Percentiles of the run so far, warm-up left out.
struct OverlayRow {
  const char* name = "";
  std::uint64_t n = 0;
  std::optional<double> p50_ms, p90_ms, p99_ms, max_ms;
};

struct OverlayFacts {
  OverlayStatus status;
  std::vector<OverlayFrame> frames;  // the last ones, oldest first
  double budget_ms = 0.0;            // 0 = the display has no deadlines
  std::uint64_t frames_counted = 0, missed = 0;
  std::vector<OverlayRow> rows;
};

enum class OverlayPlace {
  kWindow,   // or a headset's mirror
  kHeadset,  // before the wearer
};

class OverlayBoard {
 public:
  static constexpr std::size_t kFrames = 240;  // of the graph
  static constexpr std::size_t kFramesAtOnce = 512;

  bool is_shown(OverlayPlace place) const { return shown_[static_cast<std::size_t>(place)]; }
  bool is_shown() const { return is_shown(OverlayPlace::kWindow) || is_shown(OverlayPlace::kHeadset); }
  void show(bool shown, OverlayPlace place = OverlayPlace::kWindow);
  void toggle(OverlayPlace place) { show(!is_shown(place), place); }

  // Once a frame, on the frame thread, which never waits for the one that draws. Takes in the ledger's frames since the
  // last call, at most kFramesAtOnce of them, so that showing the overlay late in a long walk costs no frame. Nothing
  // while hidden.
  void note(const Ledger& ledger, OverlayStatus status);

  // On the thread that draws.
  OverlayFacts facts() const;

 private:
  struct Books {
    std::size_t read = 0;  // frames of the ledger
    std::vector<OverlayFrame> ring;
    std::size_t next = 0;  // place in the ring
    Histogram frame_ns, cpu_busy_ns, gpu_busy_ns, horizon_ns;
    std::uint64_t counted = 0, missed = 0;
    std::int64_t period_ns = 0;
    OverlayStatus status;
  };
  void take(const Ledger& ledger, std::size_t index);

  std::array<std::atomic<bool>, 2> shown_{};  // by OverlayPlace
  mutable std::mutex mutex_;                  // of books_; held for microseconds
  std::optional<Books> books_;
};

}  // namespace probewalk
