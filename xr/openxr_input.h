// What the wearer does with controllers or bare hands, whichever the runtime has (openxr_bindings.h).
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <string>
#include <utility>
#include <vector>

#include "xr/locomotion.h"
#include "xr/openxr_bindings.h"
#include "xr/openxr_instance.h"
#include "xr/press.h"

namespace probewalk {

class OpenXrInput {
 public:
  // Suggests the bindings of every profile whose extension the instance has. Throws NoDevice when the runtime refuses
  // even the simple controller's; of the others it loses those that the runtime does not know, with a warning.
  OpenXrInput(const OpenXrInstance& instance, XrSession session);

  // Names of the profiles that the runtime has accepted.
  const std::vector<std::string>& accepted() const { return accepted_; }
  // To be called when the runtime says that the controllers have changed: logs what the hands hold now. Not an error
  // when the runtime is gone.
  void note_controllers(XrSession session);

  // To be called once a frame while the session is focused. The ray lies in `space`. `outcome` receives the
  // first call that failed, which tells of a lost session.
  MoveInput poll(XrSession session, XrSpace space, XrTime time, OpenXrOutcome& outcome);
  // Whether the wearer has held the button since the last call that recentres when it is pressed shortly.
  bool take_overlay_request() { return std::exchange(wants_overlay_, false); }

 private:
  struct Hand {
    XrPath path = XR_NULL_PATH;
    XrOwned<XrSpace, xrDestroySpace> aim;
    std::string holds;  // the profile logged last
  };
  XrAction action(HandAction which) const { return actions_[static_cast<std::size_t>(which)]; }
  void suggest(const InteractionProfile& profile);
  bool read(XrSession session, HandAction which, const Hand& hand, XrActionStateBoolean& state,
            OpenXrOutcome& outcome) const;
  bool read_stick(XrSession session, HandAction which, const Hand& hand, glm::dvec2& stick,
                  OpenXrOutcome& outcome) const;

  const OpenXrInstance& instance_;
  XrOwned<XrActionSet, xrDestroyActionSet> set_;
  std::array<XrAction, kHandActions> actions_{};  // destroyed with their set
  std::array<Hand, 2> hands_;                     // left, right
  std::vector<std::string> accepted_;
  PressButton menu_;
  bool wants_overlay_ = false;
};

}  // namespace probewalk
