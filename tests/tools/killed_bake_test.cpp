// A bake that is killed at any moment goes on from what it had finished, to the same bytes.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <map>
#include <thread>

#include "support/low_discrepancy.h"
#include "tools/run_probewalk.h"

namespace probewalk::test {
namespace {

namespace fs = std::filesystem;

std::map<std::string, std::string> files_of(const fs::path& pack) {
  std::map<std::string, std::string> contents;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(pack)) {
    if (entry.is_regular_file()) contents[fs::relative(entry.path(), pack).string()] = read_text(entry.path());
  }
  return contents;
}

class KilledBake : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fresh_folder(std::string("killed_bake_") + testing::UnitTest::GetInstance()->current_test_info()->name());
  }

  void make_scene(const std::string& name) const {
    ASSERT_EQ(run_probewalk(folder_, {"scene", name, "-o", (folder_ / "scene.glb").string()}).exit_code, 0);
  }

  std::vector<std::string> command(const std::string& pack, const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"bake",    (folder_ / "scene.glb").string(),
                                       "-o",      (folder_ / (pack + ".probes")).string(),
                                       "--quiet", "--samples",
                                       "8",       "--bounces",
                                       "1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  // Kills `times` bakes, each at another share of what an undisturbed one takes, and lets each go on.
  void kill_and_go_on(int times, const std::vector<std::string>& options) {
    const auto start = std::chrono::steady_clock::now();
    ASSERT_EQ(run_probewalk(folder_, command("undisturbed", options)).exit_code, 0);
    const std::chrono::duration<double> whole = std::chrono::steady_clock::now() - start;
    const auto expected = files_of(folder_ / "undisturbed.probes");
    int killed = 0;
    for (int k = 0; k < times; ++k) {
      const pid_t child = start_probewalk(folder_, command("killed", options));
      std::this_thread::sleep_for(whole * radical_inverse(static_cast<std::uint32_t>(k) + 1));
      kill(child, SIGKILL);
      killed += finish_probewalk(child, folder_).exit_code == -SIGKILL;
      ASSERT_EQ(run_probewalk(folder_, command("killed", options)).exit_code, 0);
      EXPECT_EQ(files_of(folder_ / "killed.probes"), expected)
          << "killed after " << radical_inverse(static_cast<std::uint32_t>(k) + 1);
      EXPECT_FALSE(fs::exists(folder_ / "killed.probes.partial"));
      fs::remove_all(folder_ / "killed.probes");
    }
    EXPECT_GT(killed, times / 2) << "most were done before they were killed";
  }

  fs::path folder_;
};

TEST_F(KilledBake, GoesOnToTheSameBytesFromTwentyMoments) {
  make_scene("two-rooms");
  kill_and_go_on(20, {"--resolution", "64", "--max-probes", "6"});
}

TEST_F(KilledBake, GoesOnToTheSameBytesWhilePlanning) {
  make_scene("box-room");
  kill_and_go_on(4, {"--error", "0.15"});
}

}  // namespace
}  // namespace probewalk::test
