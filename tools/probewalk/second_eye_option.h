// --second-eye, of the sub-commands that draw two eyes.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace probewalk {

// `name`: one of render's kSecondEye…; the default is what it holds.
void add_second_eye_option(CLI::App& command, std::string& name);

}  // namespace probewalk
