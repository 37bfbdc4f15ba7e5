#include "xr/openxr_input.h"

#include <array>
#include <cstring>

namespace probewalk {
namespace {

XrPath path_of(const OpenXrInstance& instance, const char* text) {
  XrPath path = XR_NULL_PATH;
  check_xr(xrStringToPath(instance.handle(), text, &path), "xrStringToPath");
  return path;
}

XrAction make_action(XrActionSet set, XrActionType type, const char* name, const char* words,
                     std::span<const XrPath> hands) {
  XrActionCreateInfo info{XR_TYPE_ACTION_CREATE_INFO};
  info.actionType = type;
  std::strncpy(info.actionName, name, XR_MAX_ACTION_NAME_SIZE - 1);
  std::strncpy(info.localizedActionName, words, XR_MAX_LOCALIZED_ACTION_NAME_SIZE - 1);
  info.countSubactionPaths = static_cast<std::uint32_t>(hands.size());
  info.subactionPaths = hands.data();
  XrAction action = XR_NULL_HANDLE;
  check_xr(xrCreateAction(set, &info, &action), "xrCreateAction");
  return action;
}

}  // namespace

OpenXrInput::OpenXrInput(const OpenXrInstance& instance, XrSession session) {
  XrActionSetCreateInfo set{XR_TYPE_ACTION_SET_CREATE_INFO};
  std::strncpy(set.actionSetName, "walk", XR_MAX_ACTION_SET_NAME_SIZE - 1);
  std::strncpy(set.localizedActionSetName, "Walk", XR_MAX_LOCALIZED_ACTION_SET_NAME_SIZE - 1);
  check_xr(xrCreateActionSet(instance.handle(), &set, actions_.out()), "xrCreateActionSet");

  hands_[0].path = path_of(instance, "/user/hand/left");
  hands_[1].path = path_of(instance, "/user/hand/right");
  const std::array paths{hands_[0].path, hands_[1].path};
  aim_ = make_action(actions_.get(), XR_ACTION_TYPE_POSE_INPUT, "aim", "Aim", paths);
  select_ = make_action(actions_.get(), XR_ACTION_TYPE_BOOLEAN_INPUT, "teleport", "Teleport", paths);
  menu_ = make_action(actions_.get(), XR_ACTION_TYPE_BOOLEAN_INPUT, "recentre", "Recentre", paths);
  suggest(instance);

  const XrActionSet attached = actions_.get();
  XrSessionActionSetsAttachInfo attach{XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO};
  attach.countActionSets = 1;
  attach.actionSets = &attached;
  check_xr(xrAttachSessionActionSets(session, &attach), "xrAttachSessionActionSets");
  for (Hand& hand : hands_) {
    XrActionSpaceCreateInfo space{XR_TYPE_ACTION_SPACE_CREATE_INFO};
    space.action = aim_;
    space.subactionPath = hand.path;
    space.poseInActionSpace.orientation.w = 1.0f;
    check_xr(xrCreateActionSpace(session, &space, hand.aim.out()), "xrCreateActionSpace");
  }
}

// Every runtime maps its controllers to the simple one.
void OpenXrInput::suggest(const OpenXrInstance& instance) {
  const auto binding = [&](XrAction action, const char* path) {
    return XrActionSuggestedBinding{action, path_of(instance, path)};
  };
  const std::array bindings{
      binding(aim_, "/user/hand/left/input/aim/pose"),        binding(aim_, "/user/hand/right/input/aim/pose"),
      binding(select_, "/user/hand/left/input/select/click"), binding(select_, "/user/hand/right/input/select/click"),
      binding(menu_, "/user/hand/left/input/menu/click"),     binding(menu_, "/user/hand/right/input/menu/click"),
  };
  XrInteractionProfileSuggestedBinding suggestion{XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING};
  suggestion.interactionProfile = path_of(instance, "/interaction_profiles/khr/simple_controller");
  suggestion.countSuggestedBindings = static_cast<std::uint32_t>(bindings.size());
  suggestion.suggestedBindings = bindings.data();
  check_xr(xrSuggestInteractionProfileBindings(instance.handle(), &suggestion), "xrSuggestInteractionProfileBindings");
}

OpenXrInput::Events OpenXrInput::poll(XrSession session, XrSpace space, XrTime time, XrResult& result) {
  Events events;
  const XrActiveActionSet active{actions_.get(), XR_NULL_PATH};
  XrActionsSyncInfo sync{XR_TYPE_ACTIONS_SYNC_INFO};
  sync.countActiveActionSets = 1;
  sync.activeActionSets = &active;
  result = xrSyncActions(session, &sync);
  if (result != XR_SUCCESS) return events;  // lost, or the focus went away meanwhile
  for (const Hand& hand : hands_) {
    XrActionStateGetInfo query{XR_TYPE_ACTION_STATE_GET_INFO};
    query.subactionPath = hand.path;
    XrActionStateBoolean select{XR_TYPE_ACTION_STATE_BOOLEAN}, menu{XR_TYPE_ACTION_STATE_BOOLEAN};
    query.action = select_;
    if (result = xrGetActionStateBoolean(session, &query, &select); XR_FAILED(result)) return events;
    query.action = menu_;
    if (result = xrGetActionStateBoolean(session, &query, &menu); XR_FAILED(result)) return events;
    if (menu.isActive && menu.changedSinceLastSync && menu.currentState) events.recentre = true;
    if (!(select.isActive && select.changedSinceLastSync && !select.currentState)) continue;
    XrSpaceLocation aim{XR_TYPE_SPACE_LOCATION};
    if (result = xrLocateSpace(hand.aim.get(), space, time, &aim); XR_FAILED(result)) return events;
    constexpr XrSpaceLocationFlags kValid =
        XR_SPACE_LOCATION_POSITION_VALID_BIT | XR_SPACE_LOCATION_ORIENTATION_VALID_BIT;
    if ((aim.locationFlags & kValid) != kValid) continue;
    const auto& q = aim.pose.orientation;
    events.teleport = Ray{{aim.pose.position.x, aim.pose.position.y, aim.pose.position.z},
                          glm::dquat(q.w, q.x, q.y, q.z) * glm::dvec3(0, 0, -1)};
  }
  return events;
}

}  // namespace probewalk
