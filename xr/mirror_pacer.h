// When the mirror takes a picture: pure numbers, no clock.
#pragma once

#include <algorithm>
#include <cstdint>

namespace probewalk {

// At the window's refreshes while the headset keeps its own. Each time that the headset misses some, the time to the
// next picture doubles; each frame without shortens it again: where both share a processor or a queue, the headset
// comes first.
class MirrorPacer {
 public:
  static constexpr std::int64_t kLongestGap_ns = 250'000'000;  // the window still moves
  enum class Turn { kNotDue, kSkipped, kTaken };

  explicit MirrorPacer(std::int64_t refresh_ns) : refresh_ns_(refresh_ns), gap_ns_(refresh_ns) {}

  // Once a frame. `display_ns`: when the headset shows the frame; `period_ns`: of the headset's refreshes. kSkipped:
  // the window could show one, but the headset is late.
  Turn next(std::int64_t now_ns, std::int64_t display_ns, std::int64_t period_ns) {
    const bool missed = last_display_ns_ != 0 && 2 * (display_ns - last_display_ns_) >= 3 * period_ns;
    last_display_ns_ = display_ns;
    gap_ns_ = missed ? std::min(2 * gap_ns_, std::max(kLongestGap_ns, refresh_ns_))
                     : std::max(gap_ns_ - gap_ns_ / 8, refresh_ns_);
    if (now_ns < due_ns_) return Turn::kNotDue;
    due_ns_ = now_ns - due_ns_ < refresh_ns_ ? due_ns_ + refresh_ns_ : now_ns + refresh_ns_;
    // Half a refresh early is in time: `now` falls anywhere between two of them.
    if (taken_ns_ != 0 && now_ns - taken_ns_ < gap_ns_ - refresh_ns_ / 2) return Turn::kSkipped;
    taken_ns_ = now_ns;
    return Turn::kTaken;
  }

 private:
  std::int64_t refresh_ns_, gap_ns_;
  std::int64_t due_ns_ = 0;
  std::int64_t taken_ns_ = 0;         // 0 = never
  std::int64_t last_display_ns_ = 0;  // 0 = no frame yet
};

}  // namespace probewalk
