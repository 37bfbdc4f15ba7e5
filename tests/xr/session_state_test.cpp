#include "xr/session_state.h"

#include <gtest/gtest.h>

#include <vector>

namespace probewalk {
namespace {

// What a scripted runtime sends, what the session owes it, and what the frame loop sees then.
struct Step {
  XrSessionState event;
  SessionDuty duty;
  SourceState state;
};

void play(SessionState& session, const std::vector<Step>& script) {
  for (std::size_t i = 0; i < script.size(); ++i) {
    SCOPED_TRACE(testing::Message() << "step " << i << ": " << session_state_name(script[i].event));
    EXPECT_EQ(session.on_change(script[i].event), script[i].duty);
    EXPECT_EQ(session.source_state(), script[i].state);
  }
}

TEST(SessionState, RunsFromReadyToStoppingAndEndsWithExiting) {
  SessionState session;
  EXPECT_EQ(session.source_state(), SourceState::kIdle);
  play(session, {{XR_SESSION_STATE_IDLE, SessionDuty::kNone, SourceState::kIdle},
                 {XR_SESSION_STATE_READY, SessionDuty::kBegin, SourceState::kRunning},
                 {XR_SESSION_STATE_SYNCHRONIZED, SessionDuty::kNone, SourceState::kRunning},
                 {XR_SESSION_STATE_VISIBLE, SessionDuty::kNone, SourceState::kRunning},
                 {XR_SESSION_STATE_FOCUSED, SessionDuty::kNone, SourceState::kRunning},
                 {XR_SESSION_STATE_VISIBLE, SessionDuty::kNone, SourceState::kRunning},
                 {XR_SESSION_STATE_SYNCHRONIZED, SessionDuty::kNone, SourceState::kRunning},
                 {XR_SESSION_STATE_STOPPING, SessionDuty::kEnd, SourceState::kIdle},
                 {XR_SESSION_STATE_IDLE, SessionDuty::kNone, SourceState::kIdle},
                 {XR_SESSION_STATE_EXITING, SessionDuty::kNone, SourceState::kFinished}});
  EXPECT_TRUE(session.was_ever_focused());
  EXPECT_FALSE(session.focused());
}

TEST(SessionState, OnlyFocusedSessionsGetInput) {
  SessionState session;
  for (const XrSessionState state :
       {XR_SESSION_STATE_IDLE, XR_SESSION_STATE_READY, XR_SESSION_STATE_SYNCHRONIZED, XR_SESSION_STATE_VISIBLE}) {
    session.on_change(state);
    EXPECT_FALSE(session.focused());
  }
  session.on_change(XR_SESSION_STATE_FOCUSED);
  EXPECT_TRUE(session.focused());
}

TEST(SessionState, BeginsAgainAfterTheHeadsetWasTakenOff) {
  SessionState session;
  play(session, {{XR_SESSION_STATE_READY, SessionDuty::kBegin, SourceState::kRunning},
                 {XR_SESSION_STATE_STOPPING, SessionDuty::kEnd, SourceState::kIdle},
                 {XR_SESSION_STATE_IDLE, SessionDuty::kNone, SourceState::kIdle},
                 {XR_SESSION_STATE_READY, SessionDuty::kBegin, SourceState::kRunning}});
}

TEST(SessionState, NeverBeginsOrEndsTwice) {
  SessionState session;
  play(session, {{XR_SESSION_STATE_STOPPING, SessionDuty::kNone, SourceState::kIdle},
                 {XR_SESSION_STATE_READY, SessionDuty::kBegin, SourceState::kRunning},
                 {XR_SESSION_STATE_READY, SessionDuty::kNone, SourceState::kRunning},
                 {XR_SESSION_STATE_STOPPING, SessionDuty::kEnd, SourceState::kIdle},
                 {XR_SESSION_STATE_STOPPING, SessionDuty::kNone, SourceState::kIdle}});
}

TEST(SessionState, LossIsFinalAndOwesNothing) {
  SessionState session;
  play(session, {{XR_SESSION_STATE_READY, SessionDuty::kBegin, SourceState::kRunning},
                 {XR_SESSION_STATE_LOSS_PENDING, SessionDuty::kNone, SourceState::kLost},
                 {XR_SESSION_STATE_STOPPING, SessionDuty::kNone, SourceState::kLost},
                 {XR_SESSION_STATE_READY, SessionDuty::kNone, SourceState::kLost}});
}

TEST(SessionState, CallThatReportsLossEndsTheSessionToo) {
  SessionState session;
  session.on_change(XR_SESSION_STATE_READY);
  session.on_lost();
  EXPECT_EQ(session.source_state(), SourceState::kLost);
}

TEST(SessionState, UnknownFutureStatesChangeNothing) {
  SessionState session;
  session.on_change(XR_SESSION_STATE_READY);
  EXPECT_EQ(session.on_change(static_cast<XrSessionState>(4711)), SessionDuty::kNone);
  EXPECT_EQ(session.source_state(), SourceState::kRunning);
}

}  // namespace
}  // namespace probewalk
