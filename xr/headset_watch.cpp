#include "xr/headset_watch.h"

#include <chrono>
#include <condition_variable>

#include "content/error.h"
#include "xr/openxr_instance.h"

namespace probewalk {
namespace {

// A runtime that has just gone needs a moment before it can come back; one that stays away is asked less often.
constexpr std::chrono::milliseconds kFirstPause{500};
constexpr std::chrono::milliseconds kLongestPause{4000};

}  // namespace

HeadsetWatch::HeadsetWatch() : thread_([this](const std::stop_token& stop) { look_out(stop); }) {}

HeadsetWatch::~HeadsetWatch() = default;

void HeadsetWatch::look_out(const std::stop_token& stop) {
  std::condition_variable_any wake;
  std::mutex sleeping;
  for (auto pause = kFirstPause; !stop.stop_requested(); pause = std::min(2 * pause, kLongestPause)) {
    std::unique_lock lock(sleeping);
    wake.wait_for(lock, stop, pause, [] { return false; });
    if (stop.stop_requested()) return;
    try {
      auto instance = std::make_unique<OpenXrInstance>();
      const std::scoped_lock found(mutex_);
      found_ = std::move(instance);
      is_there_ = true;
      return;
    } catch (const NoDevice&) {
      // Not yet.
    }
  }
}

std::unique_ptr<OpenXrInstance> HeadsetWatch::take() {
  const std::scoped_lock lock(mutex_);
  return std::move(found_);
}

}  // namespace probewalk
