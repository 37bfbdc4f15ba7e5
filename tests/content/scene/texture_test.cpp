#include "content/scene/texture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace probewalk {
namespace {

Texture gray(int width, int height, const std::vector<int>& values, bool srgb = false) {
  Texture texture;
  texture.srgb = srgb;
  Texture::Level level{width, height, {}};
  for (const int value : values) {
    for (int c = 0; c < 3; ++c) level.rgba.push_back(static_cast<std::uint8_t>(value));
    level.rgba.push_back(255);
  }
  texture.levels.push_back(level);
  return texture;
}

TEST(Texture, ReadsTexelsAtTheirCentresAndBlendsBetween) {
  const Texture texture = gray(2, 1, {0, 255});
  EXPECT_NEAR(texture.sample({0.25f, 0.5f}, 0).r, 0.0f, 1e-6f);
  EXPECT_NEAR(texture.sample({0.75f, 0.5f}, 0).r, 1.0f, 1e-6f);
  EXPECT_NEAR(texture.sample({0.5f, 0.5f}, 0).r, 0.5f, 1e-6f);
}

TEST(Texture, DecodesColourButNeverAlpha) {
  Texture texture = gray(1, 1, {188}, true);
  texture.levels[0].rgba[3] = 188;
  const glm::vec4 value = texture.sample({0.5f, 0.5f}, 0);
  EXPECT_NEAR(value.r, 0.5029f, 1e-3f);
  EXPECT_NEAR(value.a, 188.0f / 255.0f, 1e-6f);
}

TEST(Texture, WrapsAsItsModesSay) {
  Texture texture = gray(4, 1, {0, 85, 170, 255});
  const auto at = [&](float u) { return texture.sample({u, 0.5f}, 0).r; };
  texture.wrap_u = WrapMode::kRepeat;
  EXPECT_NEAR(at(1.125f), 0.0f, 1e-5f);
  EXPECT_NEAR(at(-0.125f), 1.0f, 1e-5f);
  EXPECT_NEAR(at(0.0f), 0.5f, 1e-5f) << "the seam blends the last texel with the first";
  texture.wrap_u = WrapMode::kMirroredRepeat;
  EXPECT_NEAR(at(1.125f), 1.0f, 1e-5f);
  EXPECT_NEAR(at(-0.125f), 0.0f, 1e-5f);
  EXPECT_NEAR(at(1.0f), 1.0f, 1e-5f);
  texture.wrap_u = WrapMode::kClampToEdge;
  EXPECT_NEAR(at(1.7f), 1.0f, 1e-5f);
  EXPECT_NEAR(at(-3.0f), 0.0f, 1e-5f);
}

TEST(Texture, SurvivesAnyCoordinate) {
  Texture texture = gray(3, 2, {0, 50, 100, 150, 200, 250});
  build_mip_chain(texture, false);
  const float infinity = std::numeric_limits<float>::infinity();
  for (const float u : {std::numeric_limits<float>::quiet_NaN(), infinity, -infinity, 1e30f, -1e30f, -1e-30f}) {
    for (const WrapMode mode : {WrapMode::kRepeat, WrapMode::kMirroredRepeat, WrapMode::kClampToEdge}) {
      texture.wrap_u = texture.wrap_v = mode;
      for (const float lod : {0.0f, u}) {
        const float value = texture.sample({u, u}, lod).r;
        EXPECT_GE(value, 0.0f);
        EXPECT_LE(value, 1.0f);
      }
    }
  }
}

TEST(Texture, MipsKeepTheMeanInLinearLight) {
  Texture texture = gray(2, 2, {0, 255, 255, 0}, true);
  build_mip_chain(texture, false);
  ASSERT_EQ(texture.levels.size(), 2u);
  EXPECT_NEAR(texture.sample({0.5f, 0.5f}, 1).r, 0.5f, 0.005f);
  EXPECT_NEAR(texture.sample({0.25f, 0.25f}, 0.5f).r, 0.25f, 0.005f) << "halfway between black and the mean";
}

TEST(Texture, OddSizesWeighEveryTexelAlike) {
  Texture texture = gray(5, 3, {0, 0, 0, 0, 0, 0, 0, 255, 0, 0, 0, 0, 0, 0, 0});
  build_mip_chain(texture, false);
  ASSERT_EQ(texture.levels.size(), 3u);
  EXPECT_EQ(texture.levels[1].width_px, 2);
  EXPECT_EQ(texture.levels[1].height_px, 1);
  EXPECT_EQ(texture.levels[2].width_px, 1);
  EXPECT_NEAR(texture.sample({0.5f, 0.5f}, 9).r, 1.0f / 15.0f, 0.004f);
}

TEST(Texture, TexelsThatDoNotExistDoNotTintTheirNeighbours) {
  Texture texture = gray(2, 1, {255, 0});
  texture.levels[0].rgba[7] = 0;
  Texture plain = texture;
  build_mip_chain(texture, true);
  build_mip_chain(plain, false);
  EXPECT_NEAR(texture.sample({0.5f, 0.5f}, 1).r, 1.0f, 1e-6f);
  EXPECT_NEAR(plain.sample({0.5f, 0.5f}, 1).r, 0.5f, 0.005f);
  EXPECT_NEAR(texture.sample({0.5f, 0.5f}, 1).a, 0.5f, 0.005f);
}

TEST(Sky, GradesFromHorizonToZenithAndToTheGround) {
  const Sky sky{{0, 0, 10}, {5, 5, 5}, {1, 0, 0}};
  EXPECT_EQ(sky.radiance({0, 1, 0}), glm::vec3(0, 0, 10));
  EXPECT_EQ(sky.radiance({1, 0, 0}), glm::vec3(5, 5, 5));
  EXPECT_EQ(sky.radiance({0, -1, 0}), glm::vec3(1, 0, 0));
  const glm::vec3 middle = sky.radiance({0.8f, 0.6f, 0.0f});
  EXPECT_GT(middle.b, 5.0f);
  EXPECT_LT(middle.b, 10.0f);
  EXPECT_FALSE(sky.is_black());
  EXPECT_TRUE(Sky{}.is_black());
}

TEST(Sky, HasNoCreaseAtTheHorizon) {
  const Sky sky{{0, 0, 0}, {100, 100, 100}, {0, 0, 0}};
  const float step = 1e-4f;
  for (const float height : {-step, step}) {
    EXPECT_NEAR(sky.radiance({1, height, 0}).r, 100.0f, 0.01f);
  }
}

}  // namespace
}  // namespace probewalk
