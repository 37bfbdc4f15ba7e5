// Sessions that are lost while the runtime's service stays, by whichever call or event says so first: the walk goes on
// offscreen and takes the headset back. A layer in front of Monado (tests/openxr_layer) loses them. Skipped, with the
// reason, where Monado is not installed.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tools/scripted_walk.h"

namespace probewalk::test {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

struct LostWalk {
  ScriptedWalk walk;
  std::string log;
  json changes;  // of displays
};

// Walks until the headset shows frames in session number `last`, then leaves as by Ctrl-C.
LostWalk walk_and_lose(const std::string& name, const std::string& script, std::size_t last) {
  LostWalk lost;
  lost.walk.folder = fresh_folder("openxr-loss-" + name);
  std::ofstream(lost.walk.folder / "walk.sh") << R"sh(
"$@" 2>walk.log &
walk=$!
for _ in $(seq 1200); do
  [ "$(grep -c "\"layers\":1,.*\"session\":$last," layer.jsonl)" -ge 5 ] && break
  kill -0 $walk 2>/dev/null || break
  sleep 0.1
done
kill -INT $walk 2>/dev/null
wait $walk
)sh";
  MonadoWalk& walk = lost.walk.walk;
  walk.run = run_bash(
      lost.walk.folder,
      fmt::format("unset DISPLAY WAYLAND_DISPLAY\nexport PROBEWALK_MONADO_LOG=$PWD/monado.log last={}\n{}\n"
                  "bash '{}/tools/lib/with-monado.sh' null bash walk.sh '{}' walk '{}' --display headset --eye-size "
                  "64x48 --report report --validate",
                  last, behind_script(script), PROBEWALK_SOURCE_DIR, PROBEWALK_EXECUTABLE, small_room().string()));
  lost.log = read_text(lost.walk.folder / "walk.log");
  EXPECT_EQ(walk.run.exit_code, 5) << walk.run.err << lost.log;
  if (walk.run.exit_code != 5) return lost;
  read_book(lost.walk);
  walk.summary = json::parse(read_text(lost.walk.folder / "report" / "summary.json"));
  lost.changes = walk.summary["display_changes"];
  EXPECT_THAT(lost.log, Not(HasSubstr("error:")));
  EXPECT_THAT(lost.log, Not(HasSubstr("VUID")));
  return lost;
}

// `unseen`: of the sessions, from 0, those that were lost before they showed a frame.
void expect_there_and_back(const LostWalk& lost, std::size_t times, const std::vector<std::size_t>& unseen = {}) {
  ASSERT_EQ(lost.changes.size(), 2 * times) << lost.changes << lost.log;
  for (std::size_t k = 0; k < lost.changes.size(); ++k) {
    EXPECT_EQ(lost.changes[k]["from"], k % 2 == 0 ? "headset" : "offscreen");
    EXPECT_EQ(lost.changes[k]["to"], k % 2 == 0 ? "offscreen" : "headset");
    if (k % 2 == 0) continue;  // a busy machine is offscreen too shortly to show anything
    const bool is_seen = std::ranges::find(unseen, (k + 1) / 2) == unseen.end();
    EXPECT_EQ(lost.changes[k]["gap_ns"].get<std::int64_t>() > 0, is_seen) << k;
  }
  ASSERT_FALSE(lost.walk.ended.empty());
  EXPECT_EQ(lost.walk.ended.back()["session"], times + 1);
  EXPECT_FALSE(lost.walk.ended.back()["views"].empty()) << "the headset shows something again";
}

// Every call of a frame, of hands, masks and swapchains.
TEST(OpenXrLoss, OfASessionBringsTheHeadsetBackWhicheverCallSaysSo) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const std::vector<std::string> calls{"xrWaitFrame@12",
                                       "xrBeginFrame@12",
                                       "xrLocateViews@12",
                                       "xrSyncActions@20",
                                       "xrEndFrame@12",
                                       "xrAcquireSwapchainImage@12",
                                       "xrWaitSwapchainImage@12",
                                       "xrReleaseSwapchainImage@12",
                                       "xrBeginSession@0",
                                       "xrGetVisibilityMaskKHR@0",
                                       "xrGetActionStateBoolean@20"};
  const LostWalk lost = walk_and_lose("calls", fmt::format("lose={}", fmt::join(calls, ",")), calls.size() + 1);
  expect_there_and_back(lost, calls.size(), {8, 9});
  EXPECT_NE(read_text(lost.walk.folder / "report" / "index.html").find("left again before its first picture"),
            std::string::npos);
  ASSERT_EQ(lost.walk.lost.size(), calls.size());
  for (std::size_t k = 0; k < calls.size(); ++k) {
    const std::string call = calls[k].substr(0, calls[k].find('@'));
    const json& session = lost.walk.lost[k];
    EXPECT_EQ(session["lost"], call);
    EXPECT_TRUE(session["told"].get<bool>()) << session;
    // Of a wait that is made ahead the frame under way hears last.
    if (call == "xrWaitFrame") continue;
    EXPECT_EQ(session["calls_after"].size(), 0u) << session;
    EXPECT_THAT(lost.log, HasSubstr(fmt::format("({}: XR_ERROR_SESSION_LOST)", call)));
  }
}

TEST(OpenXrLoss, ThatIsAnnouncedOrOfAnotherKindIsTheSame) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const std::vector<std::string> ways{"LOSS_PENDING@15",          "INSTANCE_LOSS_PENDING@15", "xrEndFrame@15@pending",
                                      "xrBeginFrame@15@instance", "xrPollEvent@15@instance",  "xrWaitFrame@15@runtime"};
  const LostWalk lost = walk_and_lose("announced", fmt::format("lose={}", fmt::join(ways, ",")), ways.size() + 1);
  expect_there_and_back(lost, ways.size());
  ASSERT_EQ(lost.walk.lost.size(), ways.size());
  for (const json& session : lost.walk.lost) {
    EXPECT_TRUE(session["told"].get<bool>()) << session;
    if (session["lost"] == "xrWaitFrame") continue;
    EXPECT_EQ(session["calls_after"].size(), 0u) << session;
  }
  EXPECT_THAT(lost.log, HasSubstr("OpenXR session LOSS_PENDING"));
  EXPECT_THAT(lost.log, HasSubstr("the OpenXR runtime is going away"));
  EXPECT_THAT(lost.log, HasSubstr("(xrEndFrame: XR_SESSION_LOSS_PENDING)"));
}

// A runtime that is there again and yet is not: each of these fails once on the way back.
TEST(OpenXrLoss, OnTheWayBackMeansAnotherTry) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const std::vector<std::string> refused{"xrCreateInstance",         "xrGetSystem",       "xrCreateInstance",
                                         "xrCreateSession",          "xrCreateSwapchain", "xrCreateReferenceSpace",
                                         "xrAttachSessionActionSets"};
  const LostWalk lost = walk_and_lose("refused", fmt::format("lose=xrEndFrame@12;refuse={}", fmt::join(refused, ",")),
                                      5);  // three came as far as a session
  ASSERT_FALSE(lost.changes.empty()) << lost.log;
  std::vector<std::string> ways;
  for (const json& change : lost.changes) {
    ways.push_back(change["from"].get<std::string>() + " to " + change["to"].get<std::string>());
  }
  EXPECT_GT(lost.changes.back()["gap_ns"].get<std::int64_t>(), 0);
  // Once a try comes further than to the instance the display is given up for it.
  EXPECT_THAT(ways, ElementsAre("headset to offscreen", "offscreen to offscreen", "offscreen to offscreen",
                                "offscreen to offscreen", "offscreen to offscreen", "offscreen to headset"))
      << lost.log;
  EXPECT_THAT(lost.log, HasSubstr("xrCreateSession failed with XR_ERROR_INITIALIZATION_FAILED"));
  EXPECT_THAT(lost.log, HasSubstr("xrCreateSwapchain failed with XR_ERROR_SESSION_LOST"));
  EXPECT_THAT(lost.log, HasSubstr("xrCreateReferenceSpace failed with XR_ERROR_SESSION_LOST"));
  EXPECT_THAT(lost.log, HasSubstr("xrAttachSessionActionSets failed with XR_ERROR_SESSION_LOST"));
}

}  // namespace
}  // namespace probewalk::test
