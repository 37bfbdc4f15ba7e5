// What fixed foveation saves and costs: draws eyes along a pack's tour at every level, side by side, and prints times,
// rays and FLIP against the same picture without, inside and outside the part that keeps a ray a pixel.
//   foveation_table PACK [EYES [SIDE_PX [FOV_DEG]]]
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "content/image/image.h"
#include "content/probe/probe_set.h"
#include "render/view.h"
#include "shaders/shared/display_transform.h"
#include "shaders/shared/view_ray.h"
#include "tools/probewalk/still.h"
#include "xr/path.h"

namespace probewalk::bench {
namespace {

constexpr int kRepeats = 5;

struct LevelResult {
  std::vector<double> ratio;  // of time to the same eye's without foveation
  double rays_share = 0.0, flip_inside = 0.0, flip_outside = 0.0, outside_share = 0.0;
};

double mean_where(const std::vector<float>& map, const std::vector<bool>& inside, bool which) {
  double sum = 0.0, count = 0.0;
  for (std::size_t k = 0; k < map.size(); ++k) {
    if (inside[k] != which) continue;
    sum += double(map[k]);
    count += 1.0;
  }
  return count > 0.0 ? sum / count : 0.0;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void run(const std::filesystem::path& folder, int eyes, int side_px, double fov_deg) {
  const Pack pack = Pack::open(folder);
  const Device device({}, {});
  SilentProgress progress;
  const auto side = static_cast<std::uint32_t>(side_px);
  const auto& levels = foveation_levels();
  std::vector<std::unique_ptr<StillDrawer>> drawers;
  for (const FoveationLevel& level : levels) {
    drawers.push_back(std::make_unique<StillDrawer>(pack, device, VkExtent2D{side, side}, 1, 1, progress,
                                                    TracerChoice{}, nullptr, level.foveation));
  }
  FrameSettings settings;
  settings.trace = default_dials(pack.manifest().radiance_scale);
  settings.exposure = exposure_from_ev(static_cast<float>(pack.manifest().exposure_ev));
  const Path tour = path_of_tour(pack.manifest().tour);
  const double fov_rad = fov_deg * std::numbers::pi / 180.0;
  const auto pixels_per_degree = static_cast<float>(side_px / fov_deg);
  std::vector<LevelResult> results(levels.size());
  for (int eye = 0; eye < eyes; ++eye) {
    const PathPose head = tour.at(tour.duration_s() * (eye + 0.5) / eyes);
    const ViewConstants view =
        view_constants(head.position_m, head.orientation, symmetric_fov(fov_rad, side_px, side_px), side_px);
    std::vector<std::vector<double>> times(levels.size());
    std::vector<Still> stills(levels.size());
    for (int repeat = -1; repeat < kRepeats; ++repeat) {  // the first is the warm-up
      for (std::size_t k = 0; k < levels.size(); ++k) {
        stills[k] = drawers[k]->draw(head.position_m, {view}, settings);
        if (repeat >= 0) times[k].push_back(double(stills[k].times.trace.end_ns - stills[k].times.trace.begin_ns));
      }
    }
    for (std::size_t k = 0; k < levels.size(); ++k) {
      LevelResult& result = results[k];
      for (int repeat = 0; repeat < kRepeats; ++repeat) {
        result.ratio.push_back(times[k][std::size_t(repeat)] / times[0][std::size_t(repeat)]);
      }
      double rays = 0.0;
      for (const glm::uvec4& texel : stills[k].counts[0]) rays += double(texel.w >> 8 & 255u);
      result.rays_share += rays / double(stills[k].counts[0].size()) / eyes;
      if (!levels[k].foveation) continue;
      std::vector<float> map;
      flip_mean(stills[0].shown[0], stills[k].shown[0], pixels_per_degree, &map);
      std::vector<bool> inside;
      for (int y = 0; y < side_px; ++y) {
        for (int x = 0; x < side_px; ++x) {
          inside.push_back(view_ray_cosine(view, {x, y}, {side_px, side_px}) >=
                           std::cos(levels[k].foveation->full_rad));
        }
      }
      result.flip_inside += mean_where(map, inside, true) / eyes;
      result.flip_outside += mean_where(map, inside, false) / eyes;
      result.outside_share += double(std::count(inside.begin(), inside.end(), false)) / double(inside.size()) / eyes;
    }
  }
  fmt::print("{}: {} eyes of {} x {} pixels, {} degrees, {:.1f} pixels a degree, {} repeats\n",
             folder.filename().string(), eyes, side_px, side_px, fov_deg, pixels_per_degree, kRepeats);
  fmt::print("{:<8} {:>10} {:>18} {:>12} {:>13} {:>14}\n", "level", "rays", "time (quartiles)", "FLIP inside",
             "FLIP outside", "outside is");
  for (std::size_t k = 0; k < levels.size(); ++k) {
    LevelResult& r = results[k];
    std::sort(r.ratio.begin(), r.ratio.end());
    fmt::print("{:<8} {:>8.1f} % {:>6.2f} ({:.2f}..{:.2f}) {:>12.4f} {:>13.4f} {:>12.0f} %\n", levels[k].name,
               100.0 * r.rays_share, median(r.ratio), r.ratio[r.ratio.size() / 4], r.ratio[r.ratio.size() * 3 / 4],
               r.flip_inside, r.flip_outside, 100.0 * r.outside_share);
  }
}

}  // namespace
}  // namespace probewalk::bench

int main(int argc, char** argv) {
  if (argc < 2 || argc > 5) {
    std::fputs("foveation_table PACK [EYES [SIDE_PX [FOV_DEG]]]\n", stderr);
    return 2;
  }
  try {
    probewalk::bench::run(argv[1], argc > 2 ? std::stoi(argv[2]) : 4, argc > 3 ? std::stoi(argv[3]) : 768,
                          argc > 4 ? std::stod(argv[4]) : 95.0);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "foveation_table: %s\n", error.what());
    return 1;
  }
}
