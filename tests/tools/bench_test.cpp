// `probewalk bench` as other programs call it: the rows of the contract, what they say of a plain room, and its page.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <thread>

#include "tools/run_probewalk.h"

namespace probewalk::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kViews = 2, kWidth = 40, kHeight = 30;

// A plain room with a block, baked small.
struct Room {
  fs::path folder, scene, pack;
};

const Room& room() {
  static const Room made = [] {
    Room r;
    r.folder = fresh_folder("bench");
    r.scene = r.folder / "room.glb";
    r.pack = r.folder / "room.probes";
    if (run_probewalk(r.folder, {"scene", "box-room", "-o", r.scene.string(), "-q"}).exit_code != 0) {
      throw std::runtime_error(read_text(r.folder / "stderr"));
    }
    const RunResult bake = run_probewalk(r.folder, {"bake", r.scene.string(), "-o", r.pack.string(), "--resolution", "128",
                                                    "--radiance-resolution", "32", "--max-probes", "8", "--samples", "8", "-q"});
    if (bake.exit_code != 0) throw std::runtime_error(bake.err);
    return r;
  }();
  return made;
}

std::vector<std::string> small_run(const fs::path& out, const std::vector<std::string>& more) {
  std::vector<std::string> words{"bench",  room().pack.string(),  "-o",       out.string(), "--size",    "40x30", "--picture-size",
                                 "48x32",  "--views",             "2",        "--repeats",  "2",         "--cache",
                                 (room().folder / "cache").string(), "-q"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

// With triangles, by some of the methods; made once.
struct Results {
  fs::path out;
  RunResult run;
  Json rows;
};

const Results& results() {
  static const Results made = [] {
    Results r;
    r.out = fresh_folder("bench-results");
    r.run = run_probewalk(r.out, small_run(r.out, {"--scene", room().scene.string(), "--methods",
                                                   "oat,oat-flat,environment,march-2d-hierarchical,two-level", "--map-resolutions",
                                                   "64,128", "--json"}));
    if (r.run.exit_code != 0) throw std::runtime_error(r.run.err);
    r.rows = Json::parse(read_text(r.out / "results.json"));
    return r;
  }();
  return made;
}

const Json& row_of(const Json& rows, const std::string& method, const std::string& settings) {
  for (const Json& row : rows) {
    if (row["method"] == method && row["settings"] == settings) return row;
  }
  throw std::runtime_error("no row of " + method + ", " + settings);
}

const Json& default_row() { return row_of(results().rows, "oat", "default"); }

// Lines of fields; quotes are undone.
std::vector<std::vector<std::string>> parse_csv(const std::string& text) {
  std::vector<std::vector<std::string>> lines;
  std::vector<std::string> fields;
  std::string field;
  bool quoted = false;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    if (quoted && c == '"' && k + 1 < text.size() && text[k + 1] == '"') {
      field += '"';
      ++k;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      fields.push_back(std::exchange(field, {}));
    } else if (c == '\n' && !quoted) {
      fields.push_back(std::exchange(field, {}));
      lines.push_back(std::exchange(fields, {}));
    } else if (c != '\r' || quoted) {
      field += c;
    }
  }
  return lines;
}

TEST(Bench, EveryRowHasTheKeysOfTheContract) {
  const std::map<std::string, bool> keys{// whether it is a text
      {"scene", true},          {"method", true},          {"settings", true},       {"device", true},
      {"views", false},         {"width", false},          {"height", false},        {"rays", false},
      {"ns_per_ray_median", false}, {"ns_per_ray_spread", false}, {"lookups_mean", false}, {"lookups_p99", false},
      {"attribute_reads_mean", false}, {"probes_mean", false}, {"hit_error_p50", false}, {"hit_error_p95", false},
      {"hit_error_p99", false}, {"tracer_error_max", false}, {"wrong_surface_fraction", false}, {"hole_fraction", false},
      {"nan_count", false},     {"flip_mean", false},      {"psnr_db", false},       {"bytes_device", false}};
  ASSERT_TRUE(results().rows.is_array());
  ASSERT_GT(results().rows.size(), 10u);
  for (const Json& row : results().rows) {
    for (const auto& [key, is_text] : keys) {
      ASSERT_TRUE(row.contains(key)) << key;
      const bool has_none = key == "tracer_error_max" && row["method"] != "oat" && row["method"] != "oat-flat";
      if (has_none && row[key].is_null()) continue;
      EXPECT_TRUE(is_text ? row[key].is_string() : row[key].is_number()) << key << " of " << row.dump();
    }
  }
}

TEST(Bench, StdoutIsResultsJsonAndNothingElse) {
  EXPECT_EQ(Json::parse(results().run.out), results().rows);
  EXPECT_TRUE(results().run.err.empty()) << results().run.err;
}

TEST(Bench, TheCsvSaysTheSame) {
  const auto lines = parse_csv(read_text(results().out / "results.csv"));
  const Json& rows = results().rows;
  ASSERT_EQ(lines.size(), rows.size() + 1);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    ASSERT_EQ(lines[k + 1].size(), rows[k].size());
    std::size_t column = 0;
    for (const auto& [key, value] : rows[k].items()) {
      ASSERT_EQ(lines[0][column], key);
      const std::string& field = lines[k + 1][column++];
      if (value.is_null()) {
        EXPECT_EQ(field, "") << key;
      } else if (value.is_string()) {
        EXPECT_EQ(field, value.get<std::string>());
      } else {
        EXPECT_EQ(std::stod(field), value.get<double>()) << key;
      }
    }
  }
}

TEST(Bench, TellsWhatTheSecondEyeCosts) {
  const Json rows = Json::parse(read_text(results().out / "eyes.json"));
  ASSERT_EQ(rows.size(), 3u);
  for (const Json& row : rows) {
    EXPECT_EQ(row["scene"], "room");
    EXPECT_EQ(row["heads"], kViews);
    for (const char* key : {"first_ns_per_ray", "time_ratio", "first_lookups_mean", "second_lookups_mean"}) {
      EXPECT_GT(row[key].get<double>(), 0.0) << key;
    }
    for (const char* key : {"first_wrong_surface_fraction", "second_wrong_surface_fraction"}) {
      EXPECT_LT(row[key].get<double>(), 0.05) << key;
    }
    EXPECT_TRUE(row["second_over_first"].is_number());
  }
  EXPECT_EQ(rows[0]["settings"], "each eye by itself");
  // What is shared is found by the same sums.
  EXPECT_EQ(rows[1]["identical_fraction"], 1.0);
  EXPECT_EQ(rows[1]["class_changes"], 0);
  // The first eye is as ever, the second walks through fewer probes.
  EXPECT_EQ(rows[2]["settings"], "default");
  EXPECT_GE(rows[2]["identical_fraction"].get<double>(), 0.5);
  EXPECT_LT(rows[2]["identical_fraction"].get<double>(), 1.0);
  EXPECT_EQ(rows[2]["first_lookups_mean"], rows[0]["first_lookups_mean"]);
  EXPECT_LT(rows[2]["second_probes_mean"].get<double>(), 0.7 * rows[0]["second_probes_mean"].get<double>());
  EXPECT_EQ(rows[0]["time_ratio"], 1.0);
  EXPECT_EQ(rows[0]["second_lookups_mean"], rows[1]["second_lookups_mean"]);
  const auto lines = parse_csv(read_text(results().out / "eyes.csv"));
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_EQ(lines[0].size(), rows[0].size());
  EXPECT_EQ(lines[1][1], "each eye by itself");
}

TEST(Bench, OneRowIsTheProductAsItShips) {
  std::size_t count = 0;
  for (const Json& row : results().rows) count += row["settings"] == "default";
  EXPECT_EQ(count, 1u);
  const Json& row = default_row();
  EXPECT_EQ(row["scene"], "room");
  EXPECT_EQ(row["time_ratio"], 1.0);
}

TEST(Bench, CountsArePlausible) {
  std::set<std::string> methods;
  for (const Json& row : results().rows) {
    const std::string name = row["method"].get<std::string>() + ", " + row["settings"].get<std::string>();
    methods.insert(row["method"]);
    EXPECT_EQ(row["views"], kViews);
    EXPECT_EQ(row["width"], kWidth);
    EXPECT_EQ(row["height"], kHeight);
    EXPECT_EQ(row["rays"], kViews * kWidth * kHeight);
    EXPECT_GT(row["ns_per_ray_median"].get<double>(), 0.0) << name;
    EXPECT_GE(row["ns_per_ray_spread"].get<double>(), 0.0) << name;
    EXPECT_EQ(row["nan_count"], 0) << name;
    EXPECT_GT(row["bytes_device"].get<double>(), 0.0) << name;
    EXPECT_GE(row["probes_mean"].get<double>(), 1.0) << name;
    EXPECT_LE(row["probes_mean"].get<double>(), 16.0) << name;
    EXPECT_GT(row["attribute_reads_mean"].get<double>(), 0.0) << name;
    EXPECT_GE(row["wrong_surface_fraction"].get<double>(), 0.0) << name;
    EXPECT_LE(row["wrong_surface_fraction"].get<double>() + row["hole_fraction"].get<double>(), 1.0) << name;
    EXPECT_LE(row["hit_error_p50"].get<double>(), row["hit_error_p95"].get<double>()) << name;
    EXPECT_LE(row["hit_error_p95"].get<double>(), row["hit_error_p99"].get<double>()) << name;
    EXPECT_GT(row["flip_mean"].get<double>(), 0.0) << name;
    EXPECT_LT(row["flip_mean"].get<double>(), 1.0) << name;
    if (row["method"] != "environment") {
      EXPECT_GE(row["lookups_p99"].get<double>(), row["lookups_mean"].get<double>()) << name;
    }
  }
  EXPECT_EQ(methods, (std::set<std::string>{"oat", "oat-flat", "environment", "march-2d-hierarchical", "two-level"}));
  EXPECT_GT(default_row()["lookups_mean"].get<double>(), 1.0);
}

TEST(Bench, ThePlainRoomIsAnsweredExactlyButForOutlines) {
  const Json& row = default_row();
  EXPECT_LT(row["hit_error_p50"].get<double>(), 1e-5);  // floats of metres
  EXPECT_LT(row["wrong_surface_fraction"].get<double>(), 0.03);
  EXPECT_LT(row["tracer_error_max"].get<double>(), 1e-2);
  EXPECT_LT(row["tracer_error_p99"].get<double>(), 1e-4);
  EXPECT_EQ(row["tracer_disagreements"], 0);
}

TEST(Bench, MethodsDifferAsTheyMust) {
  const Json& rows = results().rows;
  const Json flat = row_of(rows, "oat-flat", "resolution 128");
  // The pyramid saves look-ups; its planes change distances by what rounding does, and no class but in ties.
  EXPECT_GT(flat["lookups_mean"].get<double>(), default_row()["lookups_mean"].get<double>());
  for (const char* key : {"hit_error_p50", "hit_error_p99", "wrong_surface_fraction", "hole_fraction", "flip_mean"}) {
    const double with = default_row()[key], without = flat[key];
    EXPECT_NEAR(with, without, 0.1 * without + 1e-4) << key;
  }
  // Marches find texels, not planes; larger maps find them better.
  for (const char* march : {"march-2d-hierarchical", "two-level"}) {
    const double coarse = row_of(rows, march, "maps 64")["hit_error_p50"], fine = row_of(rows, march, "maps 128")["hit_error_p50"];
    EXPECT_GT(coarse, fine) << march;
    EXPECT_GT(fine, 100.0 * default_row()["hit_error_p50"].get<double>()) << march;
    EXPECT_GT(row_of(rows, march, "maps 128")["bytes_device"].get<double>(), row_of(rows, march, "maps 64")["bytes_device"].get<double>());
  }
  // One probe as if all were infinitely far: no answer but the direction.
  EXPECT_GT(row_of(rows, "environment", "resolution 128")["flip_mean"].get<double>(), default_row()["flip_mean"].get<double>());
}

TEST(Bench, ThePageTellsAllOfIt) {
  const std::string page = read_text(results().out / "index.html");
  for (const char* words :
       {"<!doctype html>", "What was to be reached", "Each acceleration alone", "At equal error", "The worst view of each method",
        "pyramid", "bit-identical", "two-level", "march-2d-hierarchical", "What the words mean", "Machine, device, build", "To repeat it",
        "results.csv", "Software rasteriser", "Counted as rooms", "</html>"}) {
    EXPECT_NE(page.find(words), std::string::npos) << words;
  }
  std::size_t charts = 0;
  for (std::size_t at = page.find("class=\"front\""); at != std::string::npos; at = page.find("class=\"front\"", at + 1)) ++charts;
  EXPECT_EQ(charts, 6u);  // time and look-ups, each against three errors
  // Every picture that the page shows is there.
  std::size_t pictures = 0;
  for (std::size_t at = page.find("src=\""); at != std::string::npos; at = page.find("src=\"", at + 1)) {
    const std::size_t from = at + 5;
    const fs::path file = results().out / page.substr(from, page.find('"', from) - from);
    EXPECT_TRUE(fs::is_regular_file(file)) << file;
    ++pictures;
  }
  EXPECT_EQ(pictures, 3u * 4u);  // oat-flat draws what oat draws
  EXPECT_EQ(page.find("nan"), std::string::npos);
  EXPECT_EQ(page.find("inf "), std::string::npos);
}

TEST(Bench, WithoutASceneThePageSaysWhatIsMissing) {
  const fs::path out = fresh_folder("bench-no-scene");
  const RunResult run = run_probewalk(out, small_run(out, {"--no-variants"}));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json rows = Json::parse(read_text(out / "results.json"));
  for (const Json& row : rows) {
    for (const char* key : {"hit_error_p50", "wrong_surface_fraction", "flip_mean", "psnr_db"}) EXPECT_TRUE(row[key].is_null()) << key;
    EXPECT_TRUE(row["lookups_mean"].is_number());
    EXPECT_NE(row["method"], "two-level");
  }
  EXPECT_TRUE(row_of(rows, "oat", "default")["tracer_error_max"].is_number());
  EXPECT_NE(read_text(out / "index.html").find("No scene was named"), std::string::npos);
}

TEST(Bench, TakesPacksWithRoomsWithoutProbes) {
  const fs::path out = fresh_folder("bench-bare-room");
  const std::string scene = (out / "rooms.glb").string(), pack = (out / "rooms.probes").string();
  ASSERT_EQ(run_probewalk(out, {"scene", "two-rooms", "-o", scene, "-q"}).exit_code, 0);
  ASSERT_EQ(run_probewalk(out, {"bake", scene, "-o", pack, "--resolution", "64", "--radiance-resolution", "16",
                                "--max-probes", "1", "--samples", "8", "-q"})
                .exit_code,
            0);
  const Json manifest = Json::parse(read_text(fs::path(pack) / "pack.json"));
  int bare = 0;
  for (const Json& entry : manifest["rooms"]) bare += entry["levels"].empty();
  ASSERT_GT(bare, 0);
  const RunResult run = run_probewalk(out, {"bench", pack, "-o", (out / "results").string(), "--views", "1", "--size", "16x12",
                                            "--repeats", "1", "--no-variants", "--scene", scene, "--methods", "oat", "-q"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(fs::exists(out / "results" / "results.json"));
}

TEST(Bench, RefusesWhatItCannotDo) {
  const fs::path out = fresh_folder("bench-bad");
  const auto code = [&](const std::vector<std::string>& more) { return run_probewalk(out, small_run(out / "results", more)).exit_code; };
  EXPECT_EQ(code({"--methods", "magic"}), 2);
  EXPECT_EQ(code({"--methods", "two-level"}), 2);  // without a scene
  EXPECT_EQ(code({"--map-resolutions", "100"}), 2);
  EXPECT_EQ(code({"--size", "0x10"}), 2);
  EXPECT_EQ(code({"--scene", "a.glb", "--scene", "b.glb"}), 2);
  EXPECT_EQ(code({"--scene", (out / "none.glb").string()}), 3);
  EXPECT_EQ(run_probewalk(out, {"bench", "-o", out.string()}).exit_code, 2);
  EXPECT_EQ(run_probewalk(out, {"bench", (out / "none.probes").string(), "-o", out.string()}).exit_code, 3);
  EXPECT_FALSE(fs::exists(out / "results" / "results.json"));
}

TEST(Bench, EndsInOrderWhenInterrupted) {
  const fs::path out = fresh_folder("bench-interrupted");
  std::vector<std::string> words = small_run(out / "results", {"--no-variants"});
  std::erase(words, "-q");
  *std::find(words.begin(), words.end(), "2") = "1000";                // views; and then repeats
  *std::find(words.begin(), words.end(), "2") = "1000";
  const pid_t child = start_probewalk(out, words);
  for (int k = 0; k < 600 && read_text(out / "stderr").find("times") == std::string::npos; ++k) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  kill(child, SIGINT);
  EXPECT_EQ(finish_probewalk(child, out).exit_code, 5);
  EXPECT_FALSE(fs::exists(out / "results" / "results.json"));
}

}  // namespace
}  // namespace probewalk::test
