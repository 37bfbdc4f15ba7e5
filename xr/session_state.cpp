#include "xr/session_state.h"

namespace probewalk {

SessionDuty SessionState::on_change(XrSessionState next) {
  current_ = next;
  switch (next) {
    case XR_SESSION_STATE_READY:
      // A second READY without STOPPING would begin a session twice.
      if (running_ || finished_ || lost_) return SessionDuty::kNone;
      running_ = true;
      return SessionDuty::kBegin;
    case XR_SESSION_STATE_STOPPING:
      if (!running_) return SessionDuty::kNone;
      running_ = false;
      return SessionDuty::kEnd;
    case XR_SESSION_STATE_EXITING:
      running_ = false;
      finished_ = true;
      return SessionDuty::kNone;
    case XR_SESSION_STATE_LOSS_PENDING:
      running_ = false;
      lost_ = true;
      return SessionDuty::kNone;
    case XR_SESSION_STATE_FOCUSED:
      was_focused_ = true;
      return SessionDuty::kNone;
    default:
      return SessionDuty::kNone;
  }
}

SourceState SessionState::source_state() const {
  if (lost_) return SourceState::kLost;
  if (finished_) return SourceState::kFinished;
  return running_ ? SourceState::kRunning : SourceState::kIdle;
}

const char* session_state_name(XrSessionState state) {
  switch (state) {
    case XR_SESSION_STATE_IDLE:
      return "IDLE";
    case XR_SESSION_STATE_READY:
      return "READY";
    case XR_SESSION_STATE_SYNCHRONIZED:
      return "SYNCHRONIZED";
    case XR_SESSION_STATE_VISIBLE:
      return "VISIBLE";
    case XR_SESSION_STATE_FOCUSED:
      return "FOCUSED";
    case XR_SESSION_STATE_STOPPING:
      return "STOPPING";
    case XR_SESSION_STATE_LOSS_PENDING:
      return "LOSS_PENDING";
    case XR_SESSION_STATE_EXITING:
      return "EXITING";
    default:
      return "UNKNOWN";
  }
}

}  // namespace probewalk
