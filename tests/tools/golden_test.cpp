// Golden pictures of the sample house, baked small and rendered in stereo. Tolerance: at most 1 % of the pixels may
// be off by more than 5 of 255 in any channel. `PROBEWALK_UPDATE_GOLDEN=1 tools/test -R golden` renews them; a failure
// leaves the picture and a difference picture in the build's test-output/tools/golden.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "content/image/image.h"
#include "tools/run_probewalk.h"

namespace probewalk::test {
namespace {

namespace fs = std::filesystem;

constexpr int kTolerance = 5;
// Which instructions Embree uses decides how its rays round: every processor has these.
constexpr const char* kIsa = "sse2";
// Embree's sse2 against its avx2 on one processor: 0.33 % at most. A wrong texel choice or light shows in 5 % and more.
constexpr double kFailingShare = 0.01;

struct View {
  std::string name, pose;
};

std::vector<View> house_views() {
  std::vector<View> views;
  std::ifstream file(fs::path(PROBEWALK_SOURCE_DIR) / "tools/house-views.txt");
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream fields(line);
    View view;
    if (fields >> view.name >> view.pose) views.push_back(view);
  }
  return views;
}

TEST(Golden, HouseLooksAsItDid) {
  const std::vector<View> views = house_views();
  ASSERT_EQ(views.size(), 6u);
  const fs::path dir = fresh_folder("golden");
  ASSERT_EQ(run_probewalk(dir, {"scene", "house", "-o", (dir / "house.glb").string()}).exit_code, 0);
  const RunResult baked =
      run_probewalk(dir, {"bake", (dir / "house.glb").string(), "-o", (dir / "house.probes").string(), "--resolution",
                          "128", "--max-probes", "60", "--samples", "32", "--bounces", "2", "--isa", kIsa, "-q"});
  ASSERT_EQ(baked.exit_code, 0) << baked.err;
  for (const View& view : views) {
    const fs::path picture = dir / (view.name + ".png");
    const RunResult r = run_probewalk(dir, {"render", (dir / "house.probes").string(), "-o", picture.string(), "--pose",
                                            view.pose, "--stereo", "--size", "160x120", "--fov", "75"});
    ASSERT_EQ(r.exit_code, 0) << r.err;
    const fs::path golden = fs::path(PROBEWALK_SOURCE_DIR) / "tests/golden" / (view.name + ".png");
    if (std::getenv("PROBEWALK_UPDATE_GOLDEN") != nullptr) {
      fs::create_directories(golden.parent_path());
      fs::copy_file(picture, golden, fs::copy_options::overwrite_existing);
      continue;
    }
    ASSERT_TRUE(fs::exists(golden)) << golden
                                    << " is missing; PROBEWALK_UPDATE_GOLDEN=1 tools/test -R golden writes it";
    const ImageRgb8 expected = read_png(golden), actual = read_png(picture);
    ASSERT_EQ(actual.width_px, expected.width_px);
    ASSERT_EQ(actual.height_px, expected.height_px);
    std::size_t failing = 0;
    std::vector<float> difference(actual.rgb.size() / 3);
    for (std::size_t p = 0; p < difference.size(); ++p) {
      int worst = 0;
      for (std::size_t c = 0; c < 3; ++c)
        worst = std::max(worst, std::abs(int{actual.rgb[3 * p + c]} - int{expected.rgb[3 * p + c]}));
      difference[p] = static_cast<float>(worst);
      failing += worst > kTolerance;
    }
    const double share = static_cast<double>(failing) / static_cast<double>(difference.size());
    if (share > kFailingShare) {
      const fs::path file = dir / (view.name + "-difference.png");
      write_png(file, false_colour(difference, actual.width_px, actual.height_px, 32.0f));
      ADD_FAILURE() << view.name << ": " << 100.0 * share << " % of the pixels differ by more than " << kTolerance
                    << "; look at " << file;
    }
  }
}

}  // namespace
}  // namespace probewalk::test
