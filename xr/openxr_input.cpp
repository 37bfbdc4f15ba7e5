#include "xr/openxr_input.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <cstring>
#include <optional>

namespace probewalk {
namespace {

struct ActionWords {
  XrActionType type;
  const char* name;
  const char* words;  // that the runtime's own menus show
};
// By HandAction.
constexpr std::array<ActionWords, kHandActions> kActions{{
    {XR_ACTION_TYPE_POSE_INPUT, "aim", "Aim"},
    {XR_ACTION_TYPE_BOOLEAN_INPUT, "teleport", "Teleport"},
    {XR_ACTION_TYPE_VECTOR2F_INPUT, "move", "Move"},
    {XR_ACTION_TYPE_VECTOR2F_INPUT, "turn", "Turn"},
    {XR_ACTION_TYPE_BOOLEAN_INPUT, "pad_pressed", "Pad counts while pressed"},
    {XR_ACTION_TYPE_BOOLEAN_INPUT, "recentre", "Recentre"},
}};

XrPath path_of(const OpenXrInstance& instance, const std::string& text) {
  XrPath path = XR_NULL_PATH;
  check_xr(xrStringToPath(instance.handle(), text.c_str(), &path), "xrStringToPath");
  return path;
}

XrAction make_action(XrActionSet set, const ActionWords& action, std::span<const XrPath> hands) {
  XrActionCreateInfo info{XR_TYPE_ACTION_CREATE_INFO};
  info.actionType = action.type;
  std::strncpy(info.actionName, action.name, XR_MAX_ACTION_NAME_SIZE - 1);
  std::strncpy(info.localizedActionName, action.words, XR_MAX_LOCALIZED_ACTION_NAME_SIZE - 1);
  info.countSubactionPaths = static_cast<std::uint32_t>(hands.size());
  info.subactionPaths = hands.data();
  XrAction made = XR_NULL_HANDLE;
  check_xr(xrCreateAction(set, &info, &made), "xrCreateAction");
  return made;
}

}  // namespace

OpenXrInput::OpenXrInput(const OpenXrInstance& instance, XrSession session) : instance_(instance) {
  XrActionSetCreateInfo set{XR_TYPE_ACTION_SET_CREATE_INFO};
  std::strncpy(set.actionSetName, "walk", XR_MAX_ACTION_SET_NAME_SIZE - 1);
  std::strncpy(set.localizedActionSetName, "Walk", XR_MAX_LOCALIZED_ACTION_SET_NAME_SIZE - 1);
  check_xr(xrCreateActionSet(instance.handle(), &set, set_.out()), "xrCreateActionSet");

  hands_[0].path = path_of(instance, "/user/hand/left");
  hands_[1].path = path_of(instance, "/user/hand/right");
  const std::array paths{hands_[0].path, hands_[1].path};
  for (std::size_t i = 0; i < actions_.size(); ++i) actions_[i] = make_action(set_.get(), kActions[i], paths);
  for (const InteractionProfile& profile : interaction_profiles()) {
    if (profile.extension == nullptr || instance.has(profile.extension)) suggest(profile);
  }
  spdlog::info("OpenXR: controls for {}", fmt::join(accepted_, ", "));

  const XrActionSet attached = set_.get();
  XrSessionActionSetsAttachInfo attach{XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO};
  attach.countActionSets = 1;
  attach.actionSets = &attached;
  check_xr(xrAttachSessionActionSets(session, &attach), "xrAttachSessionActionSets");
  for (Hand& hand : hands_) {
    XrActionSpaceCreateInfo space{XR_TYPE_ACTION_SPACE_CREATE_INFO};
    space.action = action(HandAction::kAim);
    space.subactionPath = hand.path;
    space.poseInActionSpace.orientation.w = 1.0f;
    check_xr(xrCreateActionSpace(session, &space, hand.aim.out()), "xrCreateActionSpace");
  }
}

void OpenXrInput::suggest(const InteractionProfile& profile) {
  std::vector<XrActionSuggestedBinding> bindings;
  for (const HandBinding& binding : profile.bindings) {
    const auto add = [&](const char* hand, const char* input) {
      if (input == nullptr) return;
      bindings.push_back(
          {action(binding.action), path_of(instance_, fmt::format("/user/hand/{}/input/{}", hand, input))});
    };
    add("left", binding.left);
    add("right", binding.right);
  }
  XrInteractionProfileSuggestedBinding suggestion{XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING};
  suggestion.interactionProfile = path_of(instance_, fmt::format("/interaction_profiles/{}", profile.path));
  suggestion.countSuggestedBindings = static_cast<std::uint32_t>(bindings.size());
  suggestion.suggestedBindings = bindings.data();
  const XrResult result = xrSuggestInteractionProfileBindings(instance_.handle(), &suggestion);
  if (result == XR_ERROR_PATH_UNSUPPORTED && !accepted_.empty()) {
    spdlog::warn("the OpenXR runtime does not take the controls of {}", profile.name);
    return;
  }
  check_xr(result, "xrSuggestInteractionProfileBindings");
  accepted_.emplace_back(profile.name);
}

void OpenXrInput::note_controllers(XrSession session) {
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    XrInteractionProfileState state{XR_TYPE_INTERACTION_PROFILE_STATE};
    if (XR_FAILED(xrGetCurrentInteractionProfile(session, hands_[i].path, &state))) return;
    std::string holds = "nothing";
    for (const InteractionProfile& profile : interaction_profiles()) {
      if (state.interactionProfile == path_of(instance_, fmt::format("/interaction_profiles/{}", profile.path))) {
        holds = fmt::format("{}: {}", profile.name, controls_in_words(profile));
      }
    }
    if (holds != hands_[i].holds) spdlog::info("{} hand: {}", i == 0 ? "left" : "right", holds);
    hands_[i].holds = std::move(holds);
  }
}

bool OpenXrInput::read(XrSession session, HandAction which, const Hand& hand, XrActionStateBoolean& state,
                       OpenXrOutcome& outcome) const {
  XrActionStateGetInfo query{XR_TYPE_ACTION_STATE_GET_INFO};
  query.action = action(which);
  query.subactionPath = hand.path;
  state = {XR_TYPE_ACTION_STATE_BOOLEAN};
  outcome = {xrGetActionStateBoolean(session, &query, &state), "xrGetActionStateBoolean"};
  return XR_SUCCEEDED(outcome.result);
}

bool OpenXrInput::read_stick(XrSession session, HandAction which, const Hand& hand, glm::dvec2& stick,
                             OpenXrOutcome& outcome) const {
  XrActionStateGetInfo query{XR_TYPE_ACTION_STATE_GET_INFO};
  query.action = action(which);
  query.subactionPath = hand.path;
  XrActionStateVector2f state{XR_TYPE_ACTION_STATE_VECTOR2F};
  outcome = {xrGetActionStateVector2f(session, &query, &state), "xrGetActionStateVector2f"};
  if (XR_FAILED(outcome.result)) return false;
  if (!state.isActive) return true;
  // A pad counts only while it is pressed; what has no pad has no such action.
  XrActionStateBoolean pressed;
  if (!read(session, HandAction::kPadPressed, hand, pressed, outcome)) return false;
  if (!pressed.isActive || pressed.currentState) stick += glm::dvec2(state.currentState.x, state.currentState.y);
  return true;
}

MoveInput OpenXrInput::poll(XrSession session, XrSpace space, XrTime time, OpenXrOutcome& outcome) {
  MoveInput input;
  const XrActiveActionSet active{set_.get(), XR_NULL_PATH};
  XrActionsSyncInfo sync{XR_TYPE_ACTIONS_SYNC_INFO};
  sync.countActiveActionSets = 1;
  sync.activeActionSets = &active;
  outcome = {xrSyncActions(session, &sync), "xrSyncActions"};
  if (outcome.result != XR_SUCCESS) return input;  // lost, or the focus went away meanwhile
  glm::dvec2 turn{0.0};
  bool menu_down = false;
  for (const Hand& hand : hands_) {
    XrActionStateBoolean teleport, recentre;
    if (!read(session, HandAction::kTeleport, hand, teleport, outcome) ||
        !read(session, HandAction::kRecentre, hand, recentre, outcome) ||
        !read_stick(session, HandAction::kMove, hand, input.wish, outcome) ||
        !read_stick(session, HandAction::kTurn, hand, turn, outcome)) {
      return {};
    }
    menu_down = menu_down || (recentre.isActive && recentre.currentState);
    const bool let_go = teleport.isActive && teleport.changedSinceLastSync && !teleport.currentState;
    if (!(teleport.isActive && teleport.currentState) && !let_go) continue;
    XrSpaceLocation aim{XR_TYPE_SPACE_LOCATION};
    outcome = {xrLocateSpace(hand.aim.get(), space, time, &aim), "xrLocateSpace"};
    if (XR_FAILED(outcome.result)) return {};
    constexpr XrSpaceLocationFlags kValid =
        XR_SPACE_LOCATION_POSITION_VALID_BIT | XR_SPACE_LOCATION_ORIENTATION_VALID_BIT;
    if ((aim.locationFlags & kValid) != kValid) continue;
    // The hand that lets go decides, whatever the other one aims at.
    if (input.teleport) continue;
    const auto& q = aim.pose.orientation;
    input.aim = AimRay{{aim.pose.position.x, aim.pose.position.y, aim.pose.position.z},
                       glm::dquat(q.w, q.x, q.y, q.z) * glm::dvec3(0, 0, -1)};
    input.teleport = let_go;
  }
  input.turn = turn.x;
  const Press menu = menu_.advance(menu_down, time);
  input.recentre = menu == Press::kShort;
  wants_overlay_ = wants_overlay_ || menu == Press::kHeld;
  return input;
}

}  // namespace probewalk
