// The ledger against the runtime's own books: Monado writes what its service saw of each frame, and every stamp of it
// must lie inside the call that we say it was made in.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <map>

#include "support/monado_metrics.h"
#include "tools/monado_walk.h"

namespace probewalk::test {
namespace {

namespace fs = std::filesystem;

// Stamps of one kind: how long before the call's leave they were taken, and by how much they lay outside of it.
struct TimePoint {
  const char* name;
  std::vector<std::int64_t> after_enter, before_leave;
  std::int64_t outside_max = 0;
  std::size_t outside = 0;

  void add(std::int64_t stamp, const Interval& call, std::int64_t error_ns) {
    after_enter.push_back(stamp - call.begin);
    before_leave.push_back(call.end - stamp);
    const std::int64_t by = std::max(call.begin - stamp, stamp - call.end);
    outside_max = std::max(outside_max, by);
    outside += by > error_ns ? 1 : 0;
  }
};

std::int64_t rank(std::vector<std::int64_t> values, double p) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(p * static_cast<double>(values.size() - 1) + 0.5)];
}

void print(const TimePoint& point, const char* call) {
  std::printf("  %-10s in %-12s %5zu   %9.3f %9.3f %9.3f   %9.3f %9.3f %9.3f   %7zu %9.3f\n", point.name, call,
              point.before_leave.size(), 1e-6 * static_cast<double>(rank(point.after_enter, 0.5)),
              1e-6 * static_cast<double>(rank(point.after_enter, 0.99)),
              1e-6 * static_cast<double>(rank(point.after_enter, 1.0)),
              1e-6 * static_cast<double>(rank(point.before_leave, 0.5)),
              1e-6 * static_cast<double>(rank(point.before_leave, 0.99)),
              1e-6 * static_cast<double>(rank(point.before_leave, 1.0)), point.outside,
              1e-6 * static_cast<double>(point.outside_max));
}

TEST(MonadoRecords, AgreeWithTheLedgerFrameByFrame) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const fs::path folder = fresh_folder("monado-records");
  constexpr std::size_t kFrames = 200;
  const MonadoWalk walk =
      walk_in_monado(folder, "export XRT_METRICS_FILE=$PWD/metrics XRT_METRICS_EARLY_FLUSH=1 IPC_EXIT_ON_DISCONNECT=1",
                     "--frames " + std::to_string(kFrames));
  ASSERT_EQ(walk.run.exit_code, 0) << walk.run.err;
  ASSERT_EQ(walk.frames.size(), kFrames);
  std::map<std::int64_t, MonadoFrame> theirs;
  std::size_t theirs_discarded = 0;
  for (const MonadoFrame& frame : read_monado_metrics(read_text(folder / "metrics"))) {
    theirs_discarded += frame.discarded ? 1 : 0;
    theirs.emplace(frame.predicted_display_ns, frame);
  }

  TimePoint woke{"woke", {}, {}}, began{"began", {}, {}}, delivered{"delivered", {}, {}};
  std::vector<std::int64_t> gpu_done;  // after our gpu_end
  std::size_t matched = 0, unmatched = 0, gpu_too_early = 0;
  std::int64_t clock_error_ns = 0;
  for (const FrameRecord& frame : walk.frames) {
    const auto their = theirs.find(frame.predicted_display);
    if (their == theirs.end()) {
      ++unmatched;
      continue;
    }
    ++matched;
    // Stamps of both sides come from one clock; that of the device is brought onto it.
    if (frame.should_render) clock_error_ns = std::max(clock_error_ns, frame.clock_deviation_ns);
    const MonadoFrame& stamps = their->second;
    woke.add(stamps.woke_ns, frame.runtime_wait, frame.clock_deviation_ns);
    began.add(stamps.began_ns, frame.begin, frame.clock_deviation_ns);
    // Ended without layers, a frame is one that they discard.
    EXPECT_EQ(stamps.discarded, !frame.should_render);
    if (stamps.discarded || !frame.should_render) continue;
    delivered.add(stamps.delivered_ns, frame.end, frame.clock_deviation_ns);
    EXPECT_TRUE(frame.clock_calibrated);
    EXPECT_GT(frame.gpu.end, 0);
    gpu_done.push_back(stamps.gpu_done_ns - frame.gpu.end);
    gpu_too_early += gpu_done.back() < -frame.clock_deviation_ns ? 1 : 0;
  }
  std::printf("frames %zu, matched %zu, unmatched %zu; Monado's own: %zu, discarded %zu; clock error %lld ns\n",
              walk.frames.size(), matched, unmatched, theirs.size(), theirs_discarded,
              static_cast<long long>(clock_error_ns));
  std::printf(
      "  Monado's                    frames    after enter, ms: p50 p99 max     before leave, ms: p50 p99 max"
      "   outside by at most, ms\n");
  print(woke, "xrWaitFrame");
  print(began, "xrBeginFrame");
  print(delivered, "xrEndFrame");
  std::printf("  gpu_done after our gpu_end: n %zu, p50 %.3f, p99 %.3f, max %.3f, min %.3f ms; too early: %zu\n",
              gpu_done.size(), 1e-6 * static_cast<double>(rank(gpu_done, 0.5)),
              1e-6 * static_cast<double>(rank(gpu_done, 0.99)), 1e-6 * static_cast<double>(rank(gpu_done, 1.0)),
              1e-6 * static_cast<double>(rank(gpu_done, 0.0)), gpu_too_early);
  EXPECT_EQ(unmatched, 0u);
  EXPECT_GT(gpu_done.size(), kFrames - 10);
  EXPECT_EQ(woke.outside, 0u);
  EXPECT_EQ(began.outside, 0u);
  EXPECT_EQ(delivered.outside, 0u);
  EXPECT_EQ(gpu_too_early, 0u);
}

TEST(MonadoRecords, ReaderTakesWhatIsWholeAndLeavesATailThatIsCut) {
  // One session_frame (field 2) with frame_id 300, predicted_display 5, woke 7, discarded; in a record of 13 bytes.
  const std::string message = {0x10, '\xac', 0x02, 0x30, 0x05, 0x50, 0x07, 0x70, 0x01};
  const std::string record = std::string(1, 11) + "\x12\x09" + message;
  const std::string version = std::string(1, 6) + "\x0a\x04\x08\x01\x10\x01";
  const std::string file = version + record + record;
  const auto whole = read_monado_metrics(file);
  ASSERT_EQ(whole.size(), 2u);
  EXPECT_EQ(whole[1].frame_id, 300);
  EXPECT_EQ(whole[1].predicted_display_ns, 5);
  EXPECT_EQ(whole[1].woke_ns, 7);
  EXPECT_EQ(whole[1].delivered_ns, 0);
  EXPECT_TRUE(whole[1].discarded);
  for (std::size_t cut = version.size() + record.size(); cut < file.size(); ++cut) {
    EXPECT_EQ(read_monado_metrics(file.substr(0, cut)).size(), 1u) << cut;
  }
}

}  // namespace
}  // namespace probewalk::test
