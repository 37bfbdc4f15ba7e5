#include "xr/walk_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "content/error.h"

namespace probewalk {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

fs::path fresh_file(const std::string& name) {
  const fs::path folder = fs::path(PROBEWALK_TEST_OUTPUT_DIR) / ("settings-" + name);
  fs::remove_all(folder);
  return folder / "probewalk" / "walk.json";
}

WalkSettings all_said() {
  WalkSettings settings;
  settings.turn = "45";
  settings.vignette = "high";
  settings.world_scale = 1.5;
  settings.seated = true;
  settings.eye_height_m = 1.2;
  return settings;
}

std::string what_is_wrong_with(const std::string& text) {
  const fs::path file = fresh_file("bad");
  fs::create_directories(file.parent_path());
  std::ofstream(file) << text;
  try {
    read_walk_settings(file);
  } catch (const BadInput& error) {
    return error.what();
  }
  return "";
}

TEST(WalkSettings, ComeBackAsTheyWereWritten) {
  const fs::path file = fresh_file("round");
  EXPECT_EQ(read_walk_settings(file), WalkSettings{}) << "no file yet";
  write_walk_settings(file, all_said());
  EXPECT_EQ(read_walk_settings(file), all_said());
  WalkSettings some;
  some.seated = false;
  write_walk_settings(file, some);
  EXPECT_EQ(read_walk_settings(file), some);
  EXPECT_EQ(std::distance(fs::directory_iterator(file.parent_path()), {}), 1) << "nothing is left beside it";
}

TEST(WalkSettings, OfABadFileSayWhichAndWhatIsWrong) {
  EXPECT_THAT(what_is_wrong_with("{\"turn\": \"50\"}"), HasSubstr("walk.json: \"turn\" is none of"));
  EXPECT_THAT(what_is_wrong_with("{\"turn\": 30}"), HasSubstr("\"turn\" is none of"));
  EXPECT_THAT(what_is_wrong_with("{\"vignette\": \"dark\"}"), HasSubstr("\"vignette\" is none of"));
  EXPECT_THAT(what_is_wrong_with("{\"world_scale\": 0}"), HasSubstr("no number from 0.01 to 100"));
  EXPECT_THAT(what_is_wrong_with("{\"world_scale\": 1e999}"), HasSubstr("delete it for the defaults"));
  EXPECT_THAT(what_is_wrong_with("{\"eye_height_m\": \"low\"}"), HasSubstr("eye_height_m"));
  EXPECT_THAT(what_is_wrong_with("{\"seated\": 1}"), HasSubstr("neither true nor false"));
  EXPECT_THAT(what_is_wrong_with("{\"sitting\": true}"), HasSubstr("keys that are no settings"));
  for (const std::string& text : {std::string(), std::string("[]"), std::string("{\"turn\": \"30\""),
                                  std::string("\xff"), std::string(20000, ' '), std::string(1000, '[')}) {
    EXPECT_NE(what_is_wrong_with(text), "") << text.substr(0, 20);
  }
}

TEST(WalkSettings, GoOverEachOtherOneByOne) {
  WalkSettings given;
  given.turn = "smooth";
  const WalkSettings both = over(given, all_said());
  EXPECT_EQ(both.turn, "smooth");
  EXPECT_EQ(both.world_scale, 1.5);
  EXPECT_EQ(over(WalkSettings{}, all_said()), all_said());
  EXPECT_EQ(in_words(both), "turn smooth, vignette high, world scale 1.5, seated, eye height 1.2 m");

  DisplayOptions options;
  apply(all_said(), options);
  EXPECT_EQ(options.locomotion.turn, TurnStyle::kSnap);
  EXPECT_NEAR(options.locomotion.snap_rad, std::numbers::pi / 4, 1e-12);
  EXPECT_EQ(options.locomotion.world_scale, 1.5);
  EXPECT_EQ(options.vignette, "high");
  EXPECT_TRUE(options.seated);
  EXPECT_EQ(options.eye_height_m, 1.2);
  apply(both, options);
  EXPECT_EQ(options.locomotion.turn, TurnStyle::kSmooth);
}

TEST(WalkSettings, LieInTheUsersConfiguration) {
  const char* const before = std::getenv("XDG_CONFIG_HOME");
  const std::string kept = before == nullptr ? "" : before;
  setenv("XDG_CONFIG_HOME", "/somewhere/config", 1);
  EXPECT_EQ(walk_settings_file(), "/somewhere/config/probewalk/walk.json");
  setenv("XDG_CONFIG_HOME", "relative", 1);
  EXPECT_TRUE(walk_settings_file().empty() || walk_settings_file().is_absolute());
  if (before == nullptr) {
    unsetenv("XDG_CONFIG_HOME");
  } else {
    setenv("XDG_CONFIG_HOME", kept.c_str(), 1);
  }
}

TEST(WalkSettings, ThatCannotBeWrittenSayWhere) {
  EXPECT_THROW(write_walk_settings({}, all_said()), BadInput);
  EXPECT_THROW(write_walk_settings("/proc/probewalk/walk.json", all_said()), BadInput);
}

}  // namespace
}  // namespace probewalk
