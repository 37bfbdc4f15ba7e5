// Credits on their way from a scene or --credits through a bake to `info`: whole for programs, harmless on a terminal.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "tools/run_probewalk.h"

namespace probewalk::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

// The sample room with another `asset`, in binary glTF.
fs::path room_of(const fs::path& dir, const json& asset) {
  const RunResult made = run_probewalk(dir, {"scene", "box-room", "-o", (dir / "box.glb").string()});
  if (made.exit_code != 0) throw std::runtime_error(made.err);
  const std::string bytes = read_text(dir / "box.glb");
  const auto word = [](std::uint32_t value) { return std::string(reinterpret_cast<const char*>(&value), 4); };
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + 12, 4);
  json document = json::parse(bytes.substr(20, length));
  document["asset"] = asset;
  std::string text = document.dump();
  while (text.size() % 4 != 0) text.push_back(' ');
  const std::string rest = bytes.substr(20 + length);
  std::ofstream(dir / "credited.glb", std::ios::binary)
      << "glTF" << word(2) << word(static_cast<std::uint32_t>(20 + text.size() + rest.size()))
      << word(static_cast<std::uint32_t>(text.size())) << "JSON" << text << rest;
  return dir / "credited.glb";
}

// Bakes as little as there is.
RunResult bake(const fs::path& dir, const fs::path& scene, const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments{"bake", scene.string(), "-o", (dir / "c.probes").string(), "--resolution", "32",
                                     "--max-probes", "1", "--samples", "8", "--bounces", "0"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_probewalk(dir, arguments);
}

TEST(Credits, OfTheSceneReachInfoAndManifest) {
  const fs::path dir = fresh_folder("credits-scene");
  const json asset{{"version", "2.0"},
                   {"copyright", "(c) Zo\xc3\xab \x1b[31mRed\x1b[0m\nnext line\x7f"},
                   {"extras", {{"title", "A room"}, {"license", "CC BY 4.0"}}}};
  ASSERT_EQ(bake(dir, room_of(dir, asset)).exit_code, 0);
  const std::string credits = "A room, CC BY 4.0, " + asset["copyright"].get<std::string>();
  EXPECT_THAT(json::parse(read_text(dir / "c.probes" / "pack.json")).dump(), HasSubstr("A room, CC BY 4.0"));
  const RunResult machine = run_probewalk(dir, {"info", (dir / "c.probes").string(), "--json"});
  ASSERT_EQ(machine.exit_code, 0) << machine.err;
  EXPECT_EQ(json::parse(machine.out)["credits"], credits) << "as the author wrote them";
  EXPECT_THAT(machine.out, Not(HasSubstr("\x1b")));
  const RunResult people = run_probewalk(dir, {"info", (dir / "c.probes").string()});
  EXPECT_THAT(people.out, AllOf(HasSubstr("credits    A room, CC BY 4.0, (c) Zo\xc3\xab [31mRed [0m next line \n"),
                                Not(HasSubstr("\x1b")), Not(HasSubstr("\x7f"))));
}

TEST(Credits, OfAFileReplaceTheScenesOwn) {
  const fs::path dir = fresh_folder("credits-file");
  const fs::path scene = room_of(dir, {{"version", "2.0"}, {"copyright", "Somebody"}});
  // Long, of several lines, and with a byte that is no UTF-8.
  std::string text = "Room by Anna\nLicence: \xff\n";
  while (text.size() < 60000) text += "and all who helped, ";
  std::ofstream(dir / "credits.txt", std::ios::binary) << text << "THE END\n\n";
  const RunResult baked = bake(dir, scene, {"--credits", (dir / "credits.txt").string()});
  ASSERT_EQ(baked.exit_code, 0) << baked.err;
  const RunResult r = run_probewalk(dir, {"info", (dir / "c.probes").string(), "--json"});
  ASSERT_EQ(r.exit_code, 0) << r.err;
  const std::string credits = json::parse(r.out)["credits"];
  EXPECT_TRUE(credits.starts_with("Room by Anna\nLicence: \xef\xbf\xbd\n")) << credits.substr(0, 60);
  EXPECT_TRUE(credits.ends_with("THE END"));
  const RunResult people = run_probewalk(dir, {"info", (dir / "c.probes").string()});
  EXPECT_THAT(people.out, HasSubstr("credits    Room by Anna Licence: "));
  EXPECT_THAT(people.out, HasSubstr("THE END\n"));
}

TEST(Credits, AFileThatCannotBeTakenIsRefusedInOneLine) {
  const fs::path dir = fresh_folder("credits-refused");
  const fs::path scene = room_of(dir, {{"version", "2.0"}});
  std::ofstream(dir / "long.txt") << std::string(100000, 'x');
  const std::pair<const char*, const char*> cases[] = {{"absent.txt", "no such file"},
                                                       {"long.txt", "more than the limit of 65536"}};
  for (const auto& [file, what] : cases) {
    const RunResult r = bake(dir, scene, {"-q", "--credits", (dir / file).string()});
    EXPECT_EQ(r.exit_code, 3) << r.err;
    EXPECT_THAT(r.err, AllOf(HasSubstr(file), HasSubstr(what)));
    EXPECT_FALSE(fs::exists(dir / "c.probes"));
  }
}

// What a file says about itself reaches people in warnings and errors, too.
TEST(Credits, NoNameInAFileSteersTheTerminal) {
  const fs::path dir = fresh_folder("names-steer");
  std::ofstream(dir / "evil.gltf") << R"({"asset":{"version":"2.0"},"extensionsRequired":["EXT_\u001b[2J\u009b2J"]})";
  const RunResult r = run_probewalk(dir, {"bake", (dir / "evil.gltf").string(), "-o", (dir / "c.probes").string()});
  EXPECT_EQ(r.exit_code, 3);
  EXPECT_THAT(r.err, HasSubstr("needs the extension EXT_ [2J 2J"));
  EXPECT_THAT(r.err, AllOf(Not(HasSubstr("\x1b")), Not(HasSubstr("\xc2\x9b"))));
}

}  // namespace
}  // namespace probewalk::test
