#include "xr/latency/report_text.h"

#include <fmt/format.h>

#include <cmath>

namespace probewalk {

std::string html_escaped(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      case '\'': out += "&#39;"; break;
      default: out += c;
    }
  }
  return out;
}

std::string in_ms(std::int64_t ns) {
  const double ms = static_cast<double>(ns) * 1e-6;
  const double magnitude = std::abs(ms);
  const int decimals = magnitude >= 100.0 ? 0 : magnitude >= 10.0 ? 1 : magnitude >= 1.0 ? 2 : 3;
  return fmt::format("{:.{}f}", ms, decimals);
}

std::string in_bytes(std::uint64_t bytes) {
  const double value = static_cast<double>(bytes);
  if (bytes >= 1ull << 30) return fmt::format("{:.2f} GiB", value / 0x1p30);
  if (bytes >= 1ull << 20) return fmt::format("{:.1f} MiB", value / 0x1p20);
  if (bytes >= 1ull << 10) return fmt::format("{:.1f} KiB", value / 0x1p10);
  return fmt::format("{} B", bytes);
}

}  // namespace probewalk
