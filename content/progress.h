// How long work tells how far it is, and is asked to stop. The command line draws the bar; content only reports.
#pragma once

#include <atomic>
#include <cstdint>
#include <string_view>

namespace probewalk {

class Progress {
 public:
  virtual ~Progress() = default;
  // A stage begins: `total` units of work named `unit` ("texels", "probes").
  virtual void begin(std::string_view stage, std::uint64_t total, std::string_view unit) = 0;
  // `done` more units of the current stage are finished. Callable from any thread.
  virtual void advance(std::uint64_t done) = 0;
  // One line for people: an estimate, a choice made, a warning.
  virtual void note(std::string_view line) = 0;
  // Asked to stop (Ctrl-C). Long work polls it, saves its state and throws Interrupted.
  virtual bool cancelled() const { return false; }
};

// Says nothing; for tests and --quiet.
class SilentProgress final : public Progress {
 public:
  void begin(std::string_view, std::uint64_t, std::string_view) override {}
  void advance(std::uint64_t) override {}
  void note(std::string_view) override {}
};

}  // namespace probewalk
