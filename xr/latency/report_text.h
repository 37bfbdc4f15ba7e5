// Small words that the page and its charts share.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace probewalk {

// Text that HTML and SVG show as it is, also inside attributes.
std::string html_escaped(std::string_view text);
// Nanoseconds as milliseconds with three significant digits or so: "0.412", "13.9", "152".
std::string in_ms(std::int64_t ns);
std::string in_bytes(std::uint64_t bytes);

}  // namespace probewalk
