#include "xr/walk_settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <numbers>
#include <span>
#include <system_error>

#include "content/error.h"
#include "content/json_limits.h"
#include "content/pack/file_io.h"

namespace probewalk {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

constexpr std::uint64_t kMaxBytes = 16 << 10;
constexpr JsonLimits kLimits{.values = 64, .nested = 32, .depth = 4};

double number(const json& value, const std::string& key, double least, double most) {
  const double number = value.is_number() ? value.get<double>() : NAN;
  if (!(number >= least && number <= most)) {
    throw BadInput(fmt::format("\"{}\" is no number from {} to {}", key, least, most));
  }
  return number;
}

std::string name(const json& value, const std::string& key, const std::vector<std::string>& names) {
  if (!value.is_string() || std::ranges::find(names, value.get<std::string>()) == names.end()) {
    throw BadInput(fmt::format("\"{}\" is none of \"{}\"", key, fmt::join(names, "\", \"")));
  }
  return value.get<std::string>();
}

bool yes_or_no(const json& value, const std::string& key) {
  if (!value.is_boolean()) throw BadInput(fmt::format("\"{}\" is neither true nor false", key));
  return value.get<bool>();
}

WalkSettings parse(const std::string& text) {
  if (const std::string beyond = beyond_json_limits(text, kLimits); !beyond.empty()) throw BadInput(beyond);
  const json root = json::parse(text, nullptr, false);
  if (!root.is_object()) throw BadInput("it is no JSON object");
  WalkSettings settings;
  for (const auto& [key, value] : root.items()) {
    if (key == "turn") {
      settings.turn = name(value, key, turn_names());
    } else if (key == "vignette") {
      settings.vignette = name(value, key, vignette_names());
    } else if (key == "world_scale") {
      settings.world_scale = number(value, key, kWorldScaleMin, kWorldScaleMax);
    } else if (key == "seated") {
      settings.seated = yes_or_no(value, key);
    } else if (key == "eye_height_m") {
      settings.eye_height_m = number(value, key, kEyeHeightMin_m, kEyeHeightMax_m);
    } else {
      throw BadInput("it has keys that are no settings");
    }
  }
  return settings;
}

}  // namespace

const std::vector<std::string>& turn_names() {
  static const std::vector<std::string> names{"30", "45", "smooth", "off"};
  return names;
}

const std::vector<std::string>& vignette_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const VignetteLevel& level : vignette_levels()) all.emplace_back(level.name);
    return all;
  }();
  return names;
}

WalkSettings over(const WalkSettings& first, const WalkSettings& second) {
  WalkSettings settings = first;
  if (!settings.turn) settings.turn = second.turn;
  if (!settings.vignette) settings.vignette = second.vignette;
  if (!settings.world_scale) settings.world_scale = second.world_scale;
  if (!settings.seated) settings.seated = second.seated;
  if (!settings.eye_height_m) settings.eye_height_m = second.eye_height_m;
  return settings;
}

void apply(const WalkSettings& settings, DisplayOptions& options) {
  LocomotionOptions& locomotion = options.locomotion;
  if (settings.turn == "smooth") {
    locomotion.turn = TurnStyle::kSmooth;
  } else if (settings.turn == "off") {
    locomotion.turn = TurnStyle::kOff;
  } else if (settings.turn) {
    locomotion.turn = TurnStyle::kSnap;
    locomotion.snap_rad = (settings.turn == "45" ? 45.0 : 30.0) * std::numbers::pi / 180.0;
  }
  if (settings.vignette) options.vignette = settings.vignette;
  if (settings.world_scale) locomotion.world_scale = *settings.world_scale;
  if (settings.seated) options.seated = *settings.seated;
  if (settings.eye_height_m) options.eye_height_m = settings.eye_height_m;
}

std::string in_words(const WalkSettings& settings) {
  std::vector<std::string> words;
  if (settings.turn) words.push_back("turn " + *settings.turn);
  if (settings.vignette) words.push_back("vignette " + *settings.vignette);
  if (settings.world_scale) words.push_back(fmt::format("world scale {}", *settings.world_scale));
  if (settings.seated) words.push_back(*settings.seated ? "seated" : "standing");
  if (settings.eye_height_m) words.push_back(fmt::format("eye height {} m", *settings.eye_height_m));
  return fmt::format("{}", fmt::join(words, ", "));
}

fs::path walk_settings_file() {
  // The specification has relative paths ignored.
  const auto absolute = [](const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr && fs::path(value).is_absolute() ? fs::path(value) : fs::path();
  };
  fs::path folder = absolute("XDG_CONFIG_HOME");
  if (folder.empty()) {
    if (folder = absolute("HOME"); folder.empty()) return {};
    folder /= ".config";
  }
  return folder / "probewalk" / "walk.json";
}

WalkSettings read_walk_settings(const fs::path& file) {
  std::error_code error;
  if (!fs::exists(fs::symlink_status(file, error))) return {};
  const std::vector<std::byte> bytes = read_file(file, kMaxBytes);
  try {
    return parse(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  } catch (const BadInput& wrong) {
    throw BadInput(fmt::format("{}: {}; mend it, or delete it for the defaults", file.string(), wrong.what()));
  }
}

void write_walk_settings(const fs::path& file, const WalkSettings& settings) {
  if (file.empty()) throw BadInput("settings have no place: set XDG_CONFIG_HOME or HOME to an absolute folder");
  json root = json::object();
  if (settings.turn) root["turn"] = *settings.turn;
  if (settings.vignette) root["vignette"] = *settings.vignette;
  if (settings.world_scale) root["world_scale"] = *settings.world_scale;
  if (settings.seated) root["seated"] = *settings.seated;
  if (settings.eye_height_m) root["eye_height_m"] = *settings.eye_height_m;
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  if (error) throw BadInput(fmt::format("{}: {}", file.parent_path().string(), error.message()));
  const std::string text = root.dump(2) + "\n";
  write_file_whole(file, std::as_bytes(std::span(text)));
}

}  // namespace probewalk
