#include "tools/probewalk/patience.h"

#include <cstdio>
#include <cstdlib>
#include <utility>

#include "content/error.h"

namespace probewalk {

using Clock = std::chrono::steady_clock;

Patience::Patience(Progress& shown, std::chrono::seconds limit)
    : shown_(shown),
      limit_(limit),
      last_(Clock::now().time_since_epoch().count()),
      watcher_([this](std::stop_token stop) { watch(stop); }) {}

void Patience::doing(std::string what) {
  const std::lock_guard lock(mutex_);
  what_ = std::move(what);
}

void Patience::begin(std::string_view stage, std::uint64_t total, std::string_view unit) {
  last_ = Clock::now().time_since_epoch().count();
  shown_.begin(stage, total, unit);
}

void Patience::advance(std::uint64_t done) {
  last_ = Clock::now().time_since_epoch().count();
  shown_.advance(done);
}

void Patience::watch(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    asleep_.wait_for(lock, stop, std::chrono::seconds(1), [] { return false; });
    const Clock::duration still = Clock::now().time_since_epoch() - Clock::duration(last_.load());
    if (still < limit_) continue;
    std::fprintf(stderr, "\nprobewalk: nothing has come of %s for %lld s: it does not end\n", what_.c_str(),
                 static_cast<long long>(limit_.count()));
    std::_Exit(static_cast<int>(ExitCode::kCheckFailed));
  }
}

}  // namespace probewalk
