// Where a headset's floor is, in runtimes that offer fewer reference spaces than Monado does, and what becomes of the
// view when a space changes: a layer in front of Monado (tests/openxr_layer) plays such runtimes. Skipped, with the
// reason, where Monado is not installed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tools/scripted_walk.h"

namespace probewalk::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

TEST(OpenXrSpaces, EyesStandWhereTheBestSpaceThereIsSays) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  struct Case {
    std::string offered, space, words;
    bool knows_floor;  // else what is stated of the eyes holds
  };
  const std::vector<Case> cases{
      {"LOCAL,LOCAL_FLOOR,STAGE", "LOCAL_FLOOR", "space LOCAL_FLOOR,", true},
      {"LOCAL,STAGE", "STAGE", "space STAGE,", true},
      {"LOCAL", "LOCAL", "space LOCAL, eyes at rest 1.75 m over the floor,", false},
  };
  for (const Case& expected : cases) {
    SCOPED_TRACE(expected.space);
    const ScriptedWalk walk = walk_by_script("openxr-spaces-" + expected.space, "spaces=" + expected.offered,
                                             "--frames 40 --record walked.jsonl --eye-height 1.75");
    ASSERT_EQ(walk.walk.run.exit_code, 0) << walk.walk.run.err;
    EXPECT_THAT(walk.walk.run.err, HasSubstr(expected.words));
    EXPECT_THAT(walk.walk.summary["display_details"].get<std::string>(), HasSubstr(expected.words));
    EXPECT_NE(read_text(walk.folder / "report" / "index.html").find(expected.words), std::string::npos);
    const Path path = read_path(walk.folder / "walked.jsonl");
    std::size_t compared = 0;
    double lowest_m = 1e9, highest_m = -1e9;
    for (const json& ended : walk.ended) {
      const PathPose* pose = pose_of(path, walk, ended);
      if (pose == nullptr) continue;
      EXPECT_EQ(ended["space"], expected.space);
      // The pack's floor is at 0. Where none is known, the head rests where LOCAL begins.
      const double knows_m = ended["head_over_floor_m"].get<double>();
      const double raised_m = expected.knows_floor ? 0.0 : 1.75 - ended["rest_over_floor_m"].get<double>();
      EXPECT_NEAR(pose->position_m.y, knows_m + raised_m, 1e-4) << "frame " << ended["frame"];
      lowest_m = std::min(lowest_m, knows_m);
      highest_m = std::max(highest_m, knows_m);
      ++compared;
    }
    EXPECT_GT(compared, 25u);
    EXPECT_GT(highest_m - lowest_m, 0.005) << "the head keeps its height: nothing was compared but its rest";
  }
}

// The recorded head's longest step, less what the simulated headset's own swaying may be.
double longest_step_m(const Path& path) {
  double longest_m = 0.0;
  for (std::size_t i = 1; i < path.poses.size(); ++i) {
    const PathPose &before = path.poses[i - 1], &pose = path.poses[i];
    longest_m = std::max(longest_m, glm::distance(pose.position_m, before.position_m) - 0.6 * (pose.t_s - before.t_s));
  }
  return longest_m;
}

// Of the poses that the layer saw shown, in the runtime's own space.
int jumps_shown(const ScriptedWalk& walk) {
  int jumps = 0;
  const json* before = nullptr;
  for (const json& ended : walk.ended) {
    if (ended["views"].empty()) continue;
    if (before != nullptr) {
      jumps += glm::distance(position_of(ended["views"][0]), position_of((*before)["views"][0])) > 0.7 ? 1 : 0;
    }
    before = &ended;
  }
  return jumps;
}

struct Recentred {
  ScriptedWalk walk;
  Path path;
};

Recentred walk_recentred(const std::string& name, const std::string& script) {
  Recentred result{walk_by_script("openxr-spaces-" + name, script, "--frames 50 --record walked.jsonl"), {}};
  EXPECT_EQ(result.walk.walk.run.exit_code, 0) << result.walk.walk.run.err;
  result.path = read_path(result.walk.folder / "walked.jsonl");
  EXPECT_GT(result.path.poses.size(), 35u);
  return result;
}

TEST(OpenXrSpaces, AChangeAtOnceLeavesTheViewWhereItIs) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const Recentred run = walk_recentred("at-once",
                                       "jump=14:LOCAL_FLOOR:1:0,19:LOCAL_FLOOR:-1:0,24:LOCAL_FLOOR:1:0,"
                                       "29:LOCAL_FLOOR:-1:0,34:LOCAL_FLOOR:1:0,39:LOCAL_FLOOR:-1:0");
  EXPECT_EQ(jumps_shown(run.walk), 6);
  EXPECT_LT(longest_step_m(run.path), 0.05);
  // What was drawn before is not held against what the runtime says of it in the space as it is now.
  std::size_t measured = 0;
  for (const FrameRecord& frame : run.walk.walk.frames) {
    if (frame.pose_answer != PoseAnswer::kMeasured) continue;
    ++measured;
    EXPECT_LT(frame.pose_error_mm, 1.0) << frame.frame_id;
  }
  EXPECT_GT(measured, 5u);
}

TEST(OpenXrSpaces, OneChangeBeforeAnotherOneHasComeIsNotForgotten) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const Recentred run = walk_recentred("twice", "jump=15:LOCAL_FLOOR:1:200,16:LOCAL_FLOOR:1:700");
  EXPECT_EQ(jumps_shown(run.walk), 2);
  EXPECT_LT(longest_step_m(run.path), 0.05);
}

// Another space's origin moves, and at that moment the wearer makes a long step: that is the wearer's own.
TEST(OpenXrSpaces, AChangeOfAnotherSpaceIsNoneOfOurs) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  for (const std::string when : {"0", "200"}) {
    const Recentred run = walk_recentred("other-" + when, "jump=20:STAGE:1:" + when);
    EXPECT_EQ(jumps_shown(run.walk), 1);
    EXPECT_NEAR(longest_step_m(run.path), 1.0, 0.1);
  }
}

// The same for who stands in STAGE: LOCAL_FLOOR is another one then.
TEST(OpenXrSpaces, OursIsTheOneThatWasTaken) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const Recentred own = walk_recentred("stage-own", "spaces=LOCAL,STAGE;jump=20:STAGE:1:0");
  EXPECT_EQ(jumps_shown(own.walk), 1);
  EXPECT_LT(longest_step_m(own.path), 0.05);
  const Recentred other = walk_recentred("stage-other", "spaces=LOCAL,STAGE;jump=20:LOCAL:1:0");
  EXPECT_NEAR(longest_step_m(other.path), 1.0, 0.1);
}

}  // namespace
}  // namespace probewalk::test
