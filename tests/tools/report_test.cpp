// probewalk report as people and build servers call it: runs compared, grouped, gated. The runs are invented.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "tools/run_probewalk.h"
#include "xr/latency/run_files.h"
#include "xr/latency/synthetic_run.h"

namespace probewalk::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

// Device times of 4 ms times `scale`, that scatter by 5 % within a run and 1 % between runs.
void make_run(const fs::path& folder, unsigned seed, double scale = 1.0, const std::string& device = "a device") {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Ledger ledger(LedgerOptions{.warmup_frames = 20});
  const double of_run = std::exp(0.01 * normal(random));
  for (std::size_t i = 0; i < 1000; ++i) {
    FrameRecord frame = synthetic_frame(i);
    const double gpu_ns = 4e6 * scale * of_run * std::exp(0.05 * normal(random));
    frame.gpu.end = frame.gpu.begin + static_cast<std::int64_t>(gpu_ns);
    frame.gpu_trace.end = frame.gpu_resolve.begin = frame.gpu.end - kMs;
    frame.gpu_resolve.end = frame.gpu.end;
    ledger.add(frame);
  }
  RunInfo info;
  info.command = "probewalk walk house.probes --report " + folder.filename().string();
  info.pack = "house.probes";
  info.display = "headset";
  info.device.name = device;
  info.eye_width = 320;
  info.eye_height = 240;
  info.views = 2;
  write_run(folder, ledger, info);
}

std::string verdict(const json& result, const char* quantity, const char* statistic) {
  for (const json& value : result["comparisons"][0]["values"]) {
    if (value["quantity"] == quantity && value["statistic"] == statistic) return value["verdict"];
  }
  return "no such value";
}

class Report : public testing::Test {
 protected:
  fs::path dir_ = fresh_folder(std::string("report-") + testing::UnitTest::GetInstance()->current_test_info()->name());
  std::string at(const char* name) const { return (dir_ / name).string(); }
  RunResult run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "report");
    arguments.insert(arguments.end(), {"-o", at("page")});
    return run_probewalk(dir_, arguments);
  }
};

TEST_F(Report, RepeatsOfEachSideAreGroupedByNameAndJudged) {
  for (unsigned i = 1; i <= 3; ++i) {
    make_run(dir_ / ("before-" + std::to_string(i)), i);
    make_run(dir_ / ("after-" + std::to_string(i)), 10 + i, 1.1);
  }
  const std::vector<std::string> runs{at("before-1"), at("before-2"), at("before-3"),
                                      at("after-1"),  at("after-2"),  at("after-3")};
  std::vector<std::string> with_json = runs;
  with_json.push_back("--json");
  const RunResult r = run(with_json);
  ASSERT_EQ(r.exit_code, 0) << r.err;
  const json result = json::parse(r.out);
  ASSERT_EQ(result["groups"].size(), 2u);
  EXPECT_EQ(result["groups"][0]["name"], "before");
  EXPECT_EQ(result["groups"][1]["runs"].size(), 3u);
  EXPECT_EQ(verdict(result, "gpu_busy", "p50"), "slower");
  EXPECT_EQ(verdict(result, "cpu_busy", "p50"), "no change");
  EXPECT_EQ(verdict(result, "gpu_busy", "p999"), "too few frames");
  EXPECT_TRUE(result["differ_in"].empty()) << result["differ_in"];
  const std::string page = read_text(dir_ / "page/index.html");
  EXPECT_THAT(page, AllOf(HasSubstr("3 repeats"), HasSubstr(">slower<"), HasSubstr(">no change<"),
                          HasSubstr(">too few frames<"), HasSubstr("gpu_busy p50 by")));
  EXPECT_THAT(page, AllOf(Not(HasSubstr("No repeats")), Not(HasSubstr("http:")), Not(HasSubstr("https:"))));

  const RunResult people = run(runs);
  EXPECT_THAT(people.err, AllOf(HasSubstr("after against before"), HasSubstr("slower")));
  EXPECT_EQ(people.out, "");
}

TEST_F(Report, GroupsMayBeNamedAndDifferencesAreToldInABanner) {
  make_run(dir_ / "x", 1);
  make_run(dir_ / "y", 2, 1.0, "another device");
  make_run(dir_ / "z", 3);
  const RunResult r = run({"--group", "old", at("x"), at("z"), "--group", "new", at("y"), "--json"});
  ASSERT_EQ(r.exit_code, 0) << r.err;
  const json result = json::parse(r.out);
  EXPECT_EQ(result["groups"][0]["runs"], (json{"x", "z"}));
  ASSERT_EQ(result["differ_in"].size(), 1u) << result["differ_in"];
  EXPECT_EQ(result["differ_in"][0]["what"], "device");
  EXPECT_EQ(verdict(result, "gpu_busy", "p50"), "no change");
  EXPECT_THAT(read_text(dir_ / "page/index.html"),
              AllOf(HasSubstr("differ in more than their times"), HasSubstr("another device")));
  EXPECT_EQ(run({at("x"), "--group", "new", at("y")}).exit_code, 2);
  EXPECT_EQ(run({"--group", "new"}).exit_code, 2);
  EXPECT_EQ(run({}).exit_code, 2);
}

TEST_F(Report, AGateThatDoesNotHoldIsExitOneWithATable) {
  make_run(dir_ / "a", 1);
  make_run(dir_ / "b", 2, 1.5);
  EXPECT_EQ(run({at("a"), "--gate", "p99=11.1ms,missed=0,within_budget=100%,deadline_margin.p1=1ms"}).exit_code, 0);
  const RunResult r = run({at("a"), at("b"), "--gate", "gpu_busy.p95=5ms,p99.9=1s,missed=0"});
  EXPECT_EQ(r.exit_code, 1);
  EXPECT_THAT(r.err,
              AllOf(HasSubstr("gate of " + at("a")), HasSubstr("holds  gpu_busy.p95"), HasSubstr("FAILS  gpu_busy.p95"),
                    HasSubstr("FAILS  frame.p999"), HasSubstr("it needs 10000"), HasSubstr("holds  missed")));
  const RunResult machine = run({at("a"), "--gate", "missed=0,need_to_resident.p99=1s", "--json"});
  EXPECT_EQ(machine.exit_code, 1);
  const json gate = json::parse(machine.out)["gate"];
  ASSERT_EQ(gate.size(), 2u);
  EXPECT_EQ(gate[0]["holds"], true);
  EXPECT_EQ(gate[1]["holds"], false);
  EXPECT_TRUE(gate[1]["value"].is_null());
  EXPECT_THAT(gate[1]["note"].get<std::string>(), HasSubstr("no level"));
  const RunResult unknown = run({at("a"), "--gate", "speed=1"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("known are: frame.p50"));
  EXPECT_TRUE(fs::exists(dir_ / "page/frames.csv")) << "a page of one run has its data beside it";
}

}  // namespace
}  // namespace probewalk::test
