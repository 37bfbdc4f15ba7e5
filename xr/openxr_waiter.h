// Waits for the next frame while the one before is still drawn: xrWaitFrame, which may be called once xrBeginFrame has
// returned, on a thread of its own.
#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "xr/latency/frame_record.h"
#include "xr/openxr_api.h"

namespace probewalk {

struct WaitedFrame {
  XrResult result = XR_SUCCESS;
  XrFrameState frame{XR_TYPE_FRAME_STATE};
  Interval call;  // enter and leave of xrWaitFrame
};

// All methods on one thread; xrWaitFrame is never called twice at once.
class OpenXrWaiter {
 public:
  // `session` outlives the waiter.
  explicit OpenXrWaiter(XrSession session);
  // Waits for the call under way, if any: the runtime ends it with the session, or with its own going away.
  ~OpenXrWaiter();
  OpenXrWaiter(const OpenXrWaiter&) = delete;
  OpenXrWaiter& operator=(const OpenXrWaiter&) = delete;

  // Begins to wait, unless that has begun already; while the session runs, and after xrBeginFrame of the frame before.
  void ask();
  // The frame that was asked for, once it is there; asks where nobody has.
  WaitedFrame take();
  // Forgets what was asked for. Where xrWaitFrame does not come back for a while, it is left to end with the session.
  void forget();

 private:
  enum class State { kIdle, kAsked, kAnswered };
  void wait_for_frames();

  const XrSession session_;
  std::mutex mutex_;
  std::condition_variable changed_;
  State state_ = State::kIdle;
  bool forgotten_ = false;  // nobody will take what comes
  bool stop_ = false;
  WaitedFrame answer_;
  std::thread thread_;  // last: it uses the others
};

}  // namespace probewalk
