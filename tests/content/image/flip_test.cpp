// FLIP and PSNR on pictures whose answer is known or must hold by reasoning.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "content/error.h"
#include "content/image/image.h"

namespace probewalk {
namespace {

constexpr float kPixelsPerDegree = 67.0f;  // a 0.7 m wide 3840 px screen seen from 0.7 m, as in the paper

using Color = glm::ivec3;

ImageRgb8 picture(int width, int height, const std::function<Color(int, int)>& color) {
  ImageRgb8 image{width, height, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Color c = color(x, y);
      for (int i = 0; i < 3; ++i) image.rgb.push_back(static_cast<std::uint8_t>(c[i]));
    }
  }
  return image;
}

ImageRgb8 plain(Color color) {
  return picture(32, 32, [&](int, int) { return color; });
}

float flip(const ImageRgb8& reference, const ImageRgb8& test) { return flip_mean(reference, test, kPixelsPerDegree); }

const Color kBlack(0), kWhite(255), kRed(255, 0, 0), kGreen(0, 255, 0), kBlue(0, 0, 255);

ImageRgb8 checkers(int size_px, int shift_px) {
  return picture(64, 64, [&](int x, int y) { return ((x + shift_px) / size_px + y / size_px) % 2 ? kWhite : kBlack; });
}

TEST(Flip, IdenticalPicturesDoNotDiffer) {
  std::vector<float> map;
  EXPECT_EQ(flip_mean(checkers(7, 0), checkers(7, 0), kPixelsPerDegree, &map), 0.0f);
  ASSERT_EQ(map.size(), 64u * 64u);
  EXPECT_EQ(*std::max_element(map.begin(), map.end()), 0.0f);
}

// By the paper's formulas: plain pictures pass both filters unchanged and have no features, so the error is that of the
// colours. Black and white differ by 100 (lightness alone), green and blue by 203.3; both to the 0.7th, 25.12 and
// 41.28, and the knee at 0.4 of the latter: 0.95 + 0.05 (25.12 - 16.51) / (41.28 - 16.51).
TEST(Flip, GivesTheKnownErrorOfWhiteForBlack) { EXPECT_NEAR(flip(plain(kBlack), plain(kWhite)), 0.96738f, 1e-4f); }

TEST(Flip, GreenAndBlueAreAsFarApartAsCanBe) { EXPECT_NEAR(flip(plain(kGreen), plain(kBlue)), 1.0f, 1e-4f); }

TEST(Flip, IsSymmetric) {
  const ImageRgb8 a = checkers(5, 0);
  const ImageRgb8 b = picture(64, 64, [](int x, int y) { return Color(4 * x, 4 * y, 128); });
  EXPECT_FLOAT_EQ(flip(a, b), flip(b, a));
}

TEST(Flip, GrowsWithTheDifference) {
  float previous = 0.0f;
  for (const int step : {1, 3, 10, 30, 100}) {
    const float error = flip(plain(Color(100)), plain(Color(100 + step)));
    EXPECT_GT(error, previous) << step;
    previous = error;
  }
  EXPECT_LT(flip(plain(Color(100)), plain(Color(101))), 0.1f);
}

TEST(Flip, ASmallShiftDiffersLessThanALargeOne) {
  const float small = flip(checkers(16, 0), checkers(16, 1));
  const float large = flip(checkers(16, 0), checkers(16, 8));
  EXPECT_GT(small, 0.0f);
  EXPECT_LT(small, 0.5f * large);
}

TEST(Flip, DetailTooFineToSeeMattersLess) {
  const ImageRgb8 gray = picture(64, 64, [](int, int) { return Color(188); });
  EXPECT_LT(flip_mean(gray, checkers(1, 0), 134.0f), flip_mean(gray, checkers(8, 0), 134.0f));
  EXPECT_LT(flip_mean(gray, checkers(2, 0), 134.0f), flip_mean(gray, checkers(2, 0), 30.0f))
      << "farther away is harder to see";
}

TEST(Flip, MarksThePlaceOfADifference) {
  ImageRgb8 test = plain(Color(128));
  const std::size_t spot = (16 * 32 + 20) * 3;
  test.rgb[spot] = test.rgb[spot + 1] = test.rgb[spot + 2] = 255;
  std::vector<float> map;
  flip_mean(plain(Color(128)), test, kPixelsPerDegree, &map);
  EXPECT_EQ(std::max_element(map.begin(), map.end()) - map.begin(), 16 * 32 + 20);
  EXPECT_LT(map[0], 1e-3f);
}

TEST(Flip, StaysInItsRange) {
  std::vector<float> map;
  for (const ImageRgb8& test : {plain(kRed), plain(kBlue), plain(kWhite), picture(32, 32, [](int x, int y) {
                                  return (x * 7 + y * 13) % 5 ? kBlue : kGreen;
                                })}) {
    flip_mean(plain(kGreen), test, kPixelsPerDegree, &map);
    for (const float error : map) {
      EXPECT_GE(error, 0.0f);
      EXPECT_LE(error, 1.0f);
    }
  }
}

TEST(Flip, RefusesPicturesOfDifferentSize) {
  const ImageRgb8 wide = picture(8, 4, [](int, int) { return kRed; });
  const ImageRgb8 high = picture(4, 8, [](int, int) { return kRed; });
  EXPECT_THROW(flip(wide, high), BadInput);
  EXPECT_THROW(psnr_db(wide, high), BadInput);
}

TEST(Psnr, IsThatOfTheMeanSquaredDifference) {
  EXPECT_TRUE(std::isinf(psnr_db(plain(kRed), plain(kRed))));
  EXPECT_NEAR(psnr_db(plain(kBlack), plain(kWhite)), 0.0, 1e-12);
  EXPECT_NEAR(psnr_db(plain(Color(100)), plain(Color(110))), 20.0 * std::log10(25.5), 1e-9);
}

}  // namespace
}  // namespace probewalk
