#include "content/scene/procedural/procedural.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <glm/glm.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <string_view>

#include "content/error.h"
#include "content/scene/ray_scene.h"
#include "content/scene/scene.h"
#include "content/scene/space.h"

namespace probewalk {
namespace {

using Json = nlohmann::json;

std::uint32_t word_at(std::span<const std::byte> bytes, std::size_t offset) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + offset, sizeof word);
  return word;
}

// The two chunks of a GLB, its framing checked on the way.
struct Glb {
  explicit Glb(std::vector<std::byte> file) : bytes(std::move(file)) {
    EXPECT_EQ(word_at(bytes, 0), 0x46546C67u);
    EXPECT_EQ(word_at(bytes, 4), 2u);
    EXPECT_EQ(word_at(bytes, 8), bytes.size());
    const std::size_t text = word_at(bytes, 12);
    EXPECT_EQ(text % 4, 0u);
    EXPECT_EQ(word_at(bytes, 16), 0x4E4F534Au);
    root = Json::parse(reinterpret_cast<const char*>(bytes.data()) + 20,
                       reinterpret_cast<const char*>(bytes.data()) + 20 + text);
    EXPECT_EQ(word_at(bytes, 24 + text), 0x004E4942u);
    EXPECT_EQ(28 + text + word_at(bytes, 20 + text), bytes.size());
    binary = std::span<const std::byte>(bytes).subspan(28 + text);
  }

  std::size_t offset_of(const Json& accessor) const {
    const Json& view = root["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    return view["byteOffset"].get<std::size_t>() + accessor["byteOffset"].get<std::size_t>();
  }
  // Of every node: a mesh that stands in many places counts as often.
  std::size_t triangles() const {
    std::size_t count = 0;
    for (const Json& node : root["nodes"]) {
      if (!node.contains("mesh")) continue;
      for (const Json& primitive : root["meshes"][node["mesh"].get<std::size_t>()]["primitives"])
        count += root["accessors"][primitive["indices"].get<std::size_t>()]["count"].get<std::size_t>() / 3;
    }
    return count;
  }
  // Room boxes by name: lower x, y, z, upper x, y, z.
  std::map<std::string, std::array<double, 6>> rooms() const {
    std::map<std::string, std::array<double, 6>> found;
    for (const Json& node : root["nodes"]) {
      if (!node.contains("extras")) continue;
      const Json &lower = node["extras"]["probewalk_room_min"], &upper = node["extras"]["probewalk_room_max"];
      found[node["extras"]["probewalk_room"]] = {lower[0], lower[1], lower[2], upper[0], upper[1], upper[2]};
    }
    return found;
  }

  std::vector<std::byte> bytes;
  Json root;
  std::span<const std::byte> binary;
};

// Each scene is made once for all tests but the one that compares two makings.
const Glb& scene(std::string_view name) {
  static std::map<std::string, Glb, std::less<>> made;
  const auto found = made.find(name);
  return found != made.end() ? found->second
                             : made.emplace(std::string(name), make_procedural_glb(name)).first->second;
}

// The scene as a bake sees it.
Scene loaded_scene(const std::string& name) {
  const std::filesystem::path file = std::filesystem::path(PROBEWALK_TEST_OUTPUT_DIR) /
                                     ("procedural-" + name + "-" + std::to_string(getpid()) + ".glb");
  const std::vector<std::byte>& bytes = scene(name).bytes;
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  Scene loaded = load_scene(file);
  std::filesystem::remove(file);
  return loaded;
}

class EveryProceduralScene : public testing::TestWithParam<std::string> {};

TEST_P(EveryProceduralScene, IsTheSameBytesTwice) {
  EXPECT_EQ(scene(GetParam()).bytes, make_procedural_glb(GetParam()));
}

TEST_P(EveryProceduralScene, HasAccessorsInsideTheirBuffersAndTrueBounds) {
  const Glb& glb = scene(GetParam());
  const std::size_t buffer_bytes = glb.root["buffers"][0]["byteLength"];
  EXPECT_EQ(buffer_bytes, glb.binary.size());
  for (const Json& view : glb.root["bufferViews"]) {
    EXPECT_EQ(view["byteOffset"].get<std::size_t>() % 4, 0u);
    EXPECT_LE(view["byteOffset"].get<std::size_t>() + view["byteLength"].get<std::size_t>(), buffer_bytes);
  }
  for (const Json& mesh : glb.root["meshes"]) {
    for (const Json& primitive : mesh["primitives"]) {
      const Json& position = glb.root["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()];
      const Json& normal = glb.root["accessors"][primitive["attributes"]["NORMAL"].get<std::size_t>()];
      const Json& index = glb.root["accessors"][primitive["indices"].get<std::size_t>()];
      const std::size_t count = position["count"];
      ASSERT_EQ(normal["count"], count);
      glm::vec3 lower{1e30f}, upper{-1e30f};
      for (std::size_t i = 0; i < count; ++i) {
        glm::vec3 p, n;
        std::memcpy(&p, glb.binary.data() + glb.offset_of(position) + i * sizeof p, sizeof p);
        std::memcpy(&n, glb.binary.data() + glb.offset_of(normal) + i * sizeof n, sizeof n);
        lower = glm::min(lower, p), upper = glm::max(upper, p);
        ASSERT_NEAR(glm::length(n), 1.0f, 1e-4f) << mesh["name"];
      }
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(position["min"][axis].get<float>(), lower[axis]) << mesh["name"];
        EXPECT_EQ(position["max"][axis].get<float>(), upper[axis]) << mesh["name"];
      }
      const std::size_t width = index["componentType"] == 5123 ? 2 : 4;
      for (std::size_t i = 0; i < index["count"].get<std::size_t>(); ++i) {
        std::uint32_t value = 0;
        std::memcpy(&value, glb.binary.data() + glb.offset_of(index) + i * width, width);
        ASSERT_LT(value, count) << mesh["name"];
      }
    }
  }
}

TEST_P(EveryProceduralScene, LoadsWithoutAWarning) {
  const Scene loaded = loaded_scene(GetParam());
  EXPECT_THAT(loaded.warnings, testing::IsEmpty());
  EXPECT_EQ(loaded.scale, 1.0);
  EXPECT_EQ(loaded.triangles.size(), scene(GetParam()).triangles());
  EXPECT_EQ(loaded.rooms.size(), scene(GetParam()).rooms().size());
}

TEST_P(EveryProceduralScene, NamesItsNodesOnceAndItsExtensions) {
  const Glb& glb = scene(GetParam());
  std::set<std::string> names;
  for (const Json& node : glb.root["nodes"]) EXPECT_TRUE(names.insert(node["name"]).second) << node["name"];
  const std::string text = glb.root.dump();
  for (const std::string extension : {"KHR_lights_punctual", "KHR_materials_emissive_strength"}) {
    const Json used = glb.root.value("extensionsUsed", Json::array());
    const bool listed = std::find(used.begin(), used.end(), extension) != used.end();
    EXPECT_EQ(listed, text.find("\"" + extension + "\":") != std::string::npos) << extension;
  }
}

TEST_P(EveryProceduralScene, StartsInsideOneOfItsRooms) {
  const Glb& glb = scene(GetParam());
  const Json& start = glb.root["scenes"][0]["extras"]["probewalk_start"];
  bool inside = false;
  for (const auto& [name, box] : glb.rooms())
    inside |= start[0] >= box[0] && start[0] <= box[3] && start[1] >= box[1] && start[1] <= box[4] &&
              start[2] >= box[2] && start[2] <= box[5];
  EXPECT_TRUE(inside);
}

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const ProceduralSceneInfo& info : procedural_scenes())
    if (!info.is_heavy) names.push_back(info.name);
  return names;
}
INSTANTIATE_TEST_SUITE_P(Procedural, EveryProceduralScene, testing::ValuesIn(scene_names()),
                         [](const auto& parameter) {
                           std::string name = parameter.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(ProceduralHouse, HasItsRoomsOnTwoFloorsAndACourtyard) {
  const auto rooms = scene("house").rooms();
  int ground = 0, upper = 0;
  for (const auto& [name, box] : rooms)
    (box[1] > 2.0 ? upper : ground) += name != "Courtyard" && name != "Stairwell";
  EXPECT_GE(ground, 4);
  EXPECT_GE(upper, 4);
  EXPECT_TRUE(rooms.contains("Courtyard"));
}

TEST(ProceduralHouse, CanBeWalkedFromRoomToRoom) {
  const Scene house = loaded_scene("house");
  const RayScene rays(house);
  SilentProgress progress;
  const Space space = find_space(house, rays, {}, progress);
  std::map<std::string, double> floor_m2;
  for (const FloorNode& node : space.floor.nodes)
    if (node.room < space.rooms.size())
      floor_m2[space.rooms[node.room].name] += space.floor.cell_m * space.floor.cell_m;
  for (const auto& [name, box] : scene("house").rooms())
    EXPECT_GT(floor_m2[name], 0.4 * (box[3] - box[0]) * (box[5] - box[2])) << name;
  const auto joined = [&](const std::string& a, const std::string& b) {
    return std::any_of(space.portals.begin(), space.portals.end(), [&](const Portal& portal) {
      const std::string &first = space.rooms[portal.room_a].name, &second = space.rooms[portal.room_b].name;
      return (first == a && second == b) || (first == b && second == a);
    });
  };
  EXPECT_TRUE(joined("Hall", "Stairwell"));
  EXPECT_TRUE(joined("Stairwell", "Landing"));
  EXPECT_TRUE(joined("Hall", "Library"));
  EXPECT_TRUE(joined("Living room", "Courtyard"));
  EXPECT_TRUE(joined("Landing", "Bedroom"));
}

TEST(ProceduralHouse, NoRayPassesItsShell) {
  // Rays into corners and along seams: from the middle of each indoor room towards its edges, where walls,
  // floors and ceilings meet. Nothing there may be missed or hit from behind.
  const Scene house = loaded_scene("house");
  const RayScene rays(house);
  for (const auto& [name, box] : scene("house").rooms()) {
    if (name == "Courtyard" || name == "Stairwell") continue;
    const glm::vec3 lower(box[0], box[1], box[2]), upper(box[3], box[4], box[5]),
        middle = 0.5f * (lower + upper);
    for (int step = 0; step <= 400; ++step) {
      const float t = static_cast<float>(step) / 400.0f;
      for (const float x : {lower.x, upper.x})
        for (const float y : {lower.y, upper.y}) {
          EXPECT_TRUE(rays.closest(middle, glm::vec3(x, y, glm::mix(lower.z, upper.z, t)) - middle).hit)
              << name << ' ' << t;
        }
      for (const float z : {lower.z, upper.z})
        for (const float x : {lower.x, upper.x}) {
          const SurfaceHit hit =
              rays.closest(middle, glm::vec3(x, glm::mix(lower.y, upper.y, t), z) - middle);
          EXPECT_TRUE(hit.hit) << name << ' ' << t;
        }
    }
  }
}

TEST(ProceduralHouse, KeepsItsSize) {
  const Glb& glb = scene("house");
  EXPECT_GE(glb.triangles(), 60'000u);
  EXPECT_LE(glb.triangles(), 150'000u);
  EXPECT_LT(glb.bytes.size(), 12u << 20);
}

TEST(ProceduralHouse, HasEveryKindOfLight) {
  const Glb& glb = scene("house");
  std::set<std::string> kinds;
  for (const Json& light : glb.root["extensions"]["KHR_lights_punctual"]["lights"])
    kinds.insert(light["type"]);
  EXPECT_EQ(kinds, (std::set<std::string>{"directional", "point", "spot"}));
  EXPECT_TRUE(glb.root["scenes"][0]["extras"].contains("probewalk_sky"));
}

class ProceduralBuilding : public testing::TestWithParam<int> {};

TEST_P(ProceduralBuilding, IsWalkedThroughAllItsRoomsInOneTour) {
  const std::string name = "building-" + std::to_string(GetParam());
  const std::size_t count = static_cast<std::size_t>(GetParam());
  const Scene building = loaded_scene(name);
  ASSERT_EQ(building.rooms.size(), count);
  const RayScene rays(building);
  SilentProgress progress;
  const Space space = find_space(building, rays, {}, progress);
  ASSERT_EQ(space.rooms.size(), count);

  // Doorways join every room with every other.
  std::vector<std::size_t> joined(count);
  for (std::size_t r = 0; r < count; ++r) joined[r] = r;
  const auto root = [&](std::size_t r) {
    while (joined[r] != r) r = joined[r];
    return r;
  };
  std::size_t joins = 0;
  for (const Portal& portal : space.portals) {
    const std::size_t a = root(std::size_t(portal.room_a)), b = root(std::size_t(portal.room_b));
    if (a != b) joined[a] = b, ++joins;
  }
  EXPECT_EQ(joins, count - 1);

  std::vector<double> floor_m2(count, 0.0);
  for (const FloorNode& node : space.floor.nodes) floor_m2[node.room] += space.floor.cell_m * space.floor.cell_m;
  std::set<std::size_t> toured;
  double length_m = 0.0;
  for (std::size_t i = 0; i < space.tour.size(); ++i) {
    const std::int32_t node = space.floor.find(space.tour[i].position_m);
    ASSERT_GE(node, 0) << "pose " << i << " has no floor";
    toured.insert(space.floor.nodes[std::size_t(node)].room);
    if (i > 0) length_m += glm::distance(space.tour[i].position_m, space.tour[i - 1].position_m);
  }
  EXPECT_EQ(toured.size(), count);
  EXPECT_LT(length_m, 15.0 * double(count)) << "from room to room, not to and fro";
  for (std::size_t r = 0; r < count; ++r) {
    const Bounds& air = space.rooms[r].bounds;
    const double area_m2 = (air.upper_m.x - air.lower_m.x) * (air.upper_m.z - air.lower_m.z);
    EXPECT_GT(floor_m2[r], 0.35 * area_m2) << space.rooms[r].name;
  }
}
INSTANTIATE_TEST_SUITE_P(Procedural, ProceduralBuilding, testing::Values(20, 200));

TEST(ProceduralBuildings, StaysSmallBecauseItsNodesShareMeshes) {
  const Glb& glb = scene("building-200");
  EXPECT_LT(glb.bytes.size(), 12u << 20);
  EXPECT_GT(glb.root["nodes"].size(), 4 * glb.root["meshes"].size());
  EXPECT_LT(glb.triangles(), 4'000'000u);
}

TEST(ProceduralBuildings, NoRayPassesItsShell) {
  const Scene building = loaded_scene("building-20");
  const RayScene rays(building);
  for (const auto& [name, box] : scene("building-20").rooms()) {
    if (name == "Terrace" || name == "Stairwell") continue;
    const glm::vec3 lower(box[0], box[1], box[2]), upper(box[3], box[4], box[5]), middle = 0.5f * (lower + upper);
    for (int step = 0; step <= 400; ++step) {
      const float t = static_cast<float>(step) / 400.0f;
      for (const float x : {lower.x, upper.x}) {
        for (const float y : {lower.y, upper.y})
          EXPECT_TRUE(rays.closest(middle, glm::vec3(x, y, glm::mix(lower.z, upper.z, t)) - middle).hit)
              << name << ' ' << t;
        for (const float z : {lower.z, upper.z})
          EXPECT_TRUE(rays.closest(middle, glm::vec3(x, glm::mix(lower.y, upper.y, t), z) - middle).hit)
              << name << ' ' << t;
      }
    }
  }
}

TEST(ProceduralScenes, BoxRoomIsSmall) {
  EXPECT_LE(scene("box-room").triangles(), 100u);
}

TEST(ProceduralScenes, AnUnknownNameIsRefusedWithTheKnownOnes) {
  try {
    make_procedural_glb("palace");
    FAIL() << "not refused";
  } catch (const BadUsage& error) {
    EXPECT_NE(std::string(error.what()).find("palace"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("house"), std::string::npos);
  }
}

}  // namespace
}  // namespace probewalk
