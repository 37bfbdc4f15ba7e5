// Bakes onto an earlier pack after the scene has changed: what is kept, what is baked, and that it is what a full bake
// makes.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "content/bake/plain_scenes.h"
#include "content/bake/rebake/bake_inputs.h"
#include "content/bake/rebake/map_inputs.h"
#include "content/bake/rebake/scene_cells.h"
#include "content/error.h"
#include "content/pack/pack_io.h"
#include "content/scene/ray_scene.h"
#include "support/low_discrepancy.h"
#include "support/test_bake.h"

namespace probewalk {
namespace {

namespace fs = std::filesystem;
using test::bake_quietly;
using test::files_below;

// Three furnished rooms in a row, 4 x 4 m each; what differs between bakes are the members.
struct ThreeRooms {
  glm::vec3 chair_m{1.0f, 0.0f, 1.0f};  // in the first room
  glm::vec3 chair_colour{0.6f, 0.2f, 0.2f};
  // Between the first and the second: a metre of nothing, or a wall of 0.2 m on one floor, which has a door or has
  // none.
  enum class Parted { kByNothing, kByAWall, kByADoor } parted = Parted::kByNothing;

  static constexpr float kApart_m = 5.0f;
  float start_m(int room) const {
    return room == 1 && parted != Parted::kByNothing ? 4.2f : kApart_m * static_cast<float>(room);
  }

  // Seen from inside.
  static void add_shell(Scene& s, glm::vec3 l, glm::vec3 h, std::uint32_t material) {
    using plain::add_quad;
    add_quad(s, {l.x, l.y, h.z}, {h.x, l.y, h.z}, {h.x, l.y, l.z}, {l.x, l.y, l.z}, material);
    add_quad(s, {h.x, h.y, l.z}, {h.x, h.y, h.z}, {l.x, h.y, h.z}, {l.x, h.y, l.z}, material);
    add_quad(s, {h.x, l.y, l.z}, {h.x, h.y, l.z}, {l.x, h.y, l.z}, {l.x, l.y, l.z}, material);
    add_quad(s, {l.x, h.y, h.z}, {h.x, h.y, h.z}, {h.x, l.y, h.z}, {l.x, l.y, h.z}, material);
    add_quad(s, {l.x, h.y, l.z}, {l.x, h.y, h.z}, {l.x, l.y, h.z}, {l.x, l.y, l.z}, material);
    add_quad(s, {h.x, l.y, h.z}, {h.x, h.y, h.z}, {h.x, h.y, l.z}, {h.x, l.y, l.z}, material);
  }

  Scene scene() const {
    using plain::add_box;
    Scene s;
    const std::uint32_t wall = plain::add_material(s, glm::vec3(0.8f)),
                        wood = plain::add_material(s, {0.5f, 0.35f, 0.2f});
    const std::uint32_t chair = plain::add_material(s, chair_colour);
    const bool one_floor = parted != Parted::kByNothing;
    for (int room = 0; room < 3; ++room) {
      if (one_floor && room == 1) continue;
      const float length = one_floor && room == 0 ? 8.2f : 4.0f;
      add_shell(s, {start_m(room), 0.0f, 0.0f}, {start_m(room) + length, 2.6f, 4.0f}, wall);
    }
    if (parted == Parted::kByAWall) add_box(s, {4.0f, 0.0f, 0.0f}, {4.2f, 2.6f, 4.0f}, wall);
    if (parted == Parted::kByADoor) {
      add_box(s, {4.0f, 0.0f, 0.0f}, {4.2f, 2.6f, 1.5f}, wall);
      add_box(s, {4.0f, 0.0f, 2.5f}, {4.2f, 2.6f, 4.0f}, wall);
      add_box(s, {4.0f, 2.1f, 1.5f}, {4.2f, 2.6f, 2.5f}, wall);
    }
    for (int room = 0; room < 3; ++room) {
      for (int k = 0; k < 5; ++k) {
        const glm::vec3 low(start_m(room) + 0.1f + 0.75f * static_cast<float>(k), 0.0f, 3.4f);
        add_box(s, low, low + glm::vec3(0.5f, 0.4f + 0.25f * static_cast<float>(k), 0.5f), wood);
      }
    }
    add_box(s, chair_m, chair_m + glm::vec3(0.45f, 0.5f, 0.45f), chair);
    add_box(s, chair_m + glm::vec3(0.0f, 0.5f, 0.0f), chair_m + glm::vec3(0.45f, 1.0f, 0.06f), chair);
    return s;
  }
};

// Materials as well, unlike the supporting write_gltf.
void write_scene(const fs::path& file, const Scene& scene) {
  using nlohmann::json;
  const fs::path binary = fs::path(file).replace_extension(".bin");
  std::ofstream out(binary, std::ios::binary);
  const auto write = [&](const auto& values) {
    out.write(reinterpret_cast<const char*>(values.data()),
              static_cast<std::streamsize>(values.size() * sizeof(values[0])));
    return values.size() * sizeof(values[0]);
  };
  std::size_t offset = write(scene.positions_m);
  json views = {{{"buffer", 0}, {"byteLength", offset}}}, accessors, primitives, materials;
  const auto corner = [](glm::dvec3 p) { return json{p.x, p.y, p.z}; };
  accessors.push_back({{"bufferView", 0},
                       {"componentType", 5126},
                       {"count", scene.positions_m.size()},
                       {"type", "VEC3"},
                       {"min", corner(scene.bounds.lower_m)},
                       {"max", corner(scene.bounds.upper_m)}});
  for (std::uint32_t m = 0; m < scene.materials.size(); ++m) {
    std::vector<glm::uvec3> triangles;
    for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
      if (scene.triangle_material[t] == m) triangles.push_back(scene.triangles[t]);
    }
    const std::size_t bytes = write(triangles);
    views.push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}});
    offset += bytes;
    accessors.push_back(
        {{"bufferView", m + 1}, {"componentType", 5125}, {"count", 3 * triangles.size()}, {"type", "SCALAR"}});
    primitives.push_back({{"attributes", {{"POSITION", 0}}}, {"indices", m + 1}, {"material", m}});
    const glm::vec4 colour = scene.materials[m].base_color_factor;
    materials.push_back({{"pbrMetallicRoughness", {{"baseColorFactor", {colour.r, colour.g, colour.b, 1.0}}}}});
  }
  const json document{{"asset", {{"version", "2.0"}}},
                      {"scene", 0},
                      {"scenes", {{{"nodes", {0}}}}},
                      {"nodes", {{{"mesh", 0}}}},
                      {"meshes", {{{"primitives", primitives}}}},
                      {"materials", materials},
                      {"bufferViews", views},
                      {"buffers", {{{"uri", binary.filename().string()}, {"byteLength", offset}}}},
                      {"accessors", accessors}};
  std::ofstream(file) << document.dump(1);
}

class StoppingProgress final : public Progress {
 public:
  void begin(std::string_view stage, std::uint64_t, std::string_view) override { counting_ = stage == "probes"; }
  void advance(std::uint64_t) override { stop_ = stop_ || counting_; }
  void note(std::string_view) override {}
  bool cancelled() const override { return stop_; }

 private:
  std::atomic<bool> counting_ = false, stop_ = false;
};

class Rebake : public testing::Test {
 protected:
  void SetUp() override {
    const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(PROBEWALK_TEST_OUTPUT_DIR) / "rebake" / test->name();
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }

  void write(const ThreeRooms& rooms) const {
    write_scene(folder_ / "scene.gltf", rooms.scene());
    nlohmann::json list;
    for (int k = 0; k < 3; ++k) {
      list.push_back({{"id", std::string(1, char('a' + k))},
                      {"min", {rooms.start_m(k), 0.0, 0.0}},
                      {"max", {rooms.start_m(k) + 4.0, 2.6, 4.0}}});
    }
    std::ofstream(folder_ / "rooms.json") << nlohmann::json{{"rooms", list}}.dump();
  }

  BakeOptions options(const std::string& pack) const {
    BakeOptions o;
    o.scene_file = folder_ / "scene.gltf";
    o.pack = folder_ / (pack + ".probes");
    o.load.scale = 1.0;
    o.resolution = 32;
    o.coarse_resolution = 8;
    o.placement.spacing_m = 3.0;
    o.light.samples = 8;
    o.light.bounces = 2;
    o.light.cache_spacing_m = 0.4;
    o.light_tolerance = 0.0;
    return o;
  }

  // The same scene from nothing, on the lines of the earlier pack's grid and with its scale of brightness.
  BakeReport bake_from_nothing(const std::string& pack, const Manifest& earlier) const {
    BakeOptions o = options(pack);
    o.placement.kept_grid = earlier.grid;
    o.kept_radiance_scale = earlier.radiance_scale;
    return bake_quietly(o);
  }

  Manifest manifest_of(const std::string& pack) const { return Pack::open(folder_ / (pack + ".probes")).manifest(); }

  static int kept(const BakeReport& report) {
    return int(std::count_if(report.kept.begin(), report.kept.end(),
                             [](const RoomKept& r) { return r.geometry && r.radiance; }));
  }
  static std::string told(const BakeReport& report) {
    std::string text;
    for (const RoomKept& room : report.kept) {
      text += room.room + (room.geometry ? " geometry" : "") + (room.radiance ? " radiance" : "") + ": " + room.reason +
              "\n";
    }
    return text;
  }

  fs::path folder_;
};

TEST_F(Rebake, KeepsEverythingOfAnUnchangedScene) {
  write({});
  const BakeReport first = bake_quietly(options("a"));
  EXPECT_TRUE(first.kept.empty());
  EXPECT_GT(first.maps, 0u);
  EXPECT_EQ(first.kept_maps, 0u);
  const auto before = files_below(folder_ / "a.probes");
  const BakeReport again = bake_quietly(options("a"));
  EXPECT_EQ(again.kept_maps, again.maps) << told(again);
  EXPECT_EQ(again.texels, 0u);
  EXPECT_EQ(files_below(folder_ / "a.probes"), before);
  EXPECT_EQ(again.connected_fraction, first.connected_fraction);
}

// To the bit: a room behind closed walls has nothing to do with a chair, its shadow or its light.
TEST_F(Rebake, OfAChairBehindClosedWallsGivesTheBytesOfAFullBake) {
  write({});
  const BakeReport first = bake_quietly(options("a"));
  const Manifest before = Pack::open(folder_ / "a.probes").manifest();
  ASSERT_EQ(before.rooms.size(), 3u);
  write({.chair_m = {2.2f, 0.0f, 0.7f}});
  const BakeReport changed = bake_quietly(options("a"));
  const BakeReport full = bake_from_nothing("full", before);
  EXPECT_EQ(files_below(folder_ / "a.probes"), files_below(folder_ / "full.probes")) << told(changed);
  EXPECT_EQ(kept(changed), 2) << told(changed);
  EXPECT_LT(changed.texels, full.texels / 2);
  EXPECT_EQ(changed.maps, full.maps);
  EXPECT_EQ(changed.kept_maps, 4 * (before.probe_positions_m.size() - before.rooms[0].probe_count));
  std::printf("  %zu of %zu maps baked, %.2f s instead of %.2f s (%.0f %%), %llu rays instead of %llu\n",
              changed.maps - changed.kept_maps, full.maps, changed.seconds, full.seconds,
              100.0 * changed.seconds / full.seconds, static_cast<unsigned long long>(changed.rays),
              static_cast<unsigned long long>(full.rays));
  // And back: the bytes of the first bake.
  write({});
  bake_quietly(options("a"));
  EXPECT_EQ(Pack::open(folder_ / "a.probes").manifest().rooms[0].levels[1].chunk, before.rooms[0].levels[1].chunk);
  EXPECT_EQ(first.texels, full.texels);
}

TEST_F(Rebake, OfAnotherColourKeepsAllShapes) {
  write({});
  bake_quietly(options("a"));
  const Manifest before = manifest_of("a");
  write({.chair_colour = {0.1f, 0.7f, 0.1f}});
  const BakeReport changed = bake_quietly(options("a"));
  bake_from_nothing("full", before);
  EXPECT_EQ(files_below(folder_ / "a.probes"), files_below(folder_ / "full.probes"));
  EXPECT_EQ(kept(changed), 2) << told(changed);
  for (const RoomKept& room : changed.kept) EXPECT_TRUE(room.geometry) << told(changed);
}

// Through a door light changes everywhere a little: with no tolerance the next room is lit anew, and all is as a full
// bake makes it; the closed one stays.
TEST_F(Rebake, BehindADoorIsExactWithoutTolerance) {
  write({.parted = ThreeRooms::Parted::kByADoor});
  bake_quietly(options("a"));
  const Manifest before = manifest_of("a");
  write({.chair_m = {0.6f, 0.0f, 0.4f}, .parted = ThreeRooms::Parted::kByADoor});
  const BakeReport changed = bake_quietly(options("a"));
  bake_from_nothing("full", before);
  EXPECT_EQ(files_below(folder_ / "a.probes"), files_below(folder_ / "full.probes")) << told(changed);
  EXPECT_EQ(kept(changed), 1) << told(changed);
}

// What is let be is off by no more than was promised: behind a wall so thin that points on both sides reach through it
// a little, and behind a door.
TEST_F(Rebake, WithToleranceIsOffByNoMoreThanItSays) {
  using enum ThreeRooms::Parted;
  for (const ThreeRooms::Parted parted : {kByAWall, kByADoor}) {
    const std::string pack = parted == kByADoor ? "door" : "wall";
    write({.parted = parted});
    bake_quietly(options(pack));
    const Manifest before = manifest_of(pack);
    write({.chair_colour = {0.55f, 0.22f, 0.2f}, .parted = parted});
    BakeOptions o = options(pack);
    o.light_tolerance = 0.02;
    const BakeReport changed = bake_quietly(o);
    bake_from_nothing(pack + "-full", before);
    const Pack is = Pack::open(o.pack), should = Pack::open(folder_ / (pack + "-full.probes"));
    double worst = 0.0;
    for (std::size_t k = 0; k < changed.kept.size(); ++k) {
      EXPECT_LE(changed.kept[k].light_off, o.light_tolerance);
      const RoomLevel a = is.read_level(k, 1), b = should.read_level(k, 1);
      for (std::size_t p = 0; p < a.probes.size(); ++p) {
        for (std::size_t t = 0; t < a.probes[p].radiance.rgb9e5.size(); ++t) {
          const glm::vec3 x = decode_rgb9e5(a.probes[p].radiance.rgb9e5[t]),
                          y = decode_rgb9e5(b.probes[p].radiance.rgb9e5[t]);
          const float most = std::max(y.r, std::max(y.g, y.b));
          for (int c = 0; c < 3; ++c) worst = std::max(worst, double(std::abs(x[c] - y[c]) / std::max(most, 1e-3f)));
        }
      }
    }
    EXPECT_GE(kept(changed), 1) << told(changed);
    constexpr double kStored = 1.0 / 256.0;  // a step of the shared exponent's mantissa
    EXPECT_LE(worst, o.light_tolerance + kStored) << told(changed);
    std::printf("  %s: off by %.4f at most, %d of 3 rooms kept\n", pack.c_str(), worst, kept(changed));
  }
}

TEST_F(Rebake, IsAFullBakeWhereNothingIsKnownOfTheEarlierOne) {
  write({});
  bake_quietly(options("a"));
  BakeOptions other = options("a");
  other.light.seed = 2;
  EXPECT_EQ(bake_quietly(other).kept_maps, 0u);
  BakeOptions all = other;
  all.all = true;
  EXPECT_EQ(bake_quietly(all).kept_maps, 0u);
  fs::resize_file(folder_ / "a.inputs", 1000);
  EXPECT_EQ(bake_quietly(other).kept_maps, 0u);
  // A damaged chunk is no one's to keep.
  const Manifest manifest = Pack::open(other.pack).manifest();
  std::ofstream(other.pack / "chunks" / manifest.rooms[1].levels[0].chunk, std::ios::binary | std::ios::in)
      .write("damage", 6);
  const BakeReport repaired = bake_quietly(other);
  EXPECT_EQ(kept(repaired), 2) << told(repaired);
  SilentProgress progress;
  EXPECT_TRUE(Pack::open(other.pack).verify(progress).empty());
}

TEST_F(Rebake, GoesOnAfterAnInterruption) {
  write({});
  bake_quietly(options("a"));
  bake_quietly(options("b"));
  write({.chair_m = {2.2f, 0.0f, 0.7f}});
  bake_quietly(options("a"));
  StoppingProgress stopping;
  EXPECT_THROW(bake(options("b"), stopping), Interrupted);
  const BakeReport finished = bake_quietly(options("b"));
  EXPECT_EQ(kept(finished), 2) << told(finished);
  EXPECT_EQ(files_below(folder_ / "a.probes"), files_below(folder_ / "b.probes"));
}

// A ray's answer depends on the cells that it passes and on no others.
TEST(SpaceCells, HoldEveryHitOfARayThatPassesThem) {
  const Scene scene = ThreeRooms{}.scene();
  const RayScene rays(scene);
  const SpaceCells cells = SpaceCells::around(scene.bounds);
  const SceneCells hashes = hash_scene(scene, cells);
  test::Random random(1);
  for (int k = 0; k < 2000; ++k) {
    const glm::vec3 origin(random(0.1, 3.9), random(0.1, 2.5), random(0.1, 3.3));
    const glm::vec3 direction(random.direction() * random(0.5, 2.0));
    InputRecorder recorder(cells, rays, nullptr);
    const SurfaceHit hit = rays.closest(origin, direction);
    rays.occluded(origin, direction, 0.0f, 100.0f);
    const MapInputs inputs = recorder.take();
    ASSERT_TRUE(hit.hit);
    const std::size_t at = cells.index(cells.cell_of(glm::dvec3(origin) + double(hit.t) * glm::dvec3(direction)));
    EXPECT_TRUE(inputs.passed.contains(at));
    EXPECT_NE(hashes.shape[at], 0u);
    for (int step = 0; step < 50; ++step) {
      const glm::dvec3 on_way = glm::dvec3(origin) + double(hit.t) * step / 50.0 * glm::dvec3(direction);
      EXPECT_TRUE(inputs.passed.contains(cells.index(cells.cell_of(on_way))));
    }
    EXPECT_FALSE(inputs.passed.contains(cells.outside()));
  }
}

}  // namespace
}  // namespace probewalk
