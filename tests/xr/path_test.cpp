#include "xr/path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/resource.h>

#include <csignal>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "content/error.h"

namespace probewalk {
namespace {

using testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180.0;

PathPose pose_with_views(double t_s, double x_m) {
  PathPose pose;
  pose.t_s = t_s;
  pose.position_m = {x_m, 1.6, 0.1};
  pose.orientation = orientation_of(0.3 * t_s, 0.1);
  ViewPose left, right;
  left.position_m = {x_m - 0.0315, 1.6, 0.1};
  left.orientation = pose.orientation;
  left.fov_left_rad = -0.74176493f;
  right = left;
  right.position_m.x += 0.063;
  pose.views = {left, right};
  return pose;
}

std::string refusal(const std::string& text) {
  try {
    parse_path(text, "p.jsonl");
  } catch (const BadInput& error) {
    return error.what();
  }
  return "accepted";
}

const std::string kGood = R"({"t_s":0,"position_m":[0,1.6,0],"orientation_xyzw":[0,0,0,1]})";

TEST(Path, WrittenPosesReadBackBitByBit) {
  const PathPose pose = pose_with_views(1.0 / 3.0, 0.1);
  const Path path = parse_path(path_line(pose) + "\n" + path_line(pose_with_views(1.0, 0.2)) + "\n", "p.jsonl");
  ASSERT_EQ(path.poses.size(), 2u);
  const PathPose& read = path.poses[0];
  EXPECT_EQ(read.t_s, pose.t_s);
  EXPECT_EQ(read.position_m, pose.position_m);
  EXPECT_EQ(read.orientation, pose.orientation);
  ASSERT_EQ(read.views.size(), 2u);
  EXPECT_EQ(read.views[1].position_m, pose.views[1].position_m);
  EXPECT_EQ(read.views[1].orientation, pose.views[1].orientation);
  EXPECT_EQ(read.views[0].fov_left_rad, pose.views[0].fov_left_rad);
}

TEST(Path, PosesAreExactAtTheirTimesAndClampedBeyondTheEnds) {
  Path path;
  path.poses = {pose_with_views(5.0, 0.0), pose_with_views(6.0, 1.0), pose_with_views(8.0, 2.0)};
  EXPECT_EQ(path.duration_s(), 3.0);
  for (const PathPose& pose : path.poses) {
    const PathPose at = path.at(pose.t_s - 5.0);
    EXPECT_EQ(at.position_m, pose.position_m);
    EXPECT_EQ(at.orientation, pose.orientation);
    EXPECT_EQ(at.views[0].position_m, pose.views[0].position_m);
  }
  EXPECT_EQ(path.at(-1.0).position_m, path.poses.front().position_m);
  EXPECT_EQ(path.at(99.0).position_m, path.poses.back().position_m);
  EXPECT_DOUBLE_EQ(path.at(2.0).position_m.x, 1.5);
  EXPECT_DOUBLE_EQ(path.at(2.0).views[1].position_m.x, 1.5 + 0.0315);
}

TEST(Path, RefusesWhatIsNoPathAndNamesTheLine) {
  EXPECT_EQ(refusal(kGood), "accepted");
  EXPECT_THAT(refusal(""), HasSubstr("empty"));
  EXPECT_THAT(refusal(kGood + "\nnonsense"), HasSubstr("p.jsonl:2: not JSON"));
  EXPECT_THAT(refusal("[1,2]"), HasSubstr("p.jsonl:1"));
  EXPECT_THAT(refusal(std::string(100000, '[')), HasSubstr("p.jsonl:1"));
  EXPECT_THAT(refusal(kGood + "\n" + kGood), HasSubstr("p.jsonl:2: time 0 s does not rise"));
  EXPECT_THAT(refusal(R"({"position_m":[0,0,0],"orientation_xyzw":[0,0,0,1]})"), HasSubstr("t_s"));
  EXPECT_THAT(refusal(R"({"t_s":0,"position_m":[0,0],"orientation_xyzw":[0,0,0,1]})"), HasSubstr("position_m"));
  EXPECT_THAT(refusal(R"({"t_s":0,"position_m":[0,"x",0],"orientation_xyzw":[0,0,0,1]})"), HasSubstr("position_m"));
  EXPECT_THAT(refusal(R"({"t_s":0,"position_m":[0,1e9,0],"orientation_xyzw":[0,0,0,1]})"), HasSubstr("out of range"));
  EXPECT_THAT(refusal(R"({"t_s":0,"position_m":[0,0,0],"orientation_xyzw":[0,0,0,0]})"), HasSubstr("length 0"));
  EXPECT_THAT(refusal(R"({"t_s":0,"position_m":[0,0,0],"orientation_xyzw":[1,0,0,1]})"), HasSubstr("length 1.4"));
  EXPECT_THAT(refusal(R"({"t_s":1e999,"position_m":[0,0,0],"orientation_xyzw":[0,0,0,1]})"), HasSubstr("p.jsonl:1"));
}

TEST(Path, RefusesFieldsOfViewThatNoPictureHas) {
  const auto with_fov = [](const std::string& fov) {
    return R"({"t_s":0,"position_m":[0,0,0],"orientation_xyzw":[0,0,0,1],"views":[{"position_m":[0,0,0],)"
           R"("orientation_xyzw":[0,0,0,1],"fov_rad":)" + fov + "}]}";
  };
  EXPECT_EQ(refusal(with_fov("[-0.7,0.7,0.7,-0.7]")), "accepted");
  EXPECT_THAT(refusal(with_fov("[0.7,-0.7,0.7,-0.7]")), HasSubstr("fov_rad"));
  EXPECT_THAT(refusal(with_fov("[-0.7,0.7,-0.7,0.7]")), HasSubstr("fov_rad"));
  EXPECT_THAT(refusal(with_fov("[-1.6,0.7,0.7,-0.7]")), HasSubstr("89 degrees"));
  EXPECT_THAT(refusal(with_fov("[-0.7,0.7,0.7,-0.7]") + "\n" +
                      R"({"t_s":1,"position_m":[0,0,0],"orientation_xyzw":[0,0,0,1]})"),
              HasSubstr("same number of views"));
}

TEST(Path, OrientationsFollowTheConventionOfYawAndPitch) {
  const glm::dvec3 left = orientation_of(90 * kDegree, 0.0) * glm::dvec3(0, 0, -1);
  EXPECT_NEAR(left.x, -1.0, 1e-12);
  const glm::dvec3 up = orientation_of(0.0, 30 * kDegree) * glm::dvec3(0, 0, -1);
  EXPECT_NEAR(up.y, 0.5, 1e-12);
  const Pose pose = pose_of({1, 2, 3}, orientation_of(-2.5, 0.4));
  EXPECT_NEAR(pose.yaw_rad, -2.5, 1e-12);
  EXPECT_NEAR(pose.pitch_rad, 0.4, 1e-12);
}

TEST(Path, TourIsWalkedAtWalkingSpeedAndSlowerInTurns) {
  std::vector<Pose> tour;
  for (int i = 0; i <= 40; ++i) {  // 5 m straight, then 5 m after a right angle
    Pose pose;
    const double s = 0.25 * i;
    pose.position_m = {s < 5 ? 0.0 : s - 5, 1.6, s < 5 ? -s : -5.0};
    pose.yaw_rad = s < 5 ? 0.0 : -90 * kDegree;
    tour.push_back(pose);
  }
  const Path path = path_of_tour(tour, 1.0, 1.0);
  EXPECT_EQ(path.poses.front().position_m, tour.front().position_m);
  EXPECT_NEAR(glm::distance(path.poses.back().position_m, tour.back().position_m), 0.0, 1e-12);
  EXPECT_GT(path.duration_s(), 9.5);
  EXPECT_LT(path.duration_s(), 13.0);
  for (std::size_t i = 1; i < path.poses.size(); ++i) {
    const PathPose &a = path.poses[i - 1], &b = path.poses[i];
    const double dt_s = b.t_s - a.t_s;
    ASSERT_GT(dt_s, 0.0);
    EXPECT_LE(glm::distance(a.position_m, b.position_m) / dt_s, 1.0 + 1e-9);
    EXPECT_LE(2 * std::acos(std::min(1.0, std::abs(glm::dot(a.orientation, b.orientation)))) / dt_s, 1.0 + 1e-6);
  }
}

TEST(Path, ReplayUsesRecordedViewsElseTheDisplaysOwnEyes) {
  PathPose pose = pose_with_views(0.0, 3.0);
  ViewPose head;
  head.position_m = {0, 1.7, 0};
  head.orientation = orientation_of(90 * kDegree, 0);
  ViewPose eye = head;
  eye.position_m = {0, 1.7, -0.03};  // to the right of a head that looks along -x
  EXPECT_EQ(replayed_views(pose, {eye, eye}, head)[0].position_m, pose.views[0].position_m);
  pose.views.clear();
  pose.orientation = glm::dquat(1, 0, 0, 0);
  const auto views = replayed_views(pose, {eye, eye}, head);
  EXPECT_NEAR(glm::distance(views[0].position_m, glm::dvec3(3.03, 1.6, 0.1)), 0.0, 1e-12);
  EXPECT_NEAR(std::abs(glm::dot(views[0].orientation, pose.orientation)), 1.0, 1e-12);
}

TEST(PathWriter, KeepsTheWholeLinesThatFittedOnAFullDisk) {
  const std::filesystem::path file = std::filesystem::path(PROBEWALK_TEST_OUTPUT_DIR) / "full-disk.jsonl";
  std::filesystem::remove(file);
  // A limit on file sizes fails writes as a full disk does, once its signal is ignored.
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{10000, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  {
    PathWriter writer(file);
    for (int k = 0; k < 1000; ++k) writer.add({0.1 * k, glm::dvec3(0.001 * k, 1.6, 0), glm::dquat(1, 0, 0, 0), {}});
    EXPECT_THROW(writer.finish(), BadInput);
  }
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  const Path kept = read_path(file);
  EXPECT_GT(kept.poses.size(), 10u);
  EXPECT_LT(kept.poses.size(), 1000u);
  EXPECT_FALSE(std::filesystem::exists(file.string() + ".part"));
}

TEST(PathWriter, NamesTheFileOnlyWhenItIsWhole) {
  const std::filesystem::path file = std::filesystem::path(PROBEWALK_TEST_OUTPUT_DIR) / "recorded.jsonl";
  std::filesystem::remove(file);
  {
    PathWriter abandoned(file);
    abandoned.add(pose_with_views(0.0, 0.0));
  }
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_FALSE(std::filesystem::exists(file.string() + ".part"));
  PathWriter writer(file);
  writer.add(pose_with_views(0.0, 0.0));
  writer.add(pose_with_views(0.5, 1.0));
  writer.finish();
  EXPECT_EQ(read_path(file).poses.size(), 2u);
  EXPECT_THROW(PathWriter(file / "nowhere" / "p.jsonl"), BadInput);
}

}  // namespace
}  // namespace probewalk
