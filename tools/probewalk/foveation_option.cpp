#include "tools/probewalk/foveation_option.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "render/foveation.h"

namespace probewalk {

void add_foveation_option(CLI::App& command, std::string& name) {
  std::vector<std::string> names;
  std::string angles;
  for (const FoveationLevel& level : foveation_levels()) {
    names.emplace_back(level.name);
    if (!level.foveation) continue;
    const auto degrees = [](float rad) { return std::lround(rad * 180.0f / std::numbers::pi_v<float>); };
    angles += fmt::format("; {}: {} and {}", level.name, degrees(level.foveation->full_rad),
                          degrees(level.foveation->half_rad));
  }
  command
      .add_option(
          "--foveation", name,
          "Fewer rays towards the rim: beyond the first angle from the view's axis one for 2 x 2 pixels, beyond "
          "the second one for 4 x 4, in degrees" +
              angles)
      ->check(CLI::IsMember(names))
      ->capture_default_str();
}

}  // namespace probewalk
