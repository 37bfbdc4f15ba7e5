#include "content/cache_folder.h"

#include <cstdlib>

namespace probewalk {

namespace fs = std::filesystem;

fs::path default_cache_folder() {
  // The specification has relative paths ignored.
  const auto absolute = [](const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr && fs::path(value).is_absolute() ? fs::path(value) : fs::path();
  };
  if (const fs::path cache = absolute("XDG_CACHE_HOME"); !cache.empty()) return cache / "probewalk";
  if (const fs::path home = absolute("HOME"); !home.empty()) return home / ".cache" / "probewalk";
  return fs::temp_directory_path() / "probewalk";
}

}  // namespace probewalk
