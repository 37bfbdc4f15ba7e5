// The whole way in small: scene, bake, info, trace, render, walk, report; interruption; damage; repeatability.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "support/report_contract.h"
#include "support/trace_check.h"
#include "tools/run_probewalk.h"

namespace probewalk::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// A small pack of two rooms, baked once for all tests of this file.
const fs::path& sample_pack() {
  static const fs::path pack = [] {
    const fs::path dir = fresh_folder("whole-way");
    const RunResult scene = run_probewalk(dir, {"scene", "two-rooms", "-o", (dir / "two.glb").string()});
    if (scene.exit_code != 0) throw std::runtime_error(scene.err);
    const RunResult baked =
        run_probewalk(dir, {"bake", (dir / "two.glb").string(), "-o", (dir / "two.probes").string(), "--resolution",
                            "128", "--max-probes", "12", "--samples", "32", "--bounces", "2", "--json"});
    if (baked.exit_code != 0) throw std::runtime_error(baked.err);
    if (!json::accept(baked.out)) throw std::runtime_error("bake --json printed no JSON: " + baked.out);
    return dir / "two.probes";
  }();
  return pack;
}

std::vector<std::pair<std::string, std::string>> pack_files(const fs::path& pack) {
  std::vector<std::pair<std::string, std::string>> files;
  for (const auto& entry : fs::recursive_directory_iterator(pack)) {
    if (entry.is_regular_file()) files.emplace_back(fs::relative(entry.path(), pack).string(), read_text(entry.path()));
  }
  std::sort(files.begin(), files.end());
  return files;
}

TEST(WholeWay, InfoTellsWhatTheContractPromises) {
  const fs::path dir = fresh_folder("info");
  const RunResult r = run_probewalk(dir, {"info", sample_pack().string(), "--json"});
  ASSERT_EQ(r.exit_code, 0) << r.err;
  const json info = json::parse(r.out);
  for (const char* key :
       {"format_version", "scale", "bounds", "rooms", "features", "credits", "bytes_disk", "bytes_device"}) {
    EXPECT_TRUE(info.contains(key)) << key;
  }
  ASSERT_EQ(info["rooms"].size(), 2u);
  for (const json& room : info["rooms"]) {
    for (const char* key : {"id", "name", "bounds", "probes", "portals", "levels"})
      EXPECT_TRUE(room.contains(key)) << key;
    ASSERT_FALSE(room["levels"].empty());
    for (const char* key : {"geometry_size", "radiance_size", "bytes_disk", "bytes_device", "error"}) {
      EXPECT_TRUE(room["levels"][0].contains(key)) << key;
    }
  }
}

TEST(WholeWay, VerifyFindsAFlippedByte) {
  const fs::path dir = fresh_folder("verify");
  const fs::path copy = dir / "copy.probes";
  fs::copy(sample_pack(), copy, fs::copy_options::recursive);
  ASSERT_EQ(run_probewalk(dir, {"info", copy.string(), "--verify"}).exit_code, 0);
  const fs::path chunk = fs::directory_iterator(copy / "chunks")->path();
  std::string bytes = read_text(chunk);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 4);
  std::ofstream(chunk, std::ios::binary) << bytes;
  const RunResult r = run_probewalk(dir, {"info", copy.string(), "--verify"});
  EXPECT_EQ(r.exit_code, 1);
  EXPECT_THAT(r.err + r.out, ::testing::HasSubstr(chunk.filename().string()));
}

TEST(WholeWay, TraceAnswersLineByLine) {
  const fs::path dir = fresh_folder("trace");
  std::ofstream(dir / "rays.txt") << "0 1.5 0 0 -2 0\n0 1.5 0 0 7 0\n";
  const RunResult r = run_probewalk(dir, {"trace", sample_pack().string(), "--rays", (dir / "rays.txt").string()});
  ASSERT_EQ(r.exit_code, 0) << r.err;
  std::istringstream in(r.out);
  std::string cls;
  double t = 0, red = 0, green = 0, blue = 0;
  int probe = -2;
  unsigned lookups = 0;
  ASSERT_TRUE(in >> cls >> t >> red >> green >> blue >> probe >> lookups);
  EXPECT_EQ(cls, "hit");
  EXPECT_NEAR(t, 1.5, 1e-3) << "the floor, whatever the direction's length";
  EXPECT_GT(red + green + blue, 0.0);
  EXPECT_GE(probe, 0);
  EXPECT_GT(lookups, 0u);
}

TEST(WholeWay, RaysAreCheckedLineByLine) {
  const fs::path dir = fresh_folder("bad-rays");
  for (const char* bad :
       {"0 1 0 0 0 0", "0 1 nan 0 0 -1", "0 1 0 0 0", "0 1 0 0 0 -1 7", "a b c d e f", "1e30 1 0 0 0 -1"}) {
    std::ofstream(dir / "rays.txt") << "0 1 0 0 0 -1\n" << bad << "\n";
    const RunResult r = run_probewalk(dir, {"trace", sample_pack().string(), "--rays", (dir / "rays.txt").string()});
    EXPECT_EQ(r.exit_code, 3) << bad;
    EXPECT_EQ(r.out, "") << bad;
    EXPECT_THAT(r.err, ::testing::HasSubstr("line 2")) << bad;
  }
}

TEST(WholeWay, TwoBakesAreByteIdentical) {
  const fs::path dir = fresh_folder("twice");
  const fs::path scene = sample_pack().parent_path() / "two.glb";
  for (const char* threads : {"1", "2"}) {
    const RunResult r = run_probewalk(
        dir, {"bake", scene.string(), "-o", (dir / (std::string("t") + threads + ".probes")).string(), "--resolution",
              "32", "--max-probes", "6", "--samples", "16", "--bounces", "1", "-q", "--threads", threads});
    ASSERT_EQ(r.exit_code, 0) << r.err;
  }
  EXPECT_EQ(pack_files(dir / "t1.probes"), pack_files(dir / "t2.probes"));
}

TEST(WholeWay, AnInterruptedBakeGoesOn) {
  const fs::path dir = fresh_folder("interrupted");
  const fs::path scene = sample_pack().parent_path() / "two.glb";
  const fs::path pack = dir / "cut.probes";
  const std::vector<std::string> command{"bake",         scene.string(), "-o",           pack.string(),
                                         "--resolution", "256",          "--max-probes", "10",
                                         "--samples",    "16",           "--bounces",    "1"};
  const pid_t child = start_probewalk(dir, command);
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  kill(child, SIGINT);
  const RunResult first = finish_probewalk(child, dir);
  if (first.exit_code == 0) GTEST_SKIP() << "the bake was done before it could be interrupted";
  EXPECT_EQ(first.exit_code, 5) << first.err;
  EXPECT_FALSE(fs::exists(pack / "pack.json"));
  ASSERT_EQ(run_probewalk(dir, command).exit_code, 0);
  const fs::path straight = dir / "straight.probes";
  std::vector<std::string> again = command;
  again[3] = straight.string();
  ASSERT_EQ(run_probewalk(dir, again).exit_code, 0);
  EXPECT_EQ(pack_files(pack), pack_files(straight));
}

TEST(WholeWay, AnOffscreenWalkLeavesAReport) {
  const fs::path dir = fresh_folder("walk");
  const RunResult r =
      run_probewalk(dir, {"walk", sample_pack().string(), "--display", "offscreen", "--frames", "40", "--eye-size",
                          "80x60", "--samples", "2", "--report", (dir / "report").string()});
  ASSERT_EQ(r.exit_code, 0) << r.err;
  const json summary = json::parse(read_text(dir / "report/summary.json"));
  expect_contract(summary);
  EXPECT_EQ(summary["frames"].get<int>() + summary["warmup_frames"].get<int>(), 40);
  EXPECT_EQ(summary["display"], "offscreen");
  EXPECT_EQ(summary["samples"], 2);
  const std::string csv = read_text(dir / "report/frames.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 41);
  EXPECT_GT(read_text(dir / "report/index.html").size(), 10000u);
  EXPECT_THAT(trace_faults(json::parse(read_text(dir / "report/trace.json"))), testing::IsEmpty());
  // And the report can be made again from the run's own files.
  EXPECT_EQ(run_probewalk(dir, {"report", (dir / "report").string(), "-o", (dir / "again").string()}).exit_code, 0);
  EXPECT_TRUE(fs::exists(dir / "again/index.html"));
}

TEST(WholeWay, StillsGetMoreRaysAtEdgesWhenAsked) {
  const fs::path dir = fresh_folder("samples");
  std::map<std::string, std::string> pictures;
  for (const char* samples : {"1", "4"}) {
    const fs::path picture = dir / (std::string(samples) + ".png");
    const RunResult r = run_probewalk(dir, {"render", sample_pack().string(), "-o", picture.string(), "--size",
                                            "160x120", "--samples", samples, "--aov", "rays", "--json"});
    ASSERT_EQ(r.exit_code, 0) << r.err;
    const json report = json::parse(r.out);
    EXPECT_EQ(report["samples"], std::stoi(samples));
    if (report["samples"] == 1) {
      EXPECT_EQ(report["rays_mean"], 1.0);
    } else {
      EXPECT_GT(report["rays_mean"], 1.02);
      EXPECT_LT(report["rays_mean"], 3.0);
    }
    EXPECT_TRUE(fs::exists(dir / (std::string(samples) + "-rays.png")));
    pictures[samples] = read_text(picture);
  }
  EXPECT_NE(pictures["1"], pictures["4"]);
}

TEST(WholeWay, StillsAreRepeatableAndNotBlack) {
  const fs::path dir = fresh_folder("stills");
  std::string last;
  for (const char* name : {"a.png", "b.png"}) {
    const RunResult r = run_probewalk(
        dir, {"render", sample_pack().string(), "-o", (dir / name).string(), "--size", "160x120", "--stereo"});
    ASSERT_EQ(r.exit_code, 0) << r.err;
    const std::string bytes = read_text(dir / name);
    EXPECT_GT(bytes.size(), 4000u) << "a flat picture compresses to less";
    if (!last.empty()) {
      EXPECT_EQ(bytes, last);
    }
    last = bytes;
  }
}

}  // namespace
}  // namespace probewalk::test
