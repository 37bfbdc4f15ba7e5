#include "render/foveation.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <numbers>

#include "content/error.h"

namespace probewalk {
namespace {

constexpr float kDegree = std::numbers::pi_v<float> / 180.0f;

}  // namespace

const std::vector<FoveationLevel>& foveation_levels() {
  static const std::vector<FoveationLevel> levels{{"off", std::nullopt},
                                                  {"low", Foveation{30 * kDegree, 45 * kDegree}},
                                                  {"medium", Foveation{20 * kDegree, 35 * kDegree}},
                                                  {"high", Foveation{15 * kDegree, 25 * kDegree}}};
  return levels;
}

std::optional<Foveation> foveation_of(const std::string& name) {
  std::vector<std::string> names;
  for (const FoveationLevel& level : foveation_levels()) {
    if (level.name == name) return level.foveation;
    names.emplace_back(level.name);
  }
  throw BadInput(fmt::format("there is no foveation \"{}\"; it is one of {}", name, fmt::join(names, ", ")));
}

}  // namespace probewalk
