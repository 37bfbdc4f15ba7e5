// The errors that reach main. Each ends the program with one clear line and the exit code of its kind.
#pragma once

#include <stdexcept>
#include <string>

namespace probewalk {

// Exit codes are part of the command line's contract.
enum class ExitCode : int {
  kDone = 0,
  kCheckFailed = 1,
  kBadUsage = 2,
  kBadInput = 3,
  kNoDevice = 4,  // no suitable device, runtime or display
  kInterrupted = 5,
};

class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

// A scene, pack, path or ray file that cannot be used. The message names the file, the value and the remedy.
struct BadInput : Error {
  explicit BadInput(const std::string& message) : Error(ExitCode::kBadInput, message) {}
};
// A file elsewhere that did not come this time: the server is busy, gone or stalls. It may be otherwise later.
struct Unavailable : Error {
  explicit Unavailable(const std::string& message) : Error(ExitCode::kBadInput, message) {}
};
struct BadUsage : Error {
  explicit BadUsage(const std::string& message) : Error(ExitCode::kBadUsage, message) {}
};
struct CheckFailed : Error {
  explicit CheckFailed(const std::string& message) : Error(ExitCode::kCheckFailed, message) {}
};
struct NoDevice : Error {
  explicit NoDevice(const std::string& message) : Error(ExitCode::kNoDevice, message) {}
};
struct Interrupted : Error {
  explicit Interrupted(const std::string& message) : Error(ExitCode::kInterrupted, message) {}
};

}  // namespace probewalk
