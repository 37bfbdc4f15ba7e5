// How much memory and recursion a JSON text would take, found before it is parsed: "[],[],[],..." becomes twenty times
// its size. A scan of its own, as the callback of nlohmann's parser looks through a list again after each of its
// objects, so that a list of a million objects would take minutes.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

namespace probewalk {

struct JsonLimits {
  std::uint64_t values = 0;
  std::uint64_t nested = 0;  // of the values: lists, objects and texts, which take memory of their own; keys count, too
  int depth = 0;
};

// What of the text is beyond the limits, as the end of a sentence; "" when nothing is. Says nothing about its being
// JSON.
inline std::string beyond_json_limits(std::string_view text, const JsonLimits& limits) {
  std::uint64_t commas = 0, nested = 0;
  int depth = 0, deepest = 0;
  bool quoted = false;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    if (quoted) {
      if (c == '\\') ++at;
      if (c == '"') quoted = false;
      continue;
    }
    if (c == '"') quoted = true;
    if (c == '"' || c == '[' || c == '{') ++nested;
    if (c == ',') ++commas;
    if (c == '[' || c == '{') deepest = std::max(deepest, ++depth);
    if (c == ']' || c == '}') --depth;
    if (deepest > limits.depth) return fmt::format("JSON is nested deeper than {}", limits.depth);
  }
  if (commas + nested > limits.values) return fmt::format("more than {} JSON values", limits.values);
  if (nested > limits.nested) return fmt::format("more than {} JSON lists, objects and texts", limits.nested);
  return "";
}

}  // namespace probewalk
