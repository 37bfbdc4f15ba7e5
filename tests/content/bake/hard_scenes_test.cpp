// Scenes that a bake may stumble over: each ends in a good pack or in a clear statement.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "content/bake/bake_job.h"
#include "content/bake/plan/plan_report.h"
#include "content/pack/file_io.h"
#include "content/pack/pack_io.h"
#include "content/scene/gltf_scene.h"
#include "content/scene/procedural/procedural.h"

namespace probewalk {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class NotingProgress final : public Progress {
 public:
  void begin(std::string_view, std::uint64_t, std::string_view) override {}
  void advance(std::uint64_t) override {}
  void note(std::string_view line) override { notes += std::string(line) + "\n"; }
  std::string notes;
};

struct Baked {
  BakeReport report;
  std::string notes;
  std::string refusal;  // empty when there is a pack
  bool is_sound = false;
};

Baked bake_scene(const fs::path& file, double error) {
  BakeOptions options;
  options.scene_file = file;
  options.load.scale = 1.0;
  options.pack = GltfScene::folder() / "pack.probes";
  options.target.error = error;
  options.target.effort = 0.2;
  options.target.most_geometry = options.target.most_radiance = 128;
  options.target.most_probes = 12;
  options.resolution = 64;
  options.coarse_resolution = 16;
  options.placement.max_probes = 8;
  options.light.samples = 8;
  options.light.bounces = 1;
  options.light.cache_spacing_m = 1.0;
  Baked baked;
  NotingProgress progress;
  try {
    baked.report = bake(options, progress);
    SilentProgress silent;
    baked.is_sound = Pack::open(options.pack).verify(silent).empty();
  } catch (const Error& refusal) {
    baked.refusal = refusal.what();
  }
  baked.notes = progress.notes;
  return baked;
}

void expect_pack_or_statement(const Baked& baked) {
  ASSERT_EQ(baked.refusal, "");
  EXPECT_TRUE(baked.is_sound);
  EXPECT_GE(baked.report.probes, 1u);
  if (!baked.report.planned) return;
  const RoomError& error = baked.report.planned->held_back;
  EXPECT_TRUE(std::isfinite(error.flip) && std::isfinite(error.lost()));
  if (!baked.report.planned->kept) {
    EXPECT_THAT(baked.notes, HasSubstr("is not kept"));
  }
}

GltfScene triangles(const std::vector<float>& corners) {
  GltfScene scene;
  scene.add_mesh({{"attributes", {{"POSITION", scene.add_floats(corners, "VEC3")}}}});
  return scene;
}

// As positions: two triangles each, facing up or inwards does not matter to probes.
void add_quad(std::vector<float>& to, glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) {
  for (const glm::vec3& p : {a, b, c, a, c, d}) to.insert(to.end(), {p.x, p.y, p.z});
}

std::vector<float> floor_corners() {
  std::vector<float> corners;
  add_quad(corners, {0, 0, 0}, {0, 0, 4}, {4, 0, 4}, {4, 0, 0});
  return corners;
}

TEST(HardScenes, AnEmptyOneIsRefusedWithItsReason) {
  GltfScene scene;
  scene.json["nodes"] = Json::array({Json::object()});
  for (const double error : {0.0, 0.2}) {
    const Baked baked = bake_scene(scene.write(), error);
    EXPECT_THAT(baked.refusal, HasSubstr("small.gltf"));
    EXPECT_THAT(baked.refusal, HasSubstr("triangle"));
    EXPECT_FALSE(fs::exists(GltfScene::folder() / "pack.probes" / "pack.json"));
  }
}

TEST(HardScenes, OneTriangle) {
  for (const double error : {0.0, 0.2}) {
    expect_pack_or_statement(bake_scene(triangles({0, 0, 0, 0, 0, 5, 5, 0, 0}).write(), error));
  }
}

TEST(HardScenes, OneTriangleThatNobodyCanStandOn) {
  for (const double error : {0.0, 0.2}) {
    expect_pack_or_statement(bake_scene(triangles({0, 0, 0, 0, 3, 0, 2, 0, 0}).write(), error));
  }
}

TEST(HardScenes, TrianglesWithoutAreaOrNumbers) {
  std::vector<float> corners = floor_corners();
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  for (int k = 0; k < 3; ++k) corners.insert(corners.end(), {1.0f, 1.0f, 1.0f});  // a point
  corners.insert(corners.end(), {1, 1, 1, 2, 1, 1, 3, 1, 1});                     // a line
  corners.insert(corners.end(), {nan, 1, 1, 2, 1, 1, 3, 2, 1});
  corners.insert(corners.end(), {infinity, 1, 1, 2, 1, 1, 3, 2, 1});
  const Baked baked = bake_scene(triangles(corners).write(), 0.2);
  expect_pack_or_statement(baked);
  EXPECT_THAT(baked.notes, HasSubstr("left out"));
}

TEST(HardScenes, ARoomOpenToNothing) {
  std::vector<float> corners = floor_corners();
  add_quad(corners, {0, 0, 0}, {0, 2.6f, 0}, {4, 2.6f, 0}, {4, 0, 0});
  add_quad(corners, {0, 0, 0}, {0, 2.6f, 0}, {0, 2.6f, 4}, {0, 0, 4});
  for (const double error : {0.0, 0.2}) expect_pack_or_statement(bake_scene(triangles(corners).write(), error));
}

TEST(HardScenes, AMirrorHall) {
  std::vector<float> corners = floor_corners();
  for (const float y : {0.0f, 2.6f}) add_quad(corners, {0, y, 0}, {0, y, 4}, {4, y, 4}, {4, y, 0});
  for (const float x : {0.0f, 1.3f, 2.7f, 4.0f})
    add_quad(corners, {x, 0, 0.7f}, {x, 2.6f, 0.7f}, {x, 2.6f, 4}, {x, 0, 4});
  GltfScene scene = triangles(corners);
  scene.set_material({{"pbrMetallicRoughness", {{"metallicFactor", 1.0}, {"roughnessFactor", 0.0}}}});
  expect_pack_or_statement(bake_scene(scene.write(), 0.2));
}

// Those of the thesis and of the house: walls within cells, probes in boxes, bars, many arms.
class HardProceduralScenes : public testing::TestWithParam<const char*> {};

TEST_P(HardProceduralScenes, EndInAGoodPackOrAStatement) {
  const fs::path file = GltfScene::folder() / "scene.glb";
  write_file_whole(file, make_procedural_glb(GetParam()));
  const Baked baked = bake_scene(file, 0.2);
  expect_pack_or_statement(baked);
  for (const PlannedRoom& room : baked.report.planned->rooms) {
    if (room.held_back.measured && room.held_back.worst() > 0.2) {
      EXPECT_FALSE(room.statement.empty()) << room.id;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, HardProceduralScenes,
                         testing::Values("boxed-lattice", "corridor", "star-room", "lattice", "closed-cells",
                                         "triangles-1e5", "meadow-1e5"),
                         [](const auto& scene) {
                           std::string name = scene.param;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace probewalk
