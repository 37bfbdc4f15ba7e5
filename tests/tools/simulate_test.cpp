// probewalk simulate, as other programs call it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/room_pack.h"
#include "tools/run_probewalk.h"

namespace probewalk::test {
namespace {

namespace fs = std::filesystem;

const fs::path& pack() {
  static const fs::path folder = [] {
    const fs::path made = fresh_folder("simulate") / "room.probes";
    write_room_pack(made);
    return made;
  }();
  return folder;
}

RunResult simulate(const std::vector<std::string>& more) {
  std::vector<std::string> words{"simulate", pack().string(), "--quiet"};
  words.insert(words.end(), more.begin(), more.end());
  return run_probewalk(pack().parent_path(), words);
}

TEST(Simulate, ComparesPoliciesOverWalksOfASite) {
  const fs::path out = pack().parent_path() / "page";
  const RunResult run =
      simulate({"--rooms",    "60",         "--walks",         "4",        "--seconds", "10",
                "--rate",     "20",         "--source",        "20Mbit/s", "--latency", "50ms",
                "--failures", "1%",         "--device-budget", "16",       "--policy",  "probewalk,oracle",
                "-o",         out.string(), "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_EQ(json["rooms"], 60);
  EXPECT_EQ(json["source_bytes_per_s"], 2.5e6);
  EXPECT_DOUBLE_EQ(json["latency_s"], 0.05);
  EXPECT_DOUBLE_EQ(json["failure_fraction"], 0.01);
  EXPECT_EQ(json["device_budget_bytes"], 16 << 20);
  ASSERT_EQ(json["policies"].size(), 2u);
  for (const auto& policy : json["policies"]) {
    EXPECT_EQ(policy["walks"], 4);
    EXPECT_EQ(policy["steps"], 4 * 10 * 20);
    EXPECT_EQ(policy["over_budget_frames"], 0);
    EXPECT_GT(policy["bytes_moved"], 0.0);
    EXPECT_LE(policy["device_bytes_max"], 16 << 20);
    EXPECT_GE(policy["missing_octaves"].get<double>() + 1e-9, json["missing_octaves_bound"].get<double>());
  }
  EXPECT_EQ(nlohmann::json::parse(read_text(out / "results.json")), json);
  EXPECT_NE(read_text(out / "index.html").find("<svg"), std::string::npos);
}

TEST(Simulate, FollowsAPathAndGivesTheSameNumbersAgain) {
  const fs::path path = pack().parent_path() / "path.jsonl";
  std::ofstream(path) << R"({"t_s": 0, "position_m": [0, 1.6, 0], "orientation_xyzw": [0, 0, 0, 1]})"
                         "\n"
                      << R"({"t_s": 2, "position_m": [0.5, 1.6, 0], "orientation_xyzw": [0, 0, 0, 1]})"
                         "\n";
  const RunResult first = simulate({"--path", path.string(), "--rate", "50", "--json"});
  ASSERT_EQ(first.exit_code, 0) << first.err;
  auto a = nlohmann::json::parse(first.out),
       b = nlohmann::json::parse(simulate({"--path", path.string(), "--rate", "50", "--json"}).out);
  EXPECT_EQ(a["policies"][0]["steps"], 101);
  for (auto* json : {&a, &b}) {
    for (const char* timed : {"decide_p50_ns", "decide_p99_ns"}) (*json)["policies"][0].erase(timed);
  }
  EXPECT_EQ(a, b);
}

TEST(Simulate, SaysWhatIsWrongAndHowItIsWritten) {
  const struct {
    std::vector<std::string> words;
    int exit_code;
    const char* says;
  } cases[] = {
      {{"--source", "fast"}, 2, "50MB/s"},
      {{"--source", "0MB/s"}, 2, "above 0"},
      {{"--latency", "20"}, 2, "ms or s"},
      {{"--failures", "100%"}, 2, "below 1"},
      {{"--policy", "psychic"}, 2, "probewalk"},
      {{"--path", "/nowhere.jsonl"}, 3, "/nowhere.jsonl"},
      {{"--path", "a", "--walks", "3"}, 2, "--walks"},
  };
  for (const auto& wrong : cases) {
    const RunResult run = simulate(wrong.words);
    EXPECT_EQ(run.exit_code, wrong.exit_code) << wrong.words[0] << " " << wrong.words[1] << ": " << run.err;
    EXPECT_NE(run.err.find(wrong.says), std::string::npos) << run.err;
  }
}

}  // namespace
}  // namespace probewalk::test
