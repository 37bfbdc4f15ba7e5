// Ends the program when work that must end does not: an endless loop cannot be asked to stop.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "content/progress.h"

namespace probewalk {

// A progress that is watched: when it does not advance for `limit`, one line says what was being done, and the program
// exits with code 1 (a check failed). Advancing is told on to `shown`.
class Patience final : public Progress {
 public:
  Patience(Progress& shown, std::chrono::seconds limit);

  void doing(std::string what);  // the line's subject

  void begin(std::string_view stage, std::uint64_t total, std::string_view unit) override;
  void advance(std::uint64_t done) override;
  void note(std::string_view line) override { shown_.note(line); }
  bool cancelled() const override { return shown_.cancelled(); }

 private:
  void watch(const std::stop_token& stop);

  Progress& shown_;
  const std::chrono::seconds limit_;
  std::atomic<std::chrono::steady_clock::rep> last_;
  std::mutex mutex_;
  std::condition_variable_any asleep_;
  std::string what_;
  std::jthread watcher_;  // last: ends before the others do
};

}  // namespace probewalk
