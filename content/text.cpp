#include "content/text.h"

#include <string_view>

namespace probewalk {
namespace {

constexpr std::string_view kEllipsis = "...";

bool continues_character(char c) { return (static_cast<unsigned char>(c) & 0xc0) == 0x80; }

// Bytes of the control character that begins at `at`, 0 when there is none: C0, DEL, C1, and Unicode's separators of
// lines and overrides of direction.
std::size_t control_bytes(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t k) { return at + k < text.size() ? static_cast<unsigned char>(text[at + k]) : 0u; };
  if (byte(0) < 0x20 || byte(0) == 0x7f) return 1;
  if (byte(0) == 0xc2 && byte(1) >= 0x80 && byte(1) < 0xa0) return 2;
  const bool overrides = byte(1) == 0x80 && byte(2) >= 0xa8 && byte(2) <= 0xae;
  const bool isolates = byte(1) == 0x81 && byte(2) >= 0xa6 && byte(2) <= 0xa9;
  return byte(0) == 0xe2 && (overrides || isolates) ? 3 : 0;
}

}  // namespace

void shorten_text(std::string& text, std::size_t bytes) {
  if (text.size() <= bytes) return;
  std::size_t end = bytes > kEllipsis.size() ? bytes - kEllipsis.size() : 0;
  while (end > 0 && continues_character(text[end])) --end;
  text.resize(end);
  if (bytes >= kEllipsis.size()) text += kEllipsis;
}

std::string printable(const std::string& text) {
  std::string out;
  for (std::size_t k = 0; k < text.size();) {
    const std::size_t control = control_bytes(text, k);
    if (control == 0) {
      out.push_back(text[k]);
    } else if (!out.empty() && out.back() != ' ') {
      out.push_back(' ');
    }
    k += control == 0 ? 1 : control;
  }
  return out;
}

}  // namespace probewalk
