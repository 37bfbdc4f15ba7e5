#include "content/image/image.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

#include "content/error.h"

namespace probewalk {
namespace {

std::filesystem::path fresh_folder(const std::string& name) {
  const std::filesystem::path folder = std::filesystem::path(PROBEWALK_TEST_OUTPUT_DIR) / ("image-" + name);
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

std::size_t files_in(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(
      std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator()));
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

ImageRgb8 gradient(int width, int height) {
  ImageRgb8 image{width, height, {}};
  for (int i = 0; i < 3 * width * height; ++i) image.rgb.push_back(static_cast<std::uint8_t>(i * 37));
  return image;
}

TEST(Png, ComesBackAsItWas) {
  const auto folder = fresh_folder("png");
  const ImageRgb8 image = gradient(17, 5);
  write_png(folder / "a.png", image);
  const ImageRgb8 back = read_png(folder / "a.png");
  EXPECT_EQ(back.width_px, 17);
  EXPECT_EQ(back.height_px, 5);
  EXPECT_EQ(back.rgb, image.rgb);
  EXPECT_EQ(files_in(folder), 1u) << "no temporary file stays";
}

TEST(Png, RefusesWhatCannotBeWrittenAndLeavesNothing) {
  const auto folder = fresh_folder("png-refused");
  EXPECT_THROW(write_png(folder / "a.png", ImageRgb8{4, 4, {1, 2, 3}}), BadInput);
  EXPECT_THROW(write_png(folder / "a.png", ImageRgb8{}), BadInput);
  EXPECT_THROW(write_png(folder / "missing" / "a.png", gradient(2, 2)), BadInput);
  EXPECT_EQ(files_in(folder), 0u);
}

TEST(Png, RefusesDamageAtEveryLength) {
  const auto folder = fresh_folder("png-cut");
  write_png(folder / "a.png", gradient(6, 3));
  const std::string whole = bytes_of(folder / "a.png");
  EXPECT_THROW(read_png(folder / "absent.png"), BadInput);
  // The last chunk (12 bytes) says only that nothing follows.
  for (std::size_t length = 0; length + 16 < whole.size(); ++length) {
    write_file_atomically(folder / "cut.png", whole.substr(0, length));
    EXPECT_THROW(read_png(folder / "cut.png"), BadInput) << length;
  }
}

TEST(Exr, KeepsEveryBitOfEveryChannel) {
  const auto folder = fresh_folder("exr");
  const float infinity = std::numeric_limits<float>::infinity();
  const std::vector<ExrChannel> channels{{"R", {0.0f, 1.5f, -2.0f, 1e30f, 1e-30f, infinity}},
                                         {"distance", {1, 2, 3, 4, 5, 6}}};
  write_exr(folder / "a.exr", 3, 2, channels);
  EXPECT_EQ(files_in(folder), 1u);

  Imf::InputFile file((folder / "a.exr").c_str());
  const auto window = file.header().dataWindow();
  ASSERT_EQ(window.max.x - window.min.x + 1, 3);
  ASSERT_EQ(window.max.y - window.min.y + 1, 2);
  for (const ExrChannel& channel : channels) {
    std::vector<float> values(6);
    Imf::FrameBuffer frame;
    frame.insert(channel.name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), 4, 12));
    file.setFrameBuffer(frame);
    file.readPixels(0, 1);
    EXPECT_EQ(values, channel.values) << channel.name;
  }
}

TEST(Exr, RefusesWrongSizesAndPlacesAndLeavesNothing) {
  const auto folder = fresh_folder("exr-refused");
  EXPECT_THROW(write_exr(folder / "a.exr", 3, 2, {{"R", {1.0f}}}), BadInput);
  EXPECT_THROW(write_exr(folder / "missing" / "a.exr", 1, 1, {{"R", {1.0f}}}), BadInput);
  EXPECT_EQ(files_in(folder), 0u);
}

TEST(AtomicFile, ReplacesWholeFilesOnly) {
  const auto folder = fresh_folder("atomic");
  write_file_atomically(folder / "a", "first");
  write_file_atomically(folder / "a", std::string("sec\0nd", 6));
  EXPECT_EQ(bytes_of(folder / "a"), std::string("sec\0nd", 6));
  EXPECT_EQ(files_in(folder), 1u);
}

TEST(DisplayTransform, ExposesAndEncodes) {
  // Exposure value 0 shows 1.2 cd/m^2 as 1. A grey of 0.18 is below the tone curve's shoulder, which takes 0.04 off.
  const ImageRgb8 image = display_transform({1, 1, {glm::vec3(0.18f * 1.2f)}}, 0.0f);
  const double expected = 255.0 * (1.055 * std::pow(0.14, 1.0 / 2.4) - 0.055);
  for (const std::uint8_t value : image.rgb) EXPECT_NEAR(value, expected, 0.51);
  EXPECT_EQ(display_transform({1, 1, {glm::vec3(0.18f * 1.2f * 8.0f)}}, 3.0f).rgb, image.rgb)
      << "a stop is a factor of 2";
}

TEST(DisplayTransform, IsMonotonousAndSurvivesAnyValue) {
  const float infinity = std::numeric_limits<float>::infinity();
  ImageRgbF image{7, 1, {}};
  for (const float value : {-infinity, -1.0f, 0.0f, 1.0f, 100.0f, 1e30f, infinity}) image.rgb.emplace_back(value);
  const ImageRgb8 shown = display_transform(image, 0.0f);
  for (std::size_t i = 3; i < shown.rgb.size(); ++i) EXPECT_GE(shown.rgb[i], shown.rgb[i - 3]);
  EXPECT_EQ(shown.rgb.front(), 0);
  EXPECT_EQ(shown.rgb.back(), 255);
  EXPECT_EQ(display_transform({1, 1, {glm::vec3(std::nanf(""))}}, 0.0f).rgb[0], 0);
}

TEST(FalseColour, GoesFromBlueToYellow) {
  const ImageRgb8 image = false_colour({0.0f, 2.0f, 9.0f, std::nanf("")}, 4, 1, 2.0f);
  EXPECT_GT(image.rgb[2], image.rgb[0]) << "blue";
  EXPECT_GT(image.rgb[3], image.rgb[5]) << "yellow";
  EXPECT_EQ(image.rgb[3], image.rgb[6]) << "clamped";
  EXPECT_EQ(image.rgb[10], 0) << "magenta";
}

TEST(SideBySide, JoinsRows) {
  const ImageRgb8 left{1, 2, {1, 2, 3, 4, 5, 6}};
  const ImageRgb8 right{2, 2, {7, 7, 7, 8, 8, 8, 9, 9, 9, 10, 10, 10}};
  const ImageRgb8 both = side_by_side({left, right});
  EXPECT_EQ(both.width_px, 3);
  EXPECT_THAT(both.rgb, testing::ElementsAre(1, 2, 3, 7, 7, 7, 8, 8, 8, 4, 5, 6, 9, 9, 9, 10, 10, 10));
  EXPECT_THROW(side_by_side({left, ImageRgb8{1, 1, {0, 0, 0}}}), BadInput);
}

}  // namespace
}  // namespace probewalk
