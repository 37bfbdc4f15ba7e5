// Which control of which controller does what: the one table that runtimes are told, and --help is made of. Knows no
// OpenXR header.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace probewalk {

enum class HandAction : std::uint8_t {
  kAim,         // pose that the arc leaves from
  kTeleport,    // held: aims; let go: goes there
  kMove,        // stick: smooth motion, forward where the head looks
  kTurn,        // stick: snaps, or turns smoothly
  kPadPressed,  // where a pad stands in for a stick: it counts only while it is pressed
  kRecentre,
};
inline constexpr int kHandActions = 6;

struct HandBinding {
  HandAction action;
  const char* left;  // below /user/hand/left/input/; null = not with this hand
  const char* right;
};

struct InteractionProfile {
  const char* path;       // below /interaction_profiles/
  const char* name;       // for people
  const char* extension;  // that defines it; null = the core does
  std::span<const HandBinding> bindings;
};

// The simple controller first: every runtime has it, and maps what it does not know to it.
std::span<const InteractionProfile> interaction_profiles();

// "trigger aims and teleports, left stick moves, ...": a profile's controls in words.
std::string controls_in_words(const InteractionProfile& profile);

}  // namespace probewalk
