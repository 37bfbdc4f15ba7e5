#include <fstream>
#include <vector>

#include "tools/probewalk/commands.h"
#include "xr/latency/run_info.h"

namespace probewalk {

std::string own_command_line() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  std::vector<std::string> words;
  for (std::string word; std::getline(file, word, '\0');) words.push_back(word);
  std::vector<const char*> pointers;
  for (const std::string& word : words) pointers.push_back(word.c_str());
  return command_line(static_cast<int>(pointers.size()), pointers.data());
}

}  // namespace probewalk
