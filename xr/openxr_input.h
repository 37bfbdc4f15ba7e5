// What the wearer does with the controllers: aim and release to teleport, menu to recentre.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>

#include "xr/openxr_instance.h"

namespace probewalk {

class OpenXrInput {
 public:
  struct Ray {
    glm::dvec3 origin_m{0.0};  // in the space given to poll
    glm::dvec3 direction{0.0, 0.0, -1.0};
  };
  struct Events {
    std::optional<Ray> teleport;  // select was released: where the hand aimed
    bool recentre = false;        // menu was pressed
  };

  OpenXrInput(const OpenXrInstance& instance, XrSession session);
  // To be called once a frame while the session is focused. A lost session shows in `result`.
  Events poll(XrSession session, XrSpace space, XrTime time, XrResult& result);

 private:
  struct Hand {
    XrPath path = XR_NULL_PATH;
    XrOwned<XrSpace, xrDestroySpace> aim;
  };
  void suggest(const OpenXrInstance& instance);

  XrOwned<XrActionSet, xrDestroyActionSet> actions_;
  XrAction aim_ = XR_NULL_HANDLE;     // destroyed with their action set
  XrAction select_ = XR_NULL_HANDLE;
  XrAction menu_ = XR_NULL_HANDLE;
  Hand hands_[2];
};

}  // namespace probewalk
