// Bakes for tests, and what they wrote.
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include "content/bake/bake_job.h"

namespace probewalk::test {

inline BakeReport bake_quietly(const BakeOptions& options) {
  SilentProgress progress;
  return bake(options, progress);
}

// Contents by path below the folder.
inline std::map<std::string, std::string> files_below(const std::filesystem::path& folder) {
  std::map<std::string, std::string> contents;
  for (const std::filesystem::directory_entry& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream file(entry.path(), std::ios::binary);
    contents[std::filesystem::relative(entry.path(), folder).string()] = {std::istreambuf_iterator<char>(file), {}};
  }
  return contents;
}

}  // namespace probewalk::test
