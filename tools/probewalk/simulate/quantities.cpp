#include "tools/probewalk/simulate/quantities.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <utility>

#include "content/error.h"

namespace probewalk {
namespace {

// Number and what follows it; BadUsage when there is no finite number that is not negative.
std::pair<double, std::string> split(const std::string& option, const std::string& text, const char* example) {
  char* rest = nullptr;
  const double number = std::strtod(text.c_str(), &rest);
  if (rest == text.c_str() || !std::isfinite(number) || number < 0.0) {
    throw BadUsage(fmt::format("{} {}: write it like {}", option, text, example));
  }
  return {number, rest};
}

}  // namespace

double parse_rate(const std::string& option, const std::string& text) {
  const auto [number, unit] = split(option, text, "50MB/s");
  constexpr std::pair<const char*, double> kUnits[] = {{"B/s", 1.0},     {"kB/s", 1e3},     {"MB/s", 1e6},
                                                       {"GB/s", 1e9},    {"kbit/s", 125.0}, {"Mbit/s", 125e3},
                                                       {"Gbit/s", 125e6}};
  for (const auto& [name, factor] : kUnits) {
    if (unit == name && number > 0.0) return number * factor;
  }
  throw BadUsage(fmt::format("{} {}: a rate above 0 in B/s, kB/s, MB/s, GB/s, kbit/s, Mbit/s or Gbit/s", option, text));
}

double parse_time_s(const std::string& option, const std::string& text) {
  const auto [number, unit] = split(option, text, "20ms");
  constexpr double kMost_s = 3600.0;
  const double seconds = unit == "ms" ? number * 1e-3 : unit == "s" ? number : -1.0;
  if (seconds < 0.0 || seconds > kMost_s)
    throw BadUsage(fmt::format("{} {}: a time in ms or s, up to an hour", option, text));
  return seconds;
}

double parse_share(const std::string& option, const std::string& text) {
  const auto [number, unit] = split(option, text, "1%");
  const double share = unit == "%" ? number * 0.01 : unit.empty() ? number : -1.0;
  if (share < 0.0 || share >= 1.0)
    throw BadUsage(fmt::format("{} {}: a share below 1, such as 1% or 0.01", option, text));
  return share;
}

}  // namespace probewalk
