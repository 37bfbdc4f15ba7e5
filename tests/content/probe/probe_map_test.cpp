// The octahedral map and the codes of its samples, as properties over low-discrepancy sets.
#include "content/probe/probe_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/low_discrepancy.h"

namespace probewalk {
namespace {

constexpr int kPoints = 65535;

TEST(OctahedralMap, RoundTripsHammersleyDirections) {
  for (int k = 0; k < kPoints; ++k) {
    const glm::dvec3 d = test::hammersley_direction(k, kPoints);
    const glm::dvec2 uv = octahedral_coordinates(d);
    ASSERT_LE(std::abs(uv.x), 1.0);
    ASSERT_LE(std::abs(uv.y), 1.0);
    const glm::dvec3 back = octahedral_point(uv.x, uv.y);
    EXPECT_NEAR(std::abs(back.x) + std::abs(back.y) + std::abs(back.z), 1.0, 1e-15);
    EXPECT_LT(glm::length(glm::normalize(back) - d), 1e-14) << k;
  }
}

TEST(OctahedralMap, PutsOctantsWhereTheFoldSaysTheyAre) {
  for (int k = 0; k < kPoints; ++k) {
    const glm::dvec3 d = test::hammersley_direction(k, kPoints);
    const glm::dvec2 uv = octahedral_coordinates(d);
    if (std::abs(d.z) > 1e-12) {
      EXPECT_EQ(d.z > 0, std::abs(uv.x) + std::abs(uv.y) < 1.0) << k;
    }
    if (std::abs(d.x) > 1e-12) {
      EXPECT_EQ(d.x > 0, uv.x > 0) << k;
    }
    if (std::abs(d.y) > 1e-12) {
      EXPECT_EQ(d.y > 0, uv.y > 0) << k;
    }
  }
}

TEST(OctahedralMap, KnowsAxesCornersAndTheFold) {
  EXPECT_EQ(octahedral_point(0, 0), glm::dvec3(0, 0, 1));
  EXPECT_EQ(octahedral_point(1, 0), glm::dvec3(1, 0, 0));
  EXPECT_EQ(octahedral_point(0, -1), glm::dvec3(0, -1, 0));
  for (double u : {-1.0, 1.0}) {
    for (double v : {-1.0, 1.0}) EXPECT_EQ(glm::abs(octahedral_point(u, v)), glm::dvec3(0, 0, 1)) << u << " " << v;
  }
  for (int k = 0; k <= 64; ++k) {
    const double u = k / 64.0;
    EXPECT_EQ(octahedral_point(u, 1.0 - u).z, 0.0);
  }
}

TEST(OctahedralMap, BorderVerticesAreTheirMirrorCopies) {
  constexpr int n = 512;
  for (int j = 0; j <= n; ++j) {
    const double v = 2.0 * j / n - 1.0;
    for (double u : {-1.0, 1.0}) {
      EXPECT_EQ(octahedral_point(u, v), octahedral_point(u, -v));
      EXPECT_EQ(octahedral_point(v, u), octahedral_point(-v, u));
    }
  }
}

TEST(SharedExponent, KeepsRelativePrecisionOfTheLargestChannel) {
  for (int k = 0; k < 4096; ++k) {
    const double scale = std::exp2(-14.0 + 29.0 * k / 4096);
    const glm::vec3 rgb(static_cast<float>(scale), static_cast<float>(0.4 * scale), static_cast<float>(0.01 * scale));
    const glm::vec3 back = decode_rgb9e5(encode_rgb9e5(rgb));
    EXPECT_LE(glm::length(back - rgb), 2.0f / 512.0f * rgb.x) << rgb.x;
  }
}

TEST(SharedExponent, ClampsWhatItCannotHold) {
  const float nan = std::nanf("");
  EXPECT_EQ(encode_rgb9e5({0, 0, 0}), 0u);
  EXPECT_EQ(encode_rgb9e5({-1, nan, -0.0f}), 0u);
  EXPECT_EQ(decode_rgb9e5(encode_rgb9e5({1e9f, 65408.0f, 0})), glm::vec3(65408, 65408, 0));
  EXPECT_EQ(decode_rgb9e5(encode_rgb9e5({1, 0.5f, 2})), glm::vec3(1, 0.5f, 2));
}

TEST(TexelW, IsMonotoneAndPreciseToItsStep) {
  std::uint16_t last = 0;
  for (int k = 0; k < 10000; ++k) {
    const float w = static_cast<float>(std::exp2(-19.9 + 39.8 * k / 10000));
    const std::uint16_t code = encode_texel_w(w);
    EXPECT_GE(code, last);
    EXPECT_NEAR(decode_texel_w(code) / w, 1.0, 2.2e-4);
    last = code;
  }
  EXPECT_EQ(encode_texel_w(0.0f), 0);
  EXPECT_EQ(decode_texel_w(0), 0.0f);
  EXPECT_GT(encode_texel_w(1e-30f), 0) << "a far surface must not turn into sky";
}

TEST(NormalCode, RoundTripsWithinADegree) {
  for (int k = 0; k < kPoints; ++k) {
    const glm::vec3 normal(test::hammersley_direction(k, kPoints));
    const std::uint16_t code = encode_normal(normal);
    EXPECT_NE(code, 0) << "0 means: not needed";
    EXPECT_LT(glm::length(decode_normal(code) - normal), 0.0175f);
  }
}

TEST(MipChain, CountsDownToOneTexel) {
  EXPECT_EQ(mip_chain_texels(8), 64u + 16 + 4 + 1);
  EXPECT_EQ(mip_chain_texels(1), 1u);
}

}  // namespace
}  // namespace probewalk
