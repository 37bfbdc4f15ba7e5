// What each kind of controller does to the wearer. Monado simulates simple and Windows Mixed Reality controllers, whose
// buttons nobody presses, and its runtime takes bindings for all kinds: a layer in front of it (tests/openxr_layer)
// presses the inputs, which our own table of bindings (openxr_bindings.cpp) brings to actions. hands_test.cpp does the
// same with a Valve Index that Monado really has pressed. Skipped, with the reason, where Monado is not installed.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tools/scripted_walk.h"

namespace probewalk::test {
namespace {

using testing::HasSubstr;

constexpr std::uint64_t kTeleport = 40, kTurn = 70, kMove = 85, kStep = 105, kMenu = 115, kEnd = 140;  // frames

struct Profile {
  std::string path, name;      // of the OpenXR profile; as we call it
  std::string teleport;        // inputs, "trigger/value"; empty = it has none
  std::string stick, pressed;  // what must be pressed for the stick to count, if anything
  std::string menu;
  std::string simulated;  // what Monado has in both hands
  bool is_real;           // Monado itself says that it is this profile; else the layer does
};

void PrintTo(const Profile& profile, std::ostream* out) {
  *out << profile.path;
}

// A teleport by the right hand, a snap to the right, half a second forward, half a metre aside on foot, back by menu.
std::string script_for(const Profile& profile) {
  std::vector<std::string> inputs;
  const auto press = [&](const std::string& input, std::uint64_t from, std::uint64_t until, const std::string& value) {
    if (input.substr(input.find('/') + 1).empty()) return;
    inputs.push_back(fmt::format("{}:{}:{}", from, input, value));
    inputs.push_back(fmt::format("{}:{}:0", until, input));
  };
  press("right/" + profile.teleport, kTeleport, kTeleport + 5, "0.9");
  press("right/" + profile.stick, kTurn, kTurn + 5, "1 0");
  press("right/" + profile.pressed, kTurn, kTurn + 5, "1");
  press("left/" + profile.stick, kMove, kMove + 10, "0 1");
  press("left/" + profile.pressed, kMove, kMove + 10, "1");
  // Touched and not pressed, a pad does nothing.
  if (!profile.pressed.empty()) press("left/" + profile.stick, kMenu + 12, kMenu + 16, "0 1");
  press("left/" + profile.menu, kMenu, kMenu + 2, "1");
  std::string text = fmt::format("still=1;aim_pitch_deg=-30;step={}:0.5", kStep);
  if (!profile.is_real) text += ";profile=" + profile.path;
  text += ";inputs=";
  for (const std::string& input : inputs) text += input + ",";
  text.pop_back();
  return text;
}

// Where the head was at that frame of the layer's.
glm::dvec3 place(const ScriptedWalk& walk, const Path& path, std::uint64_t frame, double* yaw_deg = nullptr) {
  for (const nlohmann::json& ended : walk.ended) {
    if (ended["frame"] != frame) continue;
    const PathPose* pose = pose_of(path, walk, ended);
    if (pose == nullptr) break;
    const glm::dvec3 ahead = pose->orientation * glm::dvec3(0, 0, -1);
    if (yaw_deg != nullptr) *yaw_deg = glm::degrees(std::atan2(-ahead.x, -ahead.z));
    return pose->position_m;
  }
  ADD_FAILURE() << "frame " << frame << " was not drawn";
  return {};
}

class HandProfiles : public testing::TestWithParam<Profile> {};

TEST_P(HandProfiles, DoToTheWearerWhatTheHelpSays) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const Profile& profile = GetParam();
  const ScriptedWalk walk =
      walk_by_script("hand-profiles-" + std::filesystem::path(profile.path).filename().string(), script_for(profile),
                     fmt::format("--frames {} --record walked.jsonl --turn 45", kEnd),
                     fmt::format("export SIMULATED_LEFT={0} SIMULATED_RIGHT={0}\n", profile.simulated));
  ASSERT_EQ(walk.walk.run.exit_code, 0) << walk.walk.run.err;
  EXPECT_THAT(walk.walk.run.err, HasSubstr("right hand: " + profile.name + ":"));
  EXPECT_THAT(walk.walk.run.err, HasSubstr("left hand: " + profile.name + ":"));
  const Path path = read_path(walk.folder / "walked.jsonl");
  const auto flat = [](glm::dvec3 from, glm::dvec3 to) { return glm::dvec2(to.x - from.x, to.z - from.z); };

  const glm::dvec3 start = place(walk, path, kTeleport - 1);
  EXPECT_LT(glm::length(flat({-1.0, 1.6, 1.2}, start)), 1e-3) << "the pack's start";
  const glm::dvec3 thrown = place(walk, path, kTurn - 1);
  if (profile.teleport.empty()) {
    EXPECT_LT(glm::length(flat(start, thrown)), 1e-3);
  } else {
    EXPECT_GT(glm::length(flat(start, thrown)), 1.5) << "a throw of 8 m/s, 30 degrees down, from 1.3 m";
    EXPECT_LT(glm::length(flat(start, thrown)), 2.7);
  }
  double before_deg = 0.0, after_deg = 0.0;
  place(walk, path, kTurn - 1, &before_deg);
  const glm::dvec3 turned = place(walk, path, kMove - 1, &after_deg);
  EXPECT_LT(glm::length(flat(thrown, turned)), 1e-3) << "turns go about the head";
  EXPECT_NEAR(std::remainder(after_deg - before_deg, 360.0), profile.stick.empty() ? 0.0 : -45.0, 0.1);
  const glm::dvec3 moved = place(walk, path, kStep - 1);
  const glm::dvec2 way = flat(turned, moved);
  if (profile.stick.empty()) {
    EXPECT_LT(glm::length(way), 1e-3);
  } else {
    EXPECT_GT(glm::length(way), 0.2) << "ten frames of at most a tenth of a second, at 1.4 m/s";
    EXPECT_LT(glm::length(way), 1.5);
    EXPECT_NEAR(std::remainder(glm::degrees(std::atan2(-way.x, -way.y)) - after_deg, 360.0), 0.0, 2.0)
        << "where the head looks";
  }
  const glm::dvec3 aside = place(walk, path, kMenu - 1);
  EXPECT_NEAR(glm::length(flat(moved, aside)), 0.5, 1e-3) << "on foot";
  const glm::dvec3 end = place(walk, path, kEnd - 2);
  EXPECT_NEAR(glm::length(flat(moved, end)), profile.menu.empty() ? 0.5 : 0.0, 1e-3) << "back, by menu";
}

INSTANTIATE_TEST_SUITE_P(Each, HandProfiles,
                         testing::Values(Profile{"khr/simple_controller", "simple controller", "select/click", "", "",
                                                 "menu/click", "simple", true},
                                         Profile{"microsoft/motion_controller", "Windows Mixed Reality",
                                                 "trigger/value", "thumbstick", "", "menu/click", "wmr", true},
                                         Profile{"oculus/touch_controller", "Oculus Touch", "trigger/value",
                                                 "thumbstick", "", "menu/click", "simple", false},
                                         Profile{"valve/index_controller", "Valve Index", "trigger/value", "thumbstick",
                                                 "", "b/click", "simple", false},
                                         Profile{"htc/vive_controller", "HTC Vive", "trigger/value", "trackpad",
                                                 "trackpad/click", "menu/click", "simple", false},
                                         Profile{"ext/hand_interaction_ext", "bare hands", "aim_activate_ext/value", "",
                                                 "", "", "simple", false}),
                         [](const auto& each) {
                           std::string name = each.param.path;
                           std::ranges::replace(name, '/', '_');
                           return name;
                         });

}  // namespace
}  // namespace probewalk::test
