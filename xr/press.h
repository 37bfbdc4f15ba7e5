// A button that means two things: one when it is pressed shortly, another when it is held.
#pragma once

#include <cstdint>
#include <optional>

namespace probewalk {

enum class Press {
  kNone,
  kShort,  // it was let go before kHold_ns
  kHeld,   // it has been down that long; once, whatever becomes of it then
};

class PressButton {
 public:
  static constexpr std::int64_t kHold_ns = 800'000'000;

  // Once a frame; `now_ns` never goes back.
  Press advance(bool down, std::int64_t now_ns) {
    if (!down) {
      const bool was_short = since_ns_.has_value() && !held_;
      since_ns_.reset();
      held_ = false;
      return was_short ? Press::kShort : Press::kNone;
    }
    if (!since_ns_) since_ns_ = now_ns;
    if (held_ || now_ns - *since_ns_ < kHold_ns) return Press::kNone;
    held_ = true;
    return Press::kHeld;
  }

 private:
  std::optional<std::int64_t> since_ns_;
  bool held_ = false;
};

}  // namespace probewalk
