// --foveation, of the sub-commands that draw views.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace probewalk {

// `name` becomes one of foveation_levels() (render/foveation.h).
void add_foveation_option(CLI::App& command, std::string& name);

}  // namespace probewalk
