// Rooms that were found, corrected by hand: bake, `info --rooms`, an editor, `bake --rooms`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tools/run_probewalk.h"

namespace probewalk::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

// Two rooms that their author has not named.
fs::path unnamed_rooms(const fs::path& dir) {
  const RunResult made = run_probewalk(dir, {"scene", "two-rooms", "-o", (dir / "named.glb").string()});
  if (made.exit_code != 0) throw std::runtime_error(made.err);
  std::string bytes = read_text(dir / "named.glb");
  const std::string key = "\"probewalk_room", other = "\"probewalk_none";
  for (std::size_t at = bytes.find(key); at != std::string::npos; at = bytes.find(key, at)) bytes.replace(at, key.size(), other);
  std::ofstream(dir / "rooms.glb", std::ios::binary) << bytes;
  return dir / "rooms.glb";
}

// Bakes as little as there is.
RunResult bake(const fs::path& dir, const fs::path& scene, const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments{"bake", scene.string(), "-o", (dir / "r.probes").string(), "--resolution", "32",
                                     "--max-probes", "2", "--samples", "8", "--bounces", "0", "--scale", "1"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_probewalk(dir, arguments);
}

json info(const fs::path& dir, const char* option) {
  const RunResult r = run_probewalk(dir, {"info", (dir / "r.probes").string(), option});
  EXPECT_EQ(r.exit_code, 0) << r.err;
  return json::parse(r.out);
}

void write(const fs::path& file, const json& rooms) { std::ofstream(file) << rooms.dump(2); }

TEST(RoomsFile, CorrectsTheRoomsThatWereFound) {
  const fs::path dir = fresh_folder("rooms-file");
  const fs::path scene = unnamed_rooms(dir);
  ASSERT_EQ(bake(dir, scene).exit_code, 0);
  json rooms = info(dir, "--rooms");
  ASSERT_EQ(rooms["rooms"].size(), 2u);
  EXPECT_EQ(rooms["rooms"][0]["id"], "room-1");
  const json found = info(dir, "--json");
  ASSERT_EQ(found["rooms"][0]["portals"].size(), 1u);

  // Another name: the same rooms and opening.
  rooms["rooms"][0]["id"] = "hall";
  rooms["rooms"][0]["name"] = "The hall";
  write(dir / "edited.json", rooms);
  const RunResult renamed = bake(dir, scene, {"--rooms", (dir / "edited.json").string()});
  ASSERT_EQ(renamed.exit_code, 0) << renamed.err;
  const json named = info(dir, "--json");
  ASSERT_EQ(named["rooms"].size(), 2u);
  EXPECT_EQ(named["rooms"][0]["id"], "hall");
  EXPECT_EQ(named["rooms"][0]["name"], "The hall");
  ASSERT_EQ(named["rooms"][0]["portals"].size(), 1u);
  EXPECT_EQ(info(dir, "--rooms"), rooms) << "what was read comes out again";

  // One box in the place of two, and beside the scene: one room.
  json one = rooms;
  for (int c = 0; c < 3; ++c) {
    one["rooms"][0]["min"][c] = std::min(rooms["rooms"][0]["min"][c].get<double>(), rooms["rooms"][1]["min"][c].get<double>());
    one["rooms"][0]["max"][c] = std::max(rooms["rooms"][0]["max"][c].get<double>(), rooms["rooms"][1]["max"][c].get<double>());
  }
  one["rooms"].erase(1);
  write(dir / "rooms.json", one);
  ASSERT_EQ(bake(dir, scene).exit_code, 0);
  ASSERT_EQ(info(dir, "--json")["rooms"].size(), 1u);
}

TEST(RoomsFile, IsRefusedByWhatIsWrongInIt) {
  const fs::path dir = fresh_folder("rooms-file-wrong");
  const fs::path scene = unnamed_rooms(dir);
  const json box{{"id", "a"}, {"min", {0, 0, 0}}, {"max", {1, 1, 1}}};
  write(dir / "twice.json", {{"rooms", {box, box}}});
  const RunResult twice = bake(dir, scene, {"--rooms", (dir / "twice.json").string()});
  EXPECT_EQ(twice.exit_code, 3);
  EXPECT_THAT(twice.err, AllOf(HasSubstr("twice.json"), HasSubstr("'a'"), HasSubstr("used twice")));
}

TEST(RoomsFile, OfAMovedSceneIsNotGiven) {
  const fs::path dir = fresh_folder("rooms-file-moved");
  ASSERT_EQ(bake(dir, unnamed_rooms(dir), {"--recentre"}).exit_code, 0);
  const RunResult r = run_probewalk(dir, {"info", (dir / "r.probes").string(), "--rooms"});
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_THAT(r.err, HasSubstr("--recentre"));
}

}  // namespace
}  // namespace probewalk::test
