// probewalk stability as a person calls it: its files, its words, its exit codes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "content/stability/cases.h"
#include "tools/probewalk/patience.h"
#include "tools/run_probewalk.h"

namespace probewalk::test {
namespace {

namespace fs = std::filesystem;

// Names as the page writes them.
std::string as_html(const std::string& text) {
  std::string html;
  for (const char c : text) html += c == '\'' ? "&#39;" : std::string(1, c);
  return html;
}
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Stability, WritesPageRowsAndSummary) {
  const fs::path dir = fresh_folder("stability");
  const fs::path out = dir / "out";
  const RunResult r = run_probewalk(dir, {"stability", "-o", out.string(), "--rays", "2e4"});
  ASSERT_EQ(r.exit_code, 0) << r.err;
  EXPECT_EQ(r.out, "");
  EXPECT_THAT(r.err, HasSubstr("Every check holds."));
  EXPECT_THAT(r.err, HasSubstr("hard cases\n"));

  const nlohmann::json json = nlohmann::json::parse(read_text(out / "results.json"));
  EXPECT_EQ(json["passed"], true);
  EXPECT_TRUE(json["failures"].empty());
  for (const char* key :
       {"schema", "command", "build", "device", "machine", "started_utc", "seconds", "tie", "totals"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_THAT(json["command"].get<std::string>(), HasSubstr("stability"));
  const auto cases = stability::hard_cases();
  ASSERT_EQ(json["cases"].size(), cases.size());
  std::uint64_t rays = 0;
  for (std::size_t k = 0; k < cases.size(); ++k) {
    const nlohmann::json& row = json["cases"][k];
    EXPECT_EQ(row["case"], cases[k].name);
    rays += row["rays"].get<std::uint64_t>();
    EXPECT_EQ(row["device_rays"], row["rays"]);
    EXPECT_EQ(row["nan_count"], 0);
    EXPECT_EQ(row["endless_count"], 0);
    EXPECT_EQ(row["hierarchical_differs"], 0);
    EXPECT_LE(row["lookups_max"], row["lookups_bound"]);
    for (const char* pair : {"float_vs_double", "float_vs_flat", "device_vs_double", "device_vs_float",
                             "float_vs_brute_force", "device_vs_brute_force", "double_vs_brute_force"}) {
      EXPECT_EQ(row[pair]["beyond_ties"], 0) << row["case"] << " " << pair;
      EXPECT_TRUE(row[pair].contains("error_p99") && row[pair].contains("error_max") && row[pair].contains("by_class"))
          << pair;
    }
  }
  EXPECT_EQ(json["totals"]["rays"], rays);
  EXPECT_GE(rays, 19000u);

  const std::string csv = read_text(out / "results.csv");
  EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')), cases.size() + 1);
  EXPECT_THAT(csv.substr(0, csv.find('\n')), HasSubstr("float_vs_brute_force.error_p99"));
  const std::string page = read_text(out / "index.html");
  for (const auto& hard : cases) EXPECT_THAT(page, HasSubstr(as_html(hard.name)));
  EXPECT_THAT(page, Not(HasSubstr("nan")));
}

TEST(Stability, AFailedCheckIsExitCodeOne) {
  const fs::path dir = fresh_folder("stability-fails");
  const fs::path out = dir / "out";
  const RunResult r =
      run_probewalk(dir, {"stability", "-o", out.string(), "--rays", "2e4", "--tie", "1e-15", "--json"});
  EXPECT_EQ(r.exit_code, 1) << r.err;
  EXPECT_THAT(r.err, HasSubstr("beyond ties"));
  // Both machines and people are told which.
  const nlohmann::json json = nlohmann::json::parse(r.out);
  EXPECT_EQ(json, nlohmann::json::parse(read_text(out / "results.json")));
  EXPECT_EQ(json["passed"], false);
  ASSERT_FALSE(json["failures"].empty());
  bool shows_a_ray = false;
  for (const auto& row : json["cases"]) shows_a_ray = shows_a_ray || row["float_vs_double"].contains("first_beyond");
  EXPECT_TRUE(shows_a_ray);
  EXPECT_THAT(read_text(out / "index.html"), HasSubstr("What does not hold"));
}

TEST(Stability, InterruptedLeavesNothing) {
  const fs::path dir = fresh_folder("stability-interrupted");
  const pid_t child = start_probewalk(dir, {"stability", "-o", (dir / "out").string(), "--rays", "1e10"});
  std::this_thread::sleep_for(std::chrono::seconds(2));
  kill(child, SIGINT);
  EXPECT_EQ(finish_probewalk(child, dir).exit_code, 5);
  EXPECT_FALSE(fs::exists(dir / "out/results.json"));
}

TEST(Stability, RefusesWhatIsNoNumberOfRays) {
  const fs::path dir = fresh_folder("stability-usage");
  for (const char* rays : {"0", "-5", "many", "nan", "inf"}) {
    EXPECT_EQ(run_probewalk(dir, {"stability", "-o", (dir / "out").string(), "--rays", rays}).exit_code, 2) << rays;
  }
  EXPECT_EQ(run_probewalk(dir, {"stability"}).exit_code, 2);
  std::ofstream(dir / "file") << "in the way";
  EXPECT_EQ(run_probewalk(dir, {"stability", "-o", (dir / "file" / "out").string()}).exit_code, 3);
}

// A walk that did not end could not be counted; the program says so and ends itself.
TEST(StabilityDeathTest, WorkThatDoesNotEndIsEnded) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto never_ends = [] {
    SilentProgress silent;
    Patience patience(silent, std::chrono::seconds(1));
    patience.doing("the rays `round and round`");
    patience.begin("hard cases", 10, "rays");
    for (;;) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  };
  EXPECT_EXIT(never_ends(), ::testing::ExitedWithCode(1), "round and round.*does not end");
}

TEST(Stability, WorkThatAdvancesIsLeftAlone) {
  SilentProgress silent;
  Patience patience(silent, std::chrono::seconds(3));
  for (int k = 0; k < 25; ++k) {
    patience.advance(1);
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }
}

// Rays whose numbers are none never reach the tracer from the command line.
TEST(Stability, TraceRefusesNumbersThatAreNone) {
  const fs::path dir = fresh_folder("trace-hostile");
  const fs::path out = dir / "box.probes";
  ASSERT_EQ(run_probewalk(dir, {"scene", "box-room", "-o", (dir / "box.glb").string(), "-q"}).exit_code, 0);
  ASSERT_EQ(run_probewalk(dir, {"bake", (dir / "box.glb").string(), "-o", out.string(), "--resolution", "16",
                                "--radiance-resolution", "8", "--max-probes", "1", "--samples", "8", "-q"})
                .exit_code,
            0);
  for (const char* ray :
       {"nan 1 0 0 0 -1", "0 inf 0 0 0 -1", "0 1 0 0 nan -1", "0 1 0 0 0 0", "0 1 0 inf 0 0", "1e300 1 0 0 0 1"}) {
    std::ofstream(dir / "rays.txt") << ray << "\n";
    const RunResult r = run_probewalk(dir, {"trace", out.string(), "--rays", (dir / "rays.txt").string()});
    EXPECT_EQ(r.exit_code, 3) << ray;
    EXPECT_EQ(r.out, "") << ray;
    EXPECT_THAT(r.err, HasSubstr("line 1")) << ray;
  }
}

}  // namespace
}  // namespace probewalk::test
