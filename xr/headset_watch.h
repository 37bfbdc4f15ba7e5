// Looks out for a headset that may come (back) while a walk goes on elsewhere.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <thread>

namespace probewalk {

class OpenXrInstance;

// Asks for the runtime on a thread of its own, since a runtime may take its time to say no.
class HeadsetWatch {
 public:
  HeadsetWatch();
  ~HeadsetWatch();
  HeadsetWatch(const HeadsetWatch&) = delete;
  HeadsetWatch& operator=(const HeadsetWatch&) = delete;

  // Whether a runtime with a headset has answered. Cheap; then take() has it.
  bool is_there() const { return is_there_; }
  // The instance that answered, once.
  std::unique_ptr<OpenXrInstance> take();

 private:
  void look_out(const std::stop_token& stop);

  std::mutex mutex_;
  std::unique_ptr<OpenXrInstance> found_;
  std::atomic<bool> is_there_ = false;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace probewalk
