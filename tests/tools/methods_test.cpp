// --method and the selection of probes, as other programs ask for them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "content/image/image.h"
#include "support/room_pack.h"
#include "support/write_gltf.h"
#include "tools/run_probewalk.h"

namespace probewalk::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const char* const kMethods[] = {"oat",      "oat-flat", "environment",           "sphere-proxy", "box-proxy", "impostor",
                                "march-3d", "march-2d", "march-2d-hierarchical", "two-level",    "restart"};

bool needs_scene(const std::string& method) { return method != "oat" && method != "oat-flat" && method != "environment"; }

struct Room {
  fs::path folder = fresh_folder("methods");
  fs::path pack = folder / "room.probes", scene = folder / "room.gltf";
  Room() {
    write_room_pack(pack);
    write_gltf(scene, furnished_room());
    ::setenv("XDG_CACHE_HOME", (folder / "cache").c_str(), 1);
  }
};

const Room& room() {
  static const Room made;
  return made;
}

RunResult run(const std::string& name, std::vector<std::string> words) {
  return run_probewalk(fresh_folder("methods-" + name), words);
}

struct Line {
  std::string cls;
  double t = 0.0;
  unsigned lookups = 0;
};

// The answers of `probewalk trace` to rays through the room.
std::vector<Line> traced(const std::string& name, const std::vector<std::string>& more) {
  const fs::path rays = room().folder / "rays.txt";
  std::ofstream out(rays);
  for (int k = 0; k < 400; ++k) {
    const double turn = 2.4 * k, rise = std::sin(0.37 * k);
    out << 0.9 * std::sin(1.7 * k) << " " << 1.3 + 0.2 * std::cos(k) << " " << 0.9 * std::cos(2.3 * k) << " "
        << std::cos(turn) << " " << 0.6 * rise << " " << std::sin(turn) << "\n";
  }
  out.close();
  std::vector<std::string> words{"trace", room().pack.string(), "--rays", rays.string(), "--quiet"};
  words.insert(words.end(), more.begin(), more.end());
  const RunResult result = run(name, words);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  std::vector<Line> lines;
  std::istringstream text(result.out);
  std::string cls, t, r, g, b, probe, lookups;
  while (text >> cls >> t >> r >> g >> b >> probe >> lookups) {
    lines.push_back({cls, std::strtod(t.c_str(), nullptr), static_cast<unsigned>(std::stoul(lookups))});
  }
  EXPECT_EQ(lines.size(), 400u) << result.out.substr(0, 300);
  return lines;
}

std::vector<std::string> options_of(const std::string& method) {
  std::vector<std::string> words{"--method", method};
  if (needs_scene(method)) words.insert(words.end(), {"--scene", room().scene.string()});
  return words;
}

double share_within(const std::vector<Line>& lines, const std::vector<Line>& truth, double tolerance) {
  std::size_t good = 0;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    good += lines[k].cls == truth[k].cls && (lines[k].t == truth[k].t || std::abs(lines[k].t / truth[k].t - 1) < tolerance);
  }
  return static_cast<double>(good) / static_cast<double>(lines.size());
}

TEST(Methods, TraceAnswersByEachOfThem) {
  const std::vector<Line> product = traced("oat", {});
  std::map<std::string, double> agreeing;
  for (const std::string method : kMethods) {
    const std::vector<Line> lines = traced("trace-" + method, options_of(method));
    agreeing[method] = share_within(lines, product, 0.1);
  }
  EXPECT_EQ(agreeing["oat"], 1.0);
  EXPECT_EQ(agreeing["oat-flat"], 1.0);
  // Those that march on maps of depth come near to the product; those that know no depth do not.
  for (const char* method : {"march-3d", "march-2d", "march-2d-hierarchical", "two-level"}) {
    EXPECT_GT(agreeing[method], 0.75) << method;
    EXPECT_LT(agreeing[method], 1.0) << method;
  }
  EXPECT_GT(agreeing["box-proxy"], agreeing["sphere-proxy"]);
  EXPECT_GT(agreeing["box-proxy"], agreeing["environment"]);
  EXPECT_LT(agreeing["environment"], 0.6);
  // The maps of all were cast once.
  EXPECT_EQ(std::distance(fs::directory_iterator(room().folder / "cache" / "probewalk"), fs::directory_iterator()), 1);
}

TEST(Methods, StillsDifferAsTheMethodsDo) {
  const fs::path dir = fresh_folder("methods-stills");
  std::map<std::string, ImageRgb8> pictures;
  for (const std::string method : {"oat", "oat-flat", "environment", "two-level"}) {
    const fs::path file = dir / (method + ".png");
    std::vector<std::string> words{"render", room().pack.string(), "-o", file.string(), "--size", "96x64", "--json",
                                   "--pose", "0.5,1.5,0.3,-60,-10"};
    const auto more = options_of(method);
    words.insert(words.end(), more.begin(), more.end());
    const RunResult result = run("still-" + method, words);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const auto report = nlohmann::json::parse(result.out);
    EXPECT_EQ(report["method"], method);
    EXPECT_EQ(report["settings"], "default");
    pictures[method] = read_png(file);
  }
  // Cell by cell, planes are met as the samples say and not as the pyramid does: within 1e-5 of the distance.
  EXPECT_GT(psnr_db(pictures["oat"], pictures["oat-flat"]), 50.0);
  EXPECT_NE(pictures["oat"].rgb, pictures["two-level"].rgb);
  const auto psnr = [&](const char* method) { return psnr_db(pictures["oat"], pictures[method]); };
  EXPECT_GT(psnr("two-level"), psnr("environment") + 3.0);
  EXPECT_LT(psnr("environment"), 30.0);
}

TEST(Methods, AWalkNamesItsMethod) {
  for (const std::string method : {"oat", "two-level"}) {
    std::vector<std::string> words{"walk", room().pack.string(), "--display", "offscreen", "--frames", "2",
                                   "--eye-size", "32x32", "--json"};
    auto more = options_of(method);
    if (method == "two-level") more.insert(more.end(), {"--order", "xor"});
    words.insert(words.end(), more.begin(), more.end());
    const RunResult result = run("walk-" + method, words);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const std::string named = nlohmann::json::parse(result.out)["method"];
    EXPECT_EQ(named, method == "oat" ? "oat" : "two-level (order xor)");
  }
}

TEST(Methods, TheSelectionOfProbesIsAnOption) {
  const std::vector<Line> product = traced("selection", {});
  unsigned long usual = 0, nearest = 0;
  const std::vector<Line> by_distance = traced("nearest", {"--first", "nearest"});
  for (std::size_t k = 0; k < product.size(); ++k) {
    usual += product[k].lookups;
    nearest += by_distance[k].lookups;
  }
  EXPECT_GT(nearest, usual);  // the nearest probe sees more of the ray
  const std::vector<Line> one_try = traced("one-try", {"--max-tries", "1", "--last-resort", "nothing"});
  const auto unknown = [](const std::vector<Line>& lines) {
    return std::count_if(lines.begin(), lines.end(), [](const Line& line) { return line.cls == "unknown"; });
  };
  EXPECT_GT(unknown(one_try), unknown(product));
  for (const char* order : {"sorted", "plus3", "xor"}) {
    EXPECT_GT(share_within(traced(order, {"--order", order}), product, 0.01), 0.9) << order;
  }
  EXPECT_GT(share_within(traced("plain", {"--no-advance", "--no-retry", "--no-start-test", "--restart",
                                          "--distance-weight", "4"}), product, 0.01), 0.85);
}

TEST(Methods, WhatCannotBeIsRefused) {
  const std::string pack = room().pack.string(), rays = (room().folder / "rays.txt").string();
  std::ofstream(rays) << "0 1.3 0 0 0 -1\n";
  const auto refused = [&](const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> words{"trace", pack, "--rays", rays};
    words.insert(words.end(), more.begin(), more.end());
    const RunResult result = run("refused-" + name, words);
    EXPECT_EQ(result.exit_code, 2) << name << result.err;
    return result.err;
  };
  const std::string unknown = refused("unknown", {"--method", "teleport"});
  for (const char* method : kMethods) EXPECT_THAT(unknown, HasSubstr(method));
  EXPECT_THAT(refused("scene", {"--method", "two-level"}), HasSubstr("--scene FILE"));
  EXPECT_THAT(refused("no-maps", {"--scene", "x.glb"}), HasSubstr("needs none"));
  EXPECT_THAT(refused("resolution", {"--map-resolution", "64"}), HasSubstr("--map-resolution"));
  EXPECT_THAT(refused("power", {"--method", "impostor", "--scene", room().scene.string(), "--map-resolution", "100"}),
              HasSubstr("power of two"));
  EXPECT_THAT(refused("first", {"--first", "farthest"}), HasSubstr("--first"));
  EXPECT_THAT(refused("weight", {"--first", "nearest", "--distance-weight", "2"}), HasSubstr("--distance-weight"));
  EXPECT_THAT(refused("double", {"--method", "environment", "--arithmetic", "double"}), HasSubstr("double"));
  EXPECT_THAT(refused("thickness", {"--epsilon", "0.1"}), HasSubstr("--epsilon"));
  EXPECT_EQ(run("missing", {"trace", pack, "--rays", rays, "--method", "impostor", "--scene", "/nowhere.glb"}).exit_code, 3);
}

}  // namespace
}  // namespace probewalk::test
