// The life of an OpenXR session as a pure state machine: events in, what to do and what the frame loop sees out.
//
//   IDLE -> READY (begin) -> SYNCHRONIZED <-> VISIBLE <-> FOCUSED -> STOPPING (end) -> IDLE -> EXITING
//   any -> LOSS_PENDING, or a call that returned SESSION_LOST or INSTANCE_LOST
#pragma once

#include <openxr/openxr.h>

#include "xr/frame_source.h"

namespace probewalk {

// What the application owes the runtime after a change.
enum class SessionDuty {
  kNone,
  kBegin,  // call xrBeginSession
  kEnd,    // call xrEndSession
};

class SessionState {
 public:
  SessionDuty on_change(XrSessionState next);
  // The runtime is going or gone: nothing may be expected of session or instance any more.
  void on_lost() { lost_ = true; }

  // Lost wins over finished, finished over running; both are final.
  SourceState source_state() const;
  XrSessionState current() const { return current_; }
  // Only a focused session gets input.
  bool focused() const { return current_ == XR_SESSION_STATE_FOCUSED; }
  bool was_ever_focused() const { return was_focused_; }

 private:
  XrSessionState current_ = XR_SESSION_STATE_UNKNOWN;
  bool running_ = false;
  bool finished_ = false;
  bool lost_ = false;
  bool was_focused_ = false;
};

const char* session_state_name(XrSessionState state);

}  // namespace probewalk
