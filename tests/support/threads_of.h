// What the threads of another process are at, for a test whose program should have ended and has not.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace probewalk::test {

// A line for each thread: its name, its state, what it waits for in the kernel and the numbers of its system call.
inline std::string threads_of(pid_t process) {
  namespace fs = std::filesystem;
  std::string text;
  std::error_code error;
  for (fs::directory_iterator task("/proc/" + std::to_string(process) + "/task", error), end; task != end;
       task.increment(error)) {
    const auto line = [&](const char* file) {
      std::ifstream in(task->path() / file);
      std::string all(std::istreambuf_iterator<char>(in), {});
      return all.substr(0, all.find('\n'));
    };
    const std::string stat = line("stat");
    const std::size_t name_end = stat.rfind(')');
    text += line("comm") + ": " + (name_end + 2 < stat.size() ? stat.substr(name_end + 2, 1) : "?") + ", " +
            line("wchan") + ", system call " + line("syscall") + "\n";
  }
  return text.empty() ? "it is gone\n" : text;
}

}  // namespace probewalk::test
