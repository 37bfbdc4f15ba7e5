// How progress shows: a bar on a terminal, a plain line every few seconds elsewhere, nothing with --quiet.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <string>

#include "content/text.h"
#include "tools/probewalk/commands.h"

namespace probewalk {

namespace {

using Clock = std::chrono::steady_clock;

std::string short_number(double x) {
  char text[32];
  if (x >= 1e9) std::snprintf(text, sizeof text, "%.1f G", x / 1e9);
  else if (x >= 1e6) std::snprintf(text, sizeof text, "%.1f M", x / 1e6);
  else if (x >= 1e4) std::snprintf(text, sizeof text, "%.0f k", x / 1e3);
  else std::snprintf(text, sizeof text, "%.0f ", x);
  return text;
}

std::string duration(double seconds) {
  char text[32];
  const int s = static_cast<int>(seconds + 0.5);
  if (s >= 60) std::snprintf(text, sizeof text, "%d min %02d s", s / 60, s % 60);
  else std::snprintf(text, sizeof text, "%d s", s);
  return text;
}

class ProgressBar final : public Progress {
 public:
  explicit ProgressBar(bool terminal) : terminal_(terminal) {}
  ~ProgressBar() override {
    std::lock_guard lock(mutex_);
    finish_line();
  }

  void begin(std::string_view stage, std::uint64_t total, std::string_view unit) override {
    std::lock_guard lock(mutex_);
    finish_line();
    stage_ = stage;
    unit_ = unit;
    total_ = total;
    done_ = 0;
    start_ = Clock::now();
    last_ = start_;
    if (!terminal_) std::fprintf(stderr, "%s\n", stage_.c_str());
  }

  void advance(std::uint64_t done) override {
    std::lock_guard lock(mutex_);
    done_ += done;
    const auto now = Clock::now();
    const auto every = terminal_ ? std::chrono::milliseconds(100) : std::chrono::milliseconds(10000);
    if (now - last_ < every && done_ < total_) return;
    if (!terminal_ && now - last_ < every) return;
    last_ = now;
    draw(now);
  }

  void note(std::string_view line) override {
    std::lock_guard lock(mutex_);
    finish_line();
    // Warnings quote names from the scene's file.
    std::fprintf(stderr, "%s\n", printable(std::string(line)).c_str());
  }

  bool cancelled() const override { return g_interrupted.load(std::memory_order_relaxed); }

 private:
  void draw(Clock::time_point now) {
    const double seconds = std::chrono::duration<double>(now - start_).count();
    const double share = total_ > 0 ? std::min(1.0, static_cast<double>(done_) / static_cast<double>(total_)) : 0.0;
    const double rate = seconds > 0 ? static_cast<double>(done_) / seconds : 0.0;
    std::string text = stage_;
    if (terminal_) {
      constexpr int kWidth = 28;
      const int full = static_cast<int>(share * kWidth);
      text += "  [" + std::string(static_cast<std::size_t>(full), '=') + std::string(static_cast<std::size_t>(kWidth - full), ' ') + "]";
    }
    char percent[16];
    std::snprintf(percent, sizeof percent, "  %3.0f %%", 100.0 * share);
    text += percent;
    text += "  " + short_number(rate) + unit_ + "/s";
    if (share > 0.0 && share < 1.0) text += "  " + duration(seconds * (1.0 - share) / share) + " left";
    if (terminal_) {
      std::fprintf(stderr, "\r%s\x1b[K", text.c_str());
      open_line_ = true;
    } else {
      std::fprintf(stderr, "%s\n", text.c_str());
    }
  }

  void finish_line() {
    if (!open_line_) return;
    draw(Clock::now());
    std::fputc('\n', stderr);
    open_line_ = false;
  }

  mutable std::mutex mutex_;
  bool terminal_;
  bool open_line_ = false;
  std::string stage_, unit_;
  std::uint64_t total_ = 0, done_ = 0;
  Clock::time_point start_, last_;
};

// --quiet: silent, but Ctrl-C still ends the work in order.
class QuietProgress final : public Progress {
 public:
  void begin(std::string_view, std::uint64_t, std::string_view) override {}
  void advance(std::uint64_t) override {}
  void note(std::string_view) override {}
  bool cancelled() const override { return g_interrupted.load(std::memory_order_relaxed); }
};

}  // namespace

std::unique_ptr<Progress> make_progress(const CommonOptions& common) {
  if (common.quiet) return std::make_unique<QuietProgress>();
  return std::make_unique<ProgressBar>(isatty(STDERR_FILENO) != 0);
}

}  // namespace probewalk
