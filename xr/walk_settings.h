// How a person likes to walk, from one walk to the next: turns, scale, seat. A small JSON file of this
// user's; what the command line says goes over it, and it changes only when the user says so.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "xr/display.h"

namespace probewalk {

// Empty = not said.
struct WalkSettings {
  std::optional<std::string> turn;      // a name of turn_names()
  std::optional<std::string> vignette;  // a name of vignette_levels()
  std::optional<double> world_scale;  // kWorldScaleMin to kWorldScaleMax
  std::optional<bool> seated;
  std::optional<double> eye_height_m;  // kEyeHeightMin_m to kEyeHeightMax_m

  bool operator==(const WalkSettings&) const = default;
};

inline constexpr double kWorldScaleMin = 0.01, kWorldScaleMax = 100.0;
inline constexpr double kEyeHeightMin_m = 0.3, kEyeHeightMax_m = 2.5;

// "30", "45" (degrees of a snap), "smooth", "off".
const std::vector<std::string>& turn_names();
// "off", "low", "medium", "high".
const std::vector<std::string>& vignette_names();

// What `first` says, and of what it does not say what `second` does.
WalkSettings over(const WalkSettings& first, const WalkSettings& second);
void apply(const WalkSettings& settings, DisplayOptions& options);
// "turn 45, seated": what is said, for people; "" when nothing is.
std::string in_words(const WalkSettings& settings);

// $XDG_CONFIG_HOME/probewalk/walk.json, else under $HOME/.config; empty when neither variable names a folder.
std::filesystem::path walk_settings_file();

// Nothing said when there is no such file. Throws BadInput, naming the file and what is wrong with it, on anything that
// write_walk_settings() does not write.
WalkSettings read_walk_settings(const std::filesystem::path& file);
// Makes the folder, writes the file whole. Throws BadInput.
void write_walk_settings(const std::filesystem::path& file, const WalkSettings& settings);

}  // namespace probewalk
