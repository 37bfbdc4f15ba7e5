// Hands behind the scripted layer: buttons and sticks as ordered, bound as the application has suggested for the
// profile, so that its own table of bindings decides what they do. Where hands are, and which profile they hold, the
// runtime says unless told otherwise.
//   profile=NAME                      of both hands, such as htc/vive_controller
//   inputs=FRAME:HAND/INPUT:VALUE,... from that frame on, such as 30:right/trigger/value:0.9; a stick's value is "X Y"
//   aim_pitch_deg=X                   hands point so much above (below 0) where the runtime has them point
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "scripted.h"

namespace probewalk::test {
namespace {

constexpr float kPressed = 0.5f;  // of a value that stands for a button
const std::string kProfiles = "/interaction_profiles/", kHands = "/user/hand/";

struct Binding {
  XrAction action = XR_NULL_HANDLE;
  std::string input;  // "right/trigger/value"
};

struct Hands {
  std::map<std::string, std::vector<Binding>> suggested;  // by profile
  std::map<std::string, glm::vec2> before, now;           // inputs at the last two xrSyncActions
};
Hands hands;

std::string text_of(XrPath path) {
  char text[XR_MAX_PATH_LENGTH] = "";
  std::uint32_t length = 0;
  if (path == XR_NULL_PATH) return "";
  layer.next<PFN_xrPathToString>("xrPathToString")(layer.instance, path, sizeof(text), &length, text);
  return text;
}

XRAPI_ATTR XrResult XRAPI_CALL suggest(XrInstance instance, const XrInteractionProfileSuggestedBinding* suggested) {
  const XrResult result =
      layer.next<PFN_xrSuggestInteractionProfileBindings>("xrSuggestInteractionProfileBindings")(instance, suggested);
  if (XR_FAILED(result)) return result;
  const std::scoped_lock lock(layer.mutex);
  std::vector<Binding>& bindings = hands.suggested[text_of(suggested->interactionProfile).substr(kProfiles.size())];
  bindings.clear();
  for (std::uint32_t i = 0; i < suggested->countSuggestedBindings; ++i) {
    std::string input = text_of(suggested->suggestedBindings[i].binding).substr(kHands.size());
    input.erase(input.find('/'), std::string("/input").size());
    bindings.push_back({suggested->suggestedBindings[i].action, input});
  }
  return result;
}

XRAPI_ATTR XrResult XRAPI_CALL current_profile(XrSession session, XrPath hand, XrInteractionProfileState* state) {
  const XrResult result =
      layer.next<PFN_xrGetCurrentInteractionProfile>("xrGetCurrentInteractionProfile")(session, hand, state);
  const std::string profile = layer.setting("profile");
  if (XR_FAILED(result) || profile.empty()) return result;
  return layer.next<PFN_xrStringToPath>("xrStringToPath")(layer.instance, (kProfiles + profile).c_str(),
                                                          &state->interactionProfile);
}

XRAPI_ATTR XrResult XRAPI_CALL sync_actions(XrSession session, const XrActionsSyncInfo* info) {
  const XrResult result = layer.next<PFN_xrSyncActions>("xrSyncActions")(session, info);
  const std::scoped_lock lock(layer.mutex);
  hands.before = hands.now;
  for (const Order& order : orders_of(layer.setting("inputs"))) {
    if (layer.session.frame < order.frame) continue;
    glm::vec2 value(0.0f);
    std::istringstream(order.words.at(1)) >> value.x >> value.y;
    hands.now[order.words.at(0)] = value;
  }
  return result;
}

struct Input {
  glm::vec2 before{0.0f}, now{0.0f};
};

// What is ordered of the input that the action has on this hand; nothing where the profile has none for it.
std::optional<Input> input_of(XrSession session, const XrActionStateGetInfo& info) {
  XrInteractionProfileState state{XR_TYPE_INTERACTION_PROFILE_STATE, nullptr, XR_NULL_PATH};
  if (XR_FAILED(current_profile(session, info.subactionPath, &state))) return {};
  const std::string profile = text_of(state.interactionProfile);
  if (profile.empty()) return {};
  const std::string hand = text_of(info.subactionPath).substr(kHands.size()) + "/";
  const std::scoped_lock lock(layer.mutex);
  for (const Binding& binding : hands.suggested[profile.substr(kProfiles.size())]) {
    if (binding.action != info.action || !binding.input.starts_with(hand)) continue;
    return Input{hands.before[binding.input], hands.now[binding.input]};
  }
  return {};
}

XRAPI_ATTR XrResult XRAPI_CALL get_boolean(XrSession session, const XrActionStateGetInfo* info,
                                           XrActionStateBoolean* state) {
  const XrResult result = layer.next<PFN_xrGetActionStateBoolean>("xrGetActionStateBoolean")(session, info, state);
  if (XR_FAILED(result) || layer.setting("inputs").empty()) return result;
  const std::optional<Input> input = input_of(session, *info);
  state->isActive = input ? XR_TRUE : XR_FALSE;
  state->currentState = input && input->now.x >= kPressed ? XR_TRUE : XR_FALSE;
  state->changedSinceLastSync =
      input && (input->before.x >= kPressed) != (input->now.x >= kPressed) ? XR_TRUE : XR_FALSE;
  return result;
}

XRAPI_ATTR XrResult XRAPI_CALL get_stick(XrSession session, const XrActionStateGetInfo* info,
                                         XrActionStateVector2f* state) {
  const XrResult result = layer.next<PFN_xrGetActionStateVector2f>("xrGetActionStateVector2f")(session, info, state);
  if (XR_FAILED(result) || layer.setting("inputs").empty()) return result;
  const std::optional<Input> input = input_of(session, *info);
  const glm::vec2 value = input ? input->now : glm::vec2(0.0f);
  state->isActive = input ? XR_TRUE : XR_FALSE;
  state->currentState = {value.x, value.y};
  state->changedSinceLastSync = input && input->before != input->now ? XR_TRUE : XR_FALSE;
  return result;
}

XRAPI_ATTR XrResult XRAPI_CALL create_action_space(XrSession session, const XrActionSpaceCreateInfo* info,
                                                   XrSpace* space) {
  const XrResult result = layer.next<PFN_xrCreateActionSpace>("xrCreateActionSpace")(session, info, space);
  const std::scoped_lock lock(layer.mutex);
  if (XR_SUCCEEDED(result)) layer.session.aim_spaces.insert(*space);
  return result;
}

XRAPI_ATTR XrResult XRAPI_CALL locate_space(XrSpace space, XrSpace base, XrTime time, XrSpaceLocation* location) {
  const XrResult result = layer.next<PFN_xrLocateSpace>("xrLocateSpace")(space, base, time, location);
  const std::scoped_lock lock(layer.mutex);
  if (XR_FAILED(result) || !layer.session.aim_spaces.contains(space)) return result;
  auto& [orientation, position] = location->pose;
  const double half_rad = glm::radians(layer.number("aim_pitch_deg")) / 2;
  const glm::dquat pointing = glm::dquat(orientation.w, orientation.x, orientation.y, orientation.z) *
                              glm::dquat(std::cos(half_rad), std::sin(half_rad), 0.0, 0.0);
  orientation = {static_cast<float>(pointing.x), static_cast<float>(pointing.y), static_cast<float>(pointing.z),
                 static_cast<float>(pointing.w)};
  position.x += static_cast<float>(beside_m(time));
  return result;
}

}  // namespace

Hooks hand_hooks() {
  return {hook<"xrSuggestInteractionProfileBindings", suggest>(),
          hook<"xrGetCurrentInteractionProfile", current_profile>(),
          hook<"xrSyncActions", sync_actions>(),
          hook<"xrGetActionStateBoolean", get_boolean>(),
          hook<"xrGetActionStateVector2f", get_stick>(),
          hook<"xrCreateActionSpace", create_action_space>(),
          hook<"xrLocateSpace", locate_space>()};
}

}  // namespace probewalk::test
