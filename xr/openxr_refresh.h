// The refresh rates that a headset offers (XR_FB_display_refresh_rate), and the one that it has.
#pragma once

#include <string>
#include <vector>

#include "xr/openxr_instance.h"

namespace probewalk {

class OpenXrRefresh {
 public:
  // Asks the runtime; it may lack the extension, and then nothing is known.
  OpenXrRefresh(const OpenXrInstance& instance, XrSession session);

  // Asks for the rate nearest to `wanted_hz`. Throws BadUsage, naming what is offered, when none lies within half a Hz
  // of it or rates cannot be chosen at all.
  void choose(double wanted_hz);
  // What the runtime says the rate is from now on.
  void changed_to(double hz);
  // "72 Hz of 60, 72, 90, 90 Hz asked for", without the latter once the runtime has said so; empty = not known.
  std::string in_words() const;

 private:
  XrInstance instance_;
  XrSession session_;
  bool can_choose_;
  std::vector<float> offered_hz_;  // ascending
  double now_hz_ = 0.0;
  double asked_hz_ = 0.0;  // 0 = for none
};

}  // namespace probewalk
