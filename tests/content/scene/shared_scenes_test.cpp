// Real scenes that are not part of the repository: PROBEWALK_SCENES names their folder.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "content/scene/scene.h"

namespace probewalk {
namespace {

struct Expected {
  const char* file;
  std::size_t triangles;   // in the file; those without area are left out, panels added
  double tolerance;        // share of them
  double scale;
  glm::dvec3 size_m;
  bool own_light;
};

void PrintTo(const Expected& expected, std::ostream* out) { *out << expected.file; }

class SharedScenes : public testing::TestWithParam<Expected> {};

TEST_P(SharedScenes, LoadsWithPlausibleSizeAndUnit) {
  const char* folder = std::getenv("PROBEWALK_SCENES");
  if (!folder) GTEST_SKIP() << "PROBEWALK_SCENES is not set";
  const Expected& expected = GetParam();
  const std::filesystem::path file = std::filesystem::path(folder) / expected.file;
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  const Scene scene = load_scene(file);
  EXPECT_NEAR(static_cast<double>(scene.triangles.size()), static_cast<double>(expected.triangles),
              expected.tolerance * static_cast<double>(expected.triangles));
  EXPECT_DOUBLE_EQ(scene.scale, expected.scale) << scene.scale_statement;
  const glm::dvec3 size_m = scene.bounds.upper_m - scene.bounds.lower_m;
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(size_m[c], expected.size_m[c], 0.01 * expected.size_m[c]);
  EXPECT_EQ(scene.light_statement.starts_with("lit by the scene itself"), expected.own_light) << scene.light_statement;
  EXPECT_EQ(scene.content_hash.size(), 32u);
}

INSTANTIATE_TEST_SUITE_P(
    All, SharedScenes,
    testing::Values(Expected{"garage/garage.gltf", 11358, 0.01, 1.0, {6.78, 2.98, 7.55}, false},
                    Expected{"cube-room/cube-room.gltf", 5364, 0.01, 1.0, {10, 7, 10}, false},
                    Expected{"living-room/living-room.glb", 28656, 0.01, 1.0, {9.32, 7.16, 9.7}, true},
                    Expected{"hotel-room/scene.glb", 99029, 0.01, 0.001, {6.48, 2.2, 10.0}, false},
                    Expected{"zdm2/zdm2.glb", 58772, 0.03, 1.0, {77.2, 35.95, 59.6}, false},
                    Expected{"jungle/scene.gltf", 18515, 0.01, 0.05, {19.5, 15.8, 21.7}, false}),
    [](const auto& parameter) {
      std::string name = parameter.param.file;
      name.resize(name.find('/'));
      std::erase(name, '-');
      return name;
    });

}  // namespace
}  // namespace probewalk
