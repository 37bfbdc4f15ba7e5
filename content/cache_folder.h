// Where what can be made or fetched again is kept for this user.
#pragma once

#include <filesystem>

namespace probewalk {

// $XDG_CACHE_HOME/probewalk, else $HOME/.cache/probewalk, else probewalk in the system's folder of temporary files.
std::filesystem::path default_cache_folder();

}  // namespace probewalk
