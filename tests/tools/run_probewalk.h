// Runs the built executable as other programs do, and keeps what it said.
#pragma once

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace probewalk::test {

struct RunResult {
  int exit_code = -1;  // negative: killed by that signal
  std::string out;
  std::string err;
};

inline std::string read_text(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

// A fresh folder for one test.
inline std::filesystem::path fresh_folder(const std::string& name) {
  const std::filesystem::path folder = std::filesystem::path(PROBEWALK_TEST_OUTPUT_DIR) / "tools" / name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

// Starts `probewalk arguments...`; both streams go to files in `folder`.
inline pid_t start_probewalk(const std::filesystem::path& folder, const std::vector<std::string>& arguments) {
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) {
    const auto redirect = [](const std::filesystem::path& file, int target) {
      const int fd = open(file.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0644);
      dup2(fd, target);
    };
    redirect(folder / "stdout", 1);
    redirect(folder / "stderr", 2);
    std::vector<char*> argv;
    std::string program = PROBEWALK_EXECUTABLE;
    argv.push_back(program.data());
    std::vector<std::string> copy = arguments;
    for (std::string& a : copy) argv.push_back(a.data());
    argv.push_back(nullptr);
    execv(program.c_str(), argv.data());
    _exit(127);
  }
  return child;
}

inline RunResult finish_probewalk(pid_t child, const std::filesystem::path& folder) {
  int status = 0;
  waitpid(child, &status, 0);
  RunResult result;
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  result.out = read_text(folder / "stdout");
  result.err = read_text(folder / "stderr");
  return result;
}

inline bool installed(const std::string& program) {
  return std::system(("command -v '" + program + "' >/dev/null 2>&1").c_str()) == 0;
}

// Runs lines of bash in `folder`, which receives the script and both streams.
inline RunResult run_bash(const std::filesystem::path& folder, const std::string& lines) {
  std::ofstream(folder / "script.sh") << "set -u\ncd '" << folder.string() << "'\n" << lines << "\n";
  const auto quoted = [&](const char* name) { return "'" + (folder / name).string() + "'"; };
  const int status =
      std::system(("bash " + quoted("script.sh") + " >" + quoted("stdout") + " 2>" + quoted("stderr")).c_str());
  RunResult result;
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  result.out = read_text(folder / "stdout");
  result.err = read_text(folder / "stderr");
  return result;
}

inline RunResult run_probewalk(const std::filesystem::path& folder, const std::vector<std::string>& arguments) {
  return finish_probewalk(start_probewalk(folder, arguments), folder);
}

}  // namespace probewalk::test
