// The maps beside a still's colours, as other programs read them.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "support/room_pack.h"
#include "tools/run_probewalk.h"

namespace probewalk::test {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 96, kHeight = 64;  // of one eye
constexpr double kFov_deg = 70.0;

const fs::path& pack() {
  static const fs::path folder = [] {
    const fs::path made = fresh_folder("stills") / "room.probes";
    write_room_pack(made);
    return made;
  }();
  return folder;
}

std::set<std::string> channels_of(const fs::path& file) {
  Imf::InputFile in(file.c_str());
  std::set<std::string> names;
  for (auto at = in.header().channels().begin(); at != in.header().channels().end(); ++at) names.insert(at.name());
  return names;
}

std::vector<float> channel_of(const fs::path& file, const char* name, std::size_t width) {
  Imf::InputFile in(file.c_str());
  std::vector<float> values(width * kHeight);
  Imf::FrameBuffer frame;
  frame.insert(name,
               Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), sizeof(float), sizeof(float) * width));
  in.setFrameBuffer(frame);
  in.readPixels(0, kHeight - 1);
  return values;
}

RunResult render(const fs::path& out, const std::vector<std::string>& more) {
  std::vector<std::string> words{"render", pack().string(), "-o", out.string(), "--size", "96x64", "--fov", "70"};
  words.insert(words.end(), more.begin(), more.end());
  return run_probewalk(out.parent_path(), words);
}

TEST(Stills, AnExrHoldsWhatWasAskedForAndNoMore) {
  const fs::path dir = fresh_folder("stills-channels");
  ASSERT_EQ(render(dir / "plain.exr", {}).exit_code, 0);
  EXPECT_EQ(channels_of(dir / "plain.exr"), (std::set<std::string>{"R", "G", "B"}));
  ASSERT_EQ(render(dir / "maps.exr", {"--aov", "distance,depth,lookups,probe,class"}).exit_code, 0);
  EXPECT_EQ(channels_of(dir / "maps.exr"),
            (std::set<std::string>{"R", "G", "B", "distance", "Z", "lookups", "probe", "class"}));
  ASSERT_EQ(render(dir / "picture.png", {"--aov", "depth"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(dir / "picture-depth.png"));
  EXPECT_EQ(render(dir / "picture.png", {"--aov", "deep"}).exit_code, 2);
}

TEST(Stills, DepthIsTheDistanceAlongTheViewsAxis) {
  const fs::path dir = fresh_folder("stills-depth");
  // Out of the window in the wall at x = 3: hits, and sky.
  ASSERT_EQ(render(dir / "a.exr", {"--pose", "0.5,1.5,0.3,-90,0", "--stereo", "--aov", "distance,depth"}).exit_code, 0);
  const auto distance_m = channel_of(dir / "a.exr", "distance", 2 * kWidth),
             depth_m = channel_of(dir / "a.exr", "Z", 2 * kWidth);
  const double tangent = std::tan(glm::radians(kFov_deg / 2));
  std::size_t hits = 0, misses = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < 2 * kWidth; ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * 2 * kWidth + static_cast<std::size_t>(x);
      if (std::isinf(distance_m[at])) {
        ASSERT_TRUE(std::isinf(depth_m[at]) && depth_m[at] > 0.0f);
        ++misses;
        continue;
      }
      const double across = tangent * kWidth / kHeight * ((x % kWidth + 0.5) / kWidth * 2 - 1);
      const double down = tangent * ((y + 0.5) / kHeight * 2 - 1);
      ASSERT_NEAR(depth_m[at] * std::sqrt(1 + across * across + down * down), distance_m[at], 1e-5 * distance_m[at]);
      ++hits;
    }
  }
  EXPECT_GT(hits, 1000u);
  EXPECT_GT(misses, 100u);
  // The wall over the window is at right angles to the axis: all along it is 2.5 m deep.
  const std::size_t row = 18 * 2 * kWidth;
  for (const std::size_t x : {20u, 48u, 76u}) EXPECT_NEAR(depth_m[row + x], 2.5, 0.05) << x;
  EXPECT_GT(distance_m[row + 20], 2.6f);
}

// The left eye is the same to the bit, the right one where it can be told from the left one's picture to rounding.
TEST(Stills, TheSecondEyeFromTheFirstShowsWhatItTraces) {
  const fs::path dir = fresh_folder("stills-second-eye");
  const std::vector<std::string> eyes{"--pose", "0.5,1.5,0.3,-90,0", "--stereo", "--aov", "distance,lookups"};
  std::vector<std::string> traced = eyes;
  traced.insert(traced.end(), {"--second-eye", "traced"});
  ASSERT_EQ(render(dir / "from-first.exr", eyes).exit_code, 0);
  ASSERT_EQ(render(dir / "traced.exr", traced).exit_code, 0);
  std::size_t shared = 0, differ = 0;
  const auto read = [&](const char* file, const char* name) { return channel_of(dir / file, name, 2 * kWidth); };
  const auto distance = read("from-first.exr", "distance"), plain = read("traced.exr", "distance");
  const auto lookups = read("from-first.exr", "lookups"), plain_lookups = read("traced.exr", "lookups");
  for (std::size_t k = 0; k < distance.size(); ++k) {
    if (k % (2 * kWidth) < kWidth) {
      ASSERT_EQ(distance[k], plain[k]);
      ASSERT_EQ(lookups[k], plain_lookups[k]);
      continue;
    }
    shared += lookups[k] != plain_lookups[k];
    differ += std::abs(distance[k] - plain[k]) > 1e-3f * plain[k];
  }
  EXPECT_GT(shared, std::size_t{kWidth * kHeight} / 3);
  EXPECT_LT(differ, std::size_t{kWidth * kHeight} / 40) << "holes, of which the distance is a guess, included";
  EXPECT_NE(render(dir / "no.exr", {"--stereo", "--second-eye", "guessed"}).exit_code, 0);
}

}  // namespace
}  // namespace probewalk::test
