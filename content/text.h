// Text that other people wrote.
#pragma once

#include <cstddef>
#include <string>

namespace probewalk {

// Cuts UTF-8 text to at most `bytes`, never inside a character; what was cut off shows as "...".
void shorten_text(std::string& text, std::size_t bytes);

// The text on one line, without the characters that steer a terminal or turn the direction of reading.
std::string printable(const std::string& text);

}  // namespace probewalk
