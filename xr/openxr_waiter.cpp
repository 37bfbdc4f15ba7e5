#include "xr/openxr_waiter.h"

#include <chrono>
#include <utility>

#include "xr/latency/stopwatch.h"

namespace probewalk {
namespace {

// Many frames of any headset.
constexpr auto kPatience = std::chrono::milliseconds(500);

}  // namespace

OpenXrWaiter::OpenXrWaiter(XrSession session) : session_(session), thread_([this] { wait_for_frames(); }) {}

OpenXrWaiter::~OpenXrWaiter() {
  {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void OpenXrWaiter::ask() {
  {
    std::unique_lock lock(mutex_);
    if (forgotten_) changed_.wait(lock, [this] { return !forgotten_; });
    if (state_ != State::kIdle) return;
    state_ = State::kAsked;
  }
  changed_.notify_all();
}

WaitedFrame OpenXrWaiter::take() {
  ask();
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return state_ == State::kAnswered; });
  state_ = State::kIdle;
  return std::exchange(answer_, {});
}

void OpenXrWaiter::forget() {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, kPatience, [this] { return state_ != State::kAsked; });
  if (state_ == State::kAsked) {
    forgotten_ = true;
  } else {
    state_ = State::kIdle;
  }
}

// On the waiter's thread.
void OpenXrWaiter::wait_for_frames() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return stop_ || state_ == State::kAsked; });
    if (stop_) return;
    lock.unlock();
    WaitedFrame waited;
    const XrFrameWaitInfo info{XR_TYPE_FRAME_WAIT_INFO};
    waited.call = timed([&] { waited.result = xrWaitFrame(session_, &info, &waited.frame); });
    lock.lock();
    answer_ = waited;
    state_ = std::exchange(forgotten_, false) ? State::kIdle : State::kAnswered;
    changed_.notify_all();
  }
}

}  // namespace probewalk
