#include "xr/latency/gate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "content/error.h"
#include "xr/latency/synthetic_run.h"

namespace probewalk {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> failures(const char* gate, std::size_t frames, std::size_t late = 0) {
  Ledger ledger;
  for (std::size_t i = 0; i < frames; ++i) {
    FrameRecord frame = synthetic_frame(i);
    if (i >= frames - late) delay(frame, 3 * kPeriod);
    frame.pose_error_mm = 0.5;
    ledger.add(frame);
  }
  return gate_failures(parse_gate(gate), ledger.summary());
}

TEST(Gate, HoldsAtItsLimitAndNotBelow) {
  EXPECT_THAT(failures("max=10ms,missed=0,cpu_busy.p99=4.05ms,pose_error_mm.max=0.5mm", 200), IsEmpty());
  EXPECT_THAT(failures("max=9.99ms", 200), ElementsAre(HasSubstr("frame.max = 10 ms, more than 9.99 ms")));
  EXPECT_THAT(failures("p99=10.2ms,gpu_busy.p95=3900us,missed=0", 200, 50),
              ElementsAre(HasSubstr("gpu_busy.p95"), HasSubstr("missed = 3, more than 0")));
  EXPECT_THAT(failures("stale_run=3,discarded=0", 200, 50), IsEmpty());
}

TEST(Gate, FailsWhatItCannotJudge) {
  EXPECT_THAT(failures("p99=1s", 50), ElementsAre(HasSubstr("n = 49 is too small")));
  EXPECT_THAT(failures("p99.9=1s", 500), ElementsAre(HasSubstr("frame.p999 cannot be judged")));
  EXPECT_THAT(failures("frame.p99.9=1s", 500), ElementsAre(HasSubstr("frame.p999 cannot be judged")));
  EXPECT_THAT(failures("pose_error_deg.max=1", 500), ElementsAre(HasSubstr("pose_error_deg.max cannot be judged")));
}

TEST(Gate, RefusesWhatIsNoCondition) {
  for (const char* text : {"", "p99", "p99=", "p99=11.1", "p99=11.1m", "p42=1ms", "missed=0ms", "speed.p99=1ms",
                           "missed=0,", "p99=nanms", "p99=1ms;missed=0", "pose_error_mm.p50=1ms"}) {
    EXPECT_THROW(parse_gate(text), BadUsage) << text;
  }
}

}  // namespace
}  // namespace probewalk
