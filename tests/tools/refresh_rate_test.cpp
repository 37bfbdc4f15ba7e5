// The headset's refresh rate on a real runtime, Monado, whose simulated headset has one alone, and with a layer in
// front of it (tests/openxr_layer) that offers 60, 72, 90 and 119.88 Hz. Skipped, with the reason, where Monado is not
// installed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tools/monado_walk.h"

namespace probewalk::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

std::string behind_layer(const std::string& orders) {
  return "export XR_ENABLE_API_LAYERS=XR_APILAYER_PROBEWALK_refresh_rate XR_API_LAYER_PATH='" +
         std::string(PROBEWALK_TEST_LAYER_MANIFESTS) + "' PROBEWALK_TEST_REFRESH=\"log=$PWD/requests;" + orders + "\"";
}

std::string details(const MonadoWalk& walk) {
  return walk.summary.value("display_details", "");
}

TEST(RefreshRate, IsAskedForAndOnceConfirmedNamedInNotesAndReport) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const fs::path folder = fresh_folder("refresh-rate-90");
  const MonadoWalk walk = walk_in_monado(folder, behind_layer(""), "--frames 40 --refresh-rate 90");
  ASSERT_EQ(walk.run.exit_code, 0) << walk.run.err;
  EXPECT_EQ(read_text(folder / "requests"), "requested 90\n");
  EXPECT_THAT(walk.run.err, HasSubstr("72 Hz of 60, 72, 90, 119.9, 90 Hz asked for"));
  EXPECT_THAT(walk.run.err, HasSubstr("refresh rate is 90 Hz now, 72 before"));
  EXPECT_THAT(details(walk), HasSubstr("90 Hz of 60, 72, 90, 119.9"));
  EXPECT_THAT(details(walk), Not(HasSubstr("asked for")));
  EXPECT_THAT(read_text(folder / "report" / "index.html"), HasSubstr("90 Hz of 60, 72, 90, 119.9"));
}

TEST(RefreshRate, OfferedByARoundNumberIsThatOfTheHeadset) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const fs::path folder = fresh_folder("refresh-rate-120");
  const MonadoWalk walk = walk_in_monado(folder, behind_layer(""), "--frames 40 --refresh-rate 120");
  ASSERT_EQ(walk.run.exit_code, 0) << walk.run.err;
  EXPECT_EQ(read_text(folder / "requests"), "requested 119.88\n");
  EXPECT_THAT(details(walk), HasSubstr("119.9 Hz of 60, 72, 90, 119.9"));
}

TEST(RefreshRate, ThatARuntimeNeverTakesIsNotClaimed) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const MonadoWalk walk =
      walk_in_monado(fresh_folder("refresh-rate-deaf"), behind_layer("deaf=1"), "--frames 40 --refresh-rate 90");
  ASSERT_EQ(walk.run.exit_code, 0) << walk.run.err;
  EXPECT_THAT(walk.run.err, Not(HasSubstr("Hz now")));
  EXPECT_THAT(details(walk), HasSubstr("72 Hz of 60, 72, 90, 119.9, 90 Hz asked for"));
}

TEST(RefreshRate, StaysAsItIsUnlessAskedFor) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const fs::path folder = fresh_folder("refresh-rate-none");
  const MonadoWalk walk = walk_in_monado(folder, behind_layer(""), "--frames 30");
  ASSERT_EQ(walk.run.exit_code, 0) << walk.run.err;
  EXPECT_FALSE(fs::exists(folder / "requests"));
  EXPECT_THAT(details(walk), HasSubstr("72 Hz of 60, 72, 90, 119.9"));
  EXPECT_THAT(details(walk), Not(HasSubstr("asked for")));
}

TEST(RefreshRate, ThatIsNotOfferedIsRefusedWithWhatIs) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const fs::path folder = fresh_folder("refresh-rate-refused");
  const MonadoWalk other = walk_in_monado(folder, behind_layer(""), "--frames 3 --refresh-rate 100");
  EXPECT_EQ(other.run.exit_code, 2) << other.run.err;
  EXPECT_THAT(other.run.err, HasSubstr("--refresh-rate 100: this headset offers 60, 72, 90, 119.9 Hz"));
  EXPECT_FALSE(fs::exists(folder / "requests"));
  const MonadoWalk bare = walk_in_monado(folder, "", "--frames 3 --refresh-rate 90");
  EXPECT_EQ(bare.run.exit_code, 2) << bare.run.err;
  EXPECT_THAT(bare.run.err, HasSubstr("--refresh-rate 90: this headset offers 20 Hz"));
}

TEST(RefreshRate, AndWhatElseAHeadsetOffersIsListed) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const fs::path folder = fresh_folder("refresh-rate-list");
  const auto list = [&](const std::string& environment) {
    return run_bash(folder, environment + "\nbash '" + PROBEWALK_SOURCE_DIR + "/tools/lib/with-monado.sh' null '" +
                                PROBEWALK_EXECUTABLE + "' --list-headset");
  };
  const RunResult with = list(behind_layer(""));
  EXPECT_EQ(with.exit_code, 0) << with.err;
  EXPECT_THAT(with.out, HasSubstr("Monado"));
  EXPECT_THAT(with.out, HasSubstr("2 of 320x240 as recommended"));
  EXPECT_THAT(with.out, HasSubstr("72 Hz of 60, 72, 90, 119.9\n"));
  const RunResult bare = list("");
  EXPECT_EQ(bare.exit_code, 0) << bare.err;
  EXPECT_THAT(bare.out, HasSubstr("20 Hz of 20\n"));
  const RunResult none = run_bash(
      folder, std::string("export XR_RUNTIME_JSON=/nonexistent.json\n'") + PROBEWALK_EXECUTABLE + "' --list-headset");
  EXPECT_EQ(none.exit_code, 4) << none.err;
  EXPECT_THAT(none.err, HasSubstr("no OpenXR runtime answers"));
}

}  // namespace
}  // namespace probewalk::test
