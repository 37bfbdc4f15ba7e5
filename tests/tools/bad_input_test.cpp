// Everything a person can get wrong: one clear line with the remedy, the contract's exit code, nothing half-written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "tools/run_probewalk.h"

namespace probewalk::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

std::size_t lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

void write(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << text;
}

// One line on stderr that names `what`; nothing on stdout; the exit code.
void expect_refused(const RunResult& r, int exit_code, const std::string& what) {
  EXPECT_EQ(r.exit_code, exit_code) << r.err;
  EXPECT_EQ(r.out, "");
  EXPECT_THAT(r.err, HasSubstr(what));
  EXPECT_LE(lines(r.err), 1u) << r.err;
}

TEST(BadInput, MissingScene) {
  const fs::path dir = fresh_folder("missing-scene");
  const RunResult r = run_probewalk(dir, {"bake", (dir / "no.glb").string(), "-o", (dir / "no.probes").string(), "-q"});
  expect_refused(r, 3, "no.glb");
  EXPECT_FALSE(fs::exists(dir / "no.probes"));
}

TEST(BadInput, ForeignScene) {
  const fs::path dir = fresh_folder("foreign-scene");
  write(dir / "picture.glb", "\x89PNG\r\n\x1a\n and so on");
  expect_refused(run_probewalk(dir, {"bake", (dir / "picture.glb").string(), "-o", (dir / "x.probes").string(), "-q"}),
                 3, "picture.glb");
  EXPECT_FALSE(fs::exists(dir / "x.probes"));
}

TEST(BadInput, TruncatedScene) {
  const fs::path dir = fresh_folder("truncated-scene");
  ASSERT_EQ(run_probewalk(dir, {"scene", "box-room", "-o", (dir / "box.glb").string()}).exit_code, 0);
  std::string bytes = read_text(dir / "box.glb");
  write(dir / "half.glb", bytes.substr(0, bytes.size() / 2));
  expect_refused(run_probewalk(dir, {"bake", (dir / "half.glb").string(), "-o", (dir / "x.probes").string(), "-q"}), 3,
                 "half.glb");
}

TEST(BadInput, UnknownRequiredExtensionIsNamed) {
  const fs::path dir = fresh_folder("required-extension");
  write(
      dir / "future.gltf",
      R"({"asset":{"version":"2.0"},"extensionsUsed":["EXT_from_the_future"],"extensionsRequired":["EXT_from_the_future"]})");
  expect_refused(run_probewalk(dir, {"bake", (dir / "future.gltf").string(), "-o", (dir / "x.probes").string(), "-q"}),
                 3, "EXT_from_the_future");
}

TEST(BadInput, PackNameWithoutItsEnding) {
  const fs::path dir = fresh_folder("pack-name");
  ASSERT_EQ(run_probewalk(dir, {"scene", "box-room", "-o", (dir / "box.glb").string()}).exit_code, 0);
  const RunResult r = run_probewalk(dir, {"bake", (dir / "box.glb").string(), "-o", (dir / "box").string(), "-q"});
  expect_refused(r, 2, ".probes");
}

TEST(BadInput, MissingForeignTruncatedPack) {
  const fs::path dir = fresh_folder("bad-packs");
  expect_refused(run_probewalk(dir, {"info", (dir / "none.probes").string()}), 3, "none.probes");
  fs::create_directories(dir / "empty.probes");
  expect_refused(run_probewalk(dir, {"info", (dir / "empty.probes").string()}), 3, "pack.json");
  write(dir / "foreign.probes/pack.json", R"({"hello":"world"})");
  expect_refused(run_probewalk(dir, {"info", (dir / "foreign.probes").string()}), 3, "pack.json");
  write(dir / "cut.probes/pack.json", R"({"format_version":1,"rooms":[)");
  for (const char* command : {"info", "walk"}) {
    expect_refused(run_probewalk(dir, {command, (dir / "cut.probes").string()}), 3, "pack.json");
  }
}

TEST(BadInput, WrongOptionsAndCommands) {
  const fs::path dir = fresh_folder("wrong-options");
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"fly"}, {"bake"}, {"walk", "x.probes", "--display", "hologram"}, {"info", "x.probes", "--such"},
           {"walk", "x.probes", "--samples", "3"}, {"render", "x.probes", "-o", "x.png", "--samples", "many"}}) {
    const RunResult r = run_probewalk(dir, arguments);
    EXPECT_EQ(r.exit_code, 2) << arguments[0];
    EXPECT_NE(r.err, "") << arguments[0];
  }
}

TEST(BadInput, UnknownSampleSceneListsTheKnown) {
  const fs::path dir = fresh_folder("unknown-sample");
  const RunResult r = run_probewalk(dir, {"scene", "castle", "-o", (dir / "c.glb").string()});
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_THAT(r.err, HasSubstr("house"));
  EXPECT_FALSE(fs::exists(dir / "c.glb"));
}

TEST(BadInput, TraceNamesAMissingPack) {
  const fs::path dir = fresh_folder("trace-no-pack");
  write(dir / "rays.txt", "0 1 0 0 0 -1\n");
  expect_refused(run_probewalk(dir, {"trace", (dir / "no.probes").string(), "--rays", (dir / "rays.txt").string()}), 3,
                 "no.probes");
}

TEST(Help, TeachesEveryCommand) {
  const fs::path dir = fresh_folder("help");
  const RunResult whole = run_probewalk(dir, {"--help"});
  EXPECT_EQ(whole.exit_code, 0);
  for (const char* command : {"scene", "bake", "info", "walk", "render", "trace", "report", "stability"}) {
    EXPECT_THAT(whole.out, HasSubstr(command));
    const RunResult r = run_probewalk(dir, {command, "--help"});
    EXPECT_EQ(r.exit_code, 0) << command;
    EXPECT_GT(lines(r.out), 8u) << command;
  }
  EXPECT_THAT(run_probewalk(dir, {"--version"}).out, HasSubstr("probewalk"));
}

}  // namespace
}  // namespace probewalk::test
