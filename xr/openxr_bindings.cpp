#include "xr/openxr_bindings.h"

#include <fmt/format.h>

#include <array>
#include <string_view>
#include <utility>

namespace probewalk {
namespace {

using enum HandAction;

constexpr HandBinding both(HandAction action, const char* input) {
  return {action, input, input};
}

constexpr std::array kSimple{both(kAim, "aim/pose"), both(kTeleport, "select/click"), both(kRecentre, "menu/click")};
// The right menu button belongs to the system.
constexpr std::array kTouch{both(kAim, "aim/pose"), both(kTeleport, "trigger/value"),
                            HandBinding{kMove, "thumbstick", nullptr}, HandBinding{kTurn, nullptr, "thumbstick"},
                            HandBinding{kRecentre, "menu/click", nullptr}};
constexpr std::array kIndex{both(kAim, "aim/pose"), both(kTeleport, "trigger/value"),
                            HandBinding{kMove, "thumbstick", nullptr}, HandBinding{kTurn, nullptr, "thumbstick"},
                            both(kRecentre, "b/click")};
constexpr std::array kVive{both(kAim, "aim/pose"),
                           both(kTeleport, "trigger/value"),
                           HandBinding{kMove, "trackpad", nullptr},
                           HandBinding{kTurn, nullptr, "trackpad"},
                           both(kPadPressed, "trackpad/click"),
                           both(kRecentre, "menu/click")};
constexpr std::array kMotion{both(kAim, "aim/pose"), both(kTeleport, "trigger/value"),
                             HandBinding{kMove, "thumbstick", nullptr}, HandBinding{kTurn, nullptr, "thumbstick"},
                             both(kRecentre, "menu/click")};
// A hand has no button that would not be pressed by mistake: it recentres by the runtime's own gesture.
constexpr std::array kHand{both(kAim, "aim/pose"), both(kTeleport, "aim_activate_ext/value")};

constexpr std::array kProfiles{
    InteractionProfile{"khr/simple_controller", "simple controller", nullptr, kSimple},
    InteractionProfile{"oculus/touch_controller", "Oculus Touch", nullptr, kTouch},
    InteractionProfile{"valve/index_controller", "Valve Index", nullptr, kIndex},
    InteractionProfile{"htc/vive_controller", "HTC Vive", nullptr, kVive},
    InteractionProfile{"microsoft/motion_controller", "Windows Mixed Reality", nullptr, kMotion},
    InteractionProfile{"ext/hand_interaction_ext", "bare hands", "XR_EXT_hand_interaction", kHand},
};

const char* words_of(HandAction action) {
  switch (action) {
    case kTeleport:
      return "aims and teleports";
    case kMove:
      return "moves";
    case kTurn:
      return "turns";
    case kRecentre:
      return "recentres, held the overlay";
    case kAim:
    case kPadPressed:
      break;
  }
  return nullptr;
}

std::string control_name(std::string_view input) {
  constexpr std::pair<std::string_view, std::string_view> kNames[]{
      {"select/click", "select"},          {"trigger/value", "trigger"}, {"thumbstick", "stick"},
      {"trackpad", "pad, pressed,"},       {"menu/click", "menu"},       {"b/click", "B"},
      {"aim_activate_ext/value", "pinch"},
  };
  for (const auto& [path, name] : kNames) {
    if (input == path) return std::string(name);
  }
  return std::string(input);
}

}  // namespace

std::span<const InteractionProfile> interaction_profiles() {
  return kProfiles;
}

std::string controls_in_words(const InteractionProfile& profile) {
  std::string text;
  for (const HandBinding& binding : profile.bindings) {
    const char* words = words_of(binding.action);
    if (words == nullptr) continue;
    const char* hand = binding.right == nullptr ? "left " : binding.left == nullptr ? "right " : "";
    text += fmt::format("{}{}{} {}", text.empty() ? "" : ", ", hand,
                        control_name(binding.left != nullptr ? binding.left : binding.right), words);
  }
  return text;
}

}  // namespace probewalk
