// The options of walk about how a person moves, remembered from one walk to the next when they say so.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>

#include "content/progress.h"
#include "xr/walk_settings.h"

namespace probewalk {

struct WalkingOptions {
  WalkSettings given;
  bool remember = false;
  bool through_walls = false;
};

// The values lie in `options` once the command line is parsed.
void add_walking_options(CLI::App& command, const std::shared_ptr<WalkingOptions>& options);

// What the command line says goes over what is remembered, and both over the defaults; with --remember the outcome is
// written. A file that cannot be read is told and passed over. Throws BadInput when it cannot be written.
void apply_walking_options(const WalkingOptions& options, DisplayOptions& display, Progress& progress);

// For --help: what each controller's buttons do, and which OpenXR extensions are used.
std::string controls_help();

}  // namespace probewalk
