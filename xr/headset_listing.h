// The headset that answers, and what it offers, in words: `probewalk --list-headset`.
#pragma once

#include <string>

namespace probewalk {

// Lines of text. Opens a session for it, which shows nothing, on the device that the runtime names. Throws NoDevice
// when no runtime or no headset answers.
std::string list_headset();

}  // namespace probewalk
