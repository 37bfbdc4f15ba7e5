#include "tools/probewalk/walking_options.h"

#include <fmt/format.h>

#include "content/error.h"
#include "xr/openxr_bindings.h"
#include "xr/openxr_extensions.h"

namespace probewalk {

void add_walking_options(CLI::App& command, const std::shared_ptr<WalkingOptions>& options) {
  WalkSettings& given = options->given;
  command
      .add_option("--turn", given.turn,
                  "Turns by stick or Q and E: 30 or 45 (snaps of as many degrees), smooth "
                  "(90 degrees a second), off (default: 30)")
      ->check(CLI::IsMember(turn_names()))
      ->option_text("NAME");
  command
      .add_option("--vignette", given.vignette,
                  "Narrows the view while sticks or keys move or turn it smoothly: off, low, medium, high (default: "
                  "medium in a headset, off in a window)")
      ->check(CLI::IsMember(vignette_names()))
      ->option_text("NAME");
  command
      .add_option("--world-scale", given.world_scale,
                  "Metres of the scene to one of yours: 2 makes you twice as large and the scene half its size "
                  "(default: 1). Eye height, steps, speed and the distance of the eyes scale")
      ->check(CLI::Range(kWorldScaleMin, kWorldScaleMax))
      ->option_text("S");
  command.add_flag("--seated,!--standing", given.seated,
                   "Headset: you sit. Your resting head is raised to --eye-height, and menu takes its height anew; "
                   "--standing: your own floor is the scene's (default)");
  command
      .add_option("--eye-height", given.eye_height_m,
                  fmt::format("Metres from the floor to resting eyes, in a window, seated, or where a headset knows no "
                              "floor (default: {}; with --seated {} in a headset)",
                              kEyeHeight_m, kSeatedEyeHeight_m))
      ->check(CLI::Range(kEyeHeightMin_m, kEyeHeightMax_m))
      ->option_text("M");
  command.add_flag("--through-walls", options->through_walls,
                   "Walls do not stop sticks and keys; teleports still land in view only");
  command.add_flag("--remember", options->remember,
                   "Keep turn, vignette, world scale, seat and eye height of this walk for the next ones, in "
                   "walk.json in the user's configuration (delete it to forget). Options given then go over it");
}

void apply_walking_options(const WalkingOptions& options, DisplayOptions& display, Progress& progress) {
  const std::filesystem::path file = walk_settings_file();
  WalkSettings remembered;
  try {
    if (!file.empty()) remembered = read_walk_settings(file);
    if (remembered != WalkSettings{}) {
      progress.note(fmt::format("settings of {}: {}", file.string(), in_words(remembered)));
    }
  } catch (const BadInput& error) {
    progress.note(fmt::format("settings not used: {}", error.what()));
  }
  const WalkSettings settings = over(options.given, remembered);
  apply(settings, display);
  display.locomotion.through_walls = options.through_walls;
  if (!options.remember) return;
  write_walk_settings(file, settings);
  progress.note(fmt::format("remembered in {}: {}", file.string(),
                            settings == WalkSettings{} ? "the defaults" : in_words(settings)));
}

std::string controls_help() {
  std::string text = "Controllers, of which the runtime says what is in your hands:\n";
  for (const InteractionProfile& profile : interaction_profiles()) {
    text += fmt::format("  {:<22} {}{}\n", profile.name, controls_in_words(profile),
                        profile.extension != nullptr ? fmt::format(" ({})", profile.extension) : "");
  }
  text += "OpenXR extensions, and what is lost without:\n";
  for (const OpenXrExtension& extension : wanted_openxr_extensions()) {
    text += fmt::format(
        "  {:<31} {}\n", extension.name,
        extension.required ? fmt::format("required: {}", extension.without_it) : std::string(extension.without_it));
  }
  return text;
}

}  // namespace probewalk
