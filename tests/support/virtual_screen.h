// An X screen that nobody sees, 960x540, for as long as this lives: windows of this process and of those that it starts
// open on it.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

namespace probewalk::test {

class VirtualScreen {
 public:
  VirtualScreen() {
    int ends[2];
    if (pipe(ends) != 0) return;
    server_ = fork();
    if (server_ == 0) {
      prctl(PR_SET_PDEATHSIG, SIGTERM);
      const int nowhere = open("/dev/null", O_RDWR);
      for (const int stream : {0, 1, 2}) dup2(nowhere, stream);
      close(ends[0]);
      const std::string end = std::to_string(ends[1]);
      execlp("Xvfb", "Xvfb", "-displayfd", end.c_str(), "-noreset", "-screen", "0", "960x540x24", "-nolisten", "tcp",
             static_cast<char*>(nullptr));
      _exit(127);
    }
    close(ends[1]);
    // It tells its number once it answers; an end without one means that there is no Xvfb.
    for (char c = 0; read(ends[0], &c, 1) == 1 && c != '\n';) number_ += c;
    close(ends[0]);
    if (number_.empty()) return;
    setenv("DISPLAY", (":" + number_).c_str(), 1);
    setenv("XDG_SESSION_TYPE", "x11", 1);
    unsetenv("WAYLAND_DISPLAY");
  }
  ~VirtualScreen() {
    unsetenv("DISPLAY");
    if (server_ <= 0) return;
    kill(server_, SIGTERM);
    waitpid(server_, nullptr, 0);
  }
  VirtualScreen(const VirtualScreen&) = delete;
  VirtualScreen& operator=(const VirtualScreen&) = delete;

  bool is_there() const { return !number_.empty(); }
  // 12 of ":12".
  const std::string& number() const { return number_; }

 private:
  pid_t server_ = -1;
  std::string number_;
};

}  // namespace probewalk::test
