#include "xr/latency/gate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "content/error.h"
#include "xr/latency/synthetic_run.h"

namespace probewalk {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Run a_run(std::size_t frames, std::size_t late = 0, LedgerOptions options = {}) {
  Run run{"run", {}, Ledger(options)};
  for (std::size_t i = 0; i < frames; ++i) {
    FrameRecord frame = synthetic_frame(i);
    if (i >= frames - late) delay(frame, 3 * kPeriod);
    frame.pose_error_mm = 0.5;
    frame.streaming_ns = 50'000;
    frame.device_bytes = 3 << 20;
    frame.level_shown = i % 10 == 0 ? 0 : 1;
    run.ledger.add(frame);
  }
  return run;
}

std::vector<std::string> failures(const char* gate, const Run& run) {
  std::vector<std::string> texts;
  for (const GateResult& result : judge_gate(parse_gate(gate), run, run.ledger.summary())) {
    if (!result.holds) texts.push_back(failure_text(result));
  }
  return texts;
}
std::vector<std::string> failures(const char* gate, std::size_t frames, std::size_t late = 0) {
  return failures(gate, a_run(frames, late));
}

TEST(Gate, HoldsAtItsLimitAndNotBelow) {
  EXPECT_THAT(failures("max=10ms,missed=0,cpu_busy.p99=4.05ms,pose_error_mm.max=0.5mm", 200), IsEmpty());
  EXPECT_THAT(failures("max=9.99ms", 200), ElementsAre(HasSubstr("frame.max = 10 ms, more than 9.99 ms")));
  EXPECT_THAT(failures("p99=10.2ms, gpu_busy.p95=3900us,missed=0", 200, 50),
              ElementsAre(HasSubstr("gpu_busy.p95"), HasSubstr("missed = 3, more than 0")));
  EXPECT_THAT(failures("stale_run=3,discarded=0,not_rendered=0", 200, 50), IsEmpty());
  EXPECT_THAT(failures("stale_run_max=2", 200, 50), ElementsAre("stale_run = 3, more than 2"));
}

TEST(Gate, AsksForTheLeastOfWhatThereShouldBeMuchOf) {
  // Every margin is 8 ms.
  EXPECT_THAT(failures("deadline_margin.p1=7.9ms,deadline_margin.min=8ms,within_budget=100%,frames=200", 200),
              IsEmpty());
  EXPECT_THAT(failures("deadline_margin.min=8.1ms,frames=201,within_budget_fraction=1", 200),
              ElementsAre("deadline_margin.min = 8 ms, less than 8.1 ms", "frames = 200, less than 201"));
  auto over = a_run(200);
  FrameRecord slow = synthetic_frame(200);
  slow.gpu.end += 20 * kMs;
  over.ledger.add(slow);
  EXPECT_THAT(failures("within_budget=0.995", over), IsEmpty());
  EXPECT_THAT(failures("within_budget=99.9%", over),
              ElementsAre(HasSubstr("within_budget = 99.5 %, less than 99.9 %")));
}

TEST(Gate, KnowsStreaming) {
  auto run = a_run(200);
  for (int i = 0; i < 100; ++i) run.info.streaming.need_to_resident_ns.push_back((10 + i / 98 * 90) * kMs);
  run.info.instrumentation_cost_fraction = 0.004;
  EXPECT_THAT(failures("coarse=10%,coarse_frame_fraction=0.1,need_to_resident.p50=10.1ms,frame_thread.p99=51us,"
                       "device_bytes=3MiB,clock_error=20ns,instrumentation_cost=0.5%,need_to_resident.max=0.1s",
                       run),
              IsEmpty());
  EXPECT_THAT(
      failures("coarse=9.9%,need_to_resident_p99_ns=90ms,frame_thread_p99_ns=40us,device_bytes_max=2.9MiB", run),
      ElementsAre("coarse = 10 %, more than 9.9 %", HasSubstr("need_to_resident.p99 = 1"),
                  HasSubstr("frame_thread.p99 = 0.05"), HasSubstr("device_bytes = 3.0 MiB, more than 2.9 MiB")));
}

TEST(Gate, FailsWhatItCannotJudgeAndSaysWhy) {
  EXPECT_THAT(failures("p99=1s", 50),
              ElementsAre(HasSubstr("frame.p99 cannot be judged: n = 49 is too small, it needs 100")));
  EXPECT_THAT(failures("p99.9=1s", 500), ElementsAre(HasSubstr("frame.p999 cannot be judged")));
  EXPECT_THAT(failures("frame.p99.9=1s", 500), ElementsAre(HasSubstr("frame.p999 cannot be judged")));
  EXPECT_THAT(failures("pose_error_deg.max=1", 500),
              ElementsAre(HasSubstr("pose_error_deg.max cannot be judged: not")));
  EXPECT_THAT(failures("need_to_resident.p99=1s,instrumentation_cost=1%", 500),
              ElementsAre(HasSubstr("no level had to be waited for"), HasSubstr("was not measured")));
  EXPECT_THAT(failures("frame_thread.p99=1s,deadline_margin.p1=0ms", 50),
              ElementsAre(HasSubstr("needs 100"), HasSubstr("needs 100")));
  const auto fixed_clock = a_run(200, 0, {.has_deadlines = false});
  EXPECT_THAT(failures("deadline_margin.min=0ms,prediction_horizon.p50=1s", fixed_clock),
              ElementsAre(HasSubstr("does not exist"), HasSubstr("does not exist")));
  // Nothing missed where nothing can be is true, and said.
  const auto results = judge_gate(parse_gate("missed=0"), fixed_clock, fixed_clock.ledger.summary());
  EXPECT_TRUE(results[0].holds);
  EXPECT_THAT(results[0].note, HasSubstr("no deadlines"));
  EXPECT_THAT(failures("max=1s,within_budget=0", a_run(0)), ElementsAre(HasSubstr("cannot"), HasSubstr("cannot")));
}

std::string refusal(const char* gate) {
  try {
    parse_gate(gate);
  } catch (const BadUsage& error) {
    return error.what();
  }
  return "";
}

TEST(Gate, RefusesWhatIsNoConditionAndListsWhatIs) {
  for (const char* text :
       {"", "p99", "p99=", "p99=11.1", "p99=11.1m", "p42=1ms", "missed=0ms", "speed.p99=1ms", "missed=0,", "p99=nanms",
        "p99=1ms;missed=0", "pose_error_mm.p50=1ms", "=1", "deadline_margin.p99=1ms", "coarse=1ms", "device_bytes=3"}) {
    EXPECT_NE(refusal(text), "") << text;
  }
  EXPECT_THAT(refusal("speed=1"),
              AllOf(HasSubstr("'speed'"), HasSubstr("frame.p50|p90|p95|p99|p999|max, cpu_busy.p50|"),
                    HasSubstr("deadline_margin.p50|p10|p5|p1|p0.1|min"), HasSubstr("missed, stale_run"),
                    HasSubstr("need_to_resident.p50|p99|max"), HasSubstr("frame_thread.p99, device_bytes")));
  EXPECT_THAT(refusal("p99=11.1"), AllOf(HasSubstr("frame.p99"), HasSubstr("ns, us, ms, s")));
  EXPECT_THAT(gate_names_help(), AllOf(HasSubstr("within_budget"), HasSubstr("at least")));
}

}  // namespace
}  // namespace probewalk
