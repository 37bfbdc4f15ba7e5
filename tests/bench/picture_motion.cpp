// How still the picture holds along a slow way of the head: draws a pack in stereo frame by frame, compares with the
// same pictures from the triangles, and prints a table; DIR/motion.json holds it, too. The triangles' pictures are kept
// in DIR and used again: a DIR is for one way through one pack.
//   picture_motion PACK SCENE DIR FROM TO [FRAMES [WIDTHxHEIGHT [SAMPLES [SIDE]]]]      FROM, TO: x,y,z,yaw,pitch
// SAMPLES: rays a pixel at edges, of the probes' pictures. SIDE: rays along a pixel's side, of the triangles'; with 1
// theirs flicker at edges as much as the probes', and the error does not tell which of both jumped.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <sstream>
#include <string>

#include "bench/motion_metrics.h"
#include "content/error.h"
#include "content/probe/probe_set.h"
#include "render/view.h"
#include "shaders/shared/display_transform.h"
#include "tools/probewalk/named_poses.h"
#include "tools/probewalk/reference_picture.h"
#include "tools/probewalk/still.h"
#include "xr/eyes.h"

namespace probewalk::bench {
namespace {

namespace fs = std::filesystem;

constexpr double kFov_deg = 75.0;
constexpr double kIpd_m = 0.063;
constexpr int kFlipEvery = 10;  // frames

struct Arguments {
  fs::path pack, scene, dir;
  Pose from, to;
  int frames = 60;
  VkExtent2D extent{240, 180};
  std::uint32_t samples = 1;
  int side = 1;
};

Pose parse_pose(const std::string& text) {
  std::vector<double> numbers;
  std::istringstream in(text);
  for (std::string number; std::getline(in, number, ',');) numbers.push_back(std::stod(number));
  if (numbers.size() != 5) throw BadUsage(text + ": write a pose as x,y,z,yaw,pitch");
  return pose_of_numbers(numbers, text);
}

Arguments parse(int argc, char** argv) {
  if (argc < 6) throw BadUsage("picture_motion PACK SCENE DIR FROM TO [FRAMES [WIDTHxHEIGHT [SAMPLES [SIDE]]]]");
  Arguments a{argv[1], argv[2], argv[3], parse_pose(argv[4]), parse_pose(argv[5])};
  if (argc > 6) a.frames = std::stoi(argv[6]);
  if (argc > 7 && std::sscanf(argv[7], "%ux%u", &a.extent.width, &a.extent.height) != 2) {
    throw BadUsage(std::string(argv[7]) + ": write WxH in pixels of one eye");
  }
  if (argc > 8) a.samples = static_cast<std::uint32_t>(std::stoul(argv[8]));
  if (argc > 9) a.side = std::stoi(argv[9]);
  if (a.side < 1 || a.side > 16) throw BadUsage("SIDE: 1 to 16 rays");
  if (a.frames < 2) throw BadUsage("two frames at least");
  return a;
}

Pose between(const Pose& from, const Pose& to, double share) {
  return {glm::mix(from.position_m, to.position_m, share), glm::mix(from.yaw_rad, to.yaw_rad, share),
          glm::mix(from.pitch_rad, to.pitch_rad, share)};
}

std::vector<ViewConstants> eyes_at(const Pose& pose, VkExtent2D extent) {
  std::vector<ViewConstants> views;
  for (const ViewPose& eye : eyes_of(pose, {kIpd_m, glm::radians(kFov_deg)}, extent, nullptr)) {
    views.push_back(view_constants(eye.position_m, eye.orientation,
                                   {eye.fov_left_rad, eye.fov_right_rad, eye.fov_up_rad, eye.fov_down_rad},
                                   static_cast<int>(extent.width)));
  }
  return views;
}

// Means of side x side pixels, taken of what is shown, as the probes' extra rays are: light adds up on the display.
ImageRgbF averaged(const ImageRgbF& fine, int side, float exposure) {
  ImageRgbF image{fine.width_px / side, fine.height_px / side, {}};
  image.rgb.reserve(fine.rgb.size() / static_cast<std::size_t>(side * side));
  for (int y = 0; y < image.height_px; ++y) {
    for (int x = 0; x < image.width_px; ++x) {
      glm::vec3 sum(0.0f);
      for (int k = 0; k < side * side; ++k) {
        const int at = (y * side + k / side) * fine.width_px + x * side + k % side;
        sum += tone_curve(fine.rgb[static_cast<std::size_t>(at)] * exposure);
      }
      image.rgb.push_back(tone_curve_inverse(sum / static_cast<float>(side * side)) / exposure);
    }
  }
  return image;
}

// The triangles' pictures of all frames, as displayed: read from `file`, or cast and written there.
std::vector<ImageRgb8> expected_pictures(const Arguments& a, const Manifest& manifest, Progress& progress) {
  const fs::path file =
      a.dir / fmt::format("expected-{}x{}x{}x{}.rgb", a.frames, a.extent.width, a.extent.height, a.side);
  const ImageRgb8 empty{static_cast<int>(a.extent.width), static_cast<int>(a.extent.height),
                        std::vector<std::uint8_t>(3 * std::size_t{a.extent.width} * a.extent.height)};
  std::vector<ImageRgb8> pictures(2 * static_cast<std::size_t>(a.frames), empty);
  std::error_code none;
  if (fs::file_size(file, none) == pictures.size() * empty.rgb.size()) {
    std::ifstream in(file, std::ios::binary);
    for (ImageRgb8& picture : pictures) {
      in.read(reinterpret_cast<char*>(picture.rgb.data()), static_cast<std::streamsize>(picture.rgb.size()));
    }
    return pictures;
  }
  const ReferenceCaster caster(a.scene, manifest, std::nullopt, 0, progress);
  const auto ev = static_cast<float>(manifest.exposure_ev);
  std::ofstream out(file, std::ios::binary);
  for (int frame = 0; frame < a.frames; ++frame) {
    const Pose pose = between(a.from, a.to, frame / (a.frames - 1.0));
    const auto cast = caster.cast(eyes_at(pose, a.extent), empty.width_px * a.side, empty.height_px * a.side);
    for (std::size_t eye = 0; eye < 2; ++eye) {
      ImageRgb8& picture = pictures[2 * static_cast<std::size_t>(frame) + eye];
      const ImageRgbF shown = a.side == 1 ? cast[eye] : averaged(cast[eye], a.side, exposure_from_ev(ev));
      picture = display_transform(shown, ev);
      out.write(reinterpret_cast<const char*>(picture.rgb.data()), static_cast<std::streamsize>(picture.rgb.size()));
    }
  }
  return pictures;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double share(std::size_t part, std::size_t of) { return static_cast<double>(part) / static_cast<double>(of); }

void add_pair_rows(nlohmann::json& table, const std::string& name, const PairSums& sums) {
  const auto twice = static_cast<double>(sums.seen_twice);
  table[name + "_disagree_fraction"] = share(sums.disagree, sums.seen_twice);
  table[name + "_disagree_fraction_triangles"] = share(sums.disagree_expected, sums.seen_twice);
  table[name + "_difference"] = sums.difference / twice;
  table[name + "_difference_triangles"] = sums.difference_expected / twice;
}

nlohmann::json measure(const Arguments& a) {
  SilentProgress progress;
  fs::create_directories(a.dir);
  const Pack pack = Pack::open(a.pack);
  const Manifest& manifest = pack.manifest();
  const std::vector<ImageRgb8> expected = expected_pictures(a, manifest, progress);

  const Device device({}, {});
  StillDrawer drawer(pack, device, a.extent, 2, a.samples, progress);
  FrameSettings settings;
  settings.trace = default_dials(manifest.radiance_scale);
  settings.exposure = exposure_from_ev(static_cast<float>(manifest.exposure_ev));
  MotionSums sums;
  PairSums eyes, in_time;
  std::vector<EyeFrame> before;
  std::vector<double> trace_ms;
  double lookups = 0.0, reads = 0.0, rays = 0.0, flip = 0.0, psnr = 0.0;
  int flips = 0;
  std::size_t pops_before = 0;
  double worst_pops = 0.0;
  for (int frame = 0; frame < a.frames; ++frame) {
    const Pose pose = between(a.from, a.to, frame / (a.frames - 1.0));
    const auto views = eyes_at(pose, a.extent);
    const Still still = drawer.draw(pose.position_m, views, settings);
    trace_ms.push_back(static_cast<double>(still.times.trace.end_ns - still.times.trace.begin_ns) * 1e-6);
    std::vector<EyeFrame> now;
    for (std::size_t eye = 0; eye < 2; ++eye) {
      now.push_back({views[eye], display_transform(still.radiance_cd_m2[eye], static_cast<float>(manifest.exposure_ev)),
                     expected[2 * static_cast<std::size_t>(frame) + eye], still.distance_m[eye], still.counts[eye]});
      for (const glm::uvec4& c : still.counts[eye]) {
        lookups += c.z;
        rays += c.w >> 8 & 255u;
        reads += c.w >> 16;
      }
      if (before.empty()) continue;
      add_change(before[eye], now[eye], sums);
      add_pair(now[eye], before[eye], in_time);
    }
    add_pair(now[0], now[1], eyes);
    const std::size_t frame_pixels = std::size_t{2} * a.extent.width * a.extent.height;
    worst_pops = std::max(worst_pops, share(sums.surface_pops - pops_before, frame_pixels));
    pops_before = sums.surface_pops;
    if (frame % kFlipEvery == 0) {
      const ImageRgb8 shown = side_by_side({now[0].shown, now[1].shown});
      const ImageRgb8 wanted = side_by_side({now[0].expected, now[1].expected});
      flip += flip_mean(wanted, shown, static_cast<float>(a.extent.height / kFov_deg));
      psnr += psnr_db(wanted, shown);
      ++flips;
      write_png(a.dir / fmt::format("frame-{:03}.png", frame), shown);
    }
    before = std::move(now);
  }
  const double all = 2.0 * a.extent.width * a.extent.height * a.frames;
  nlohmann::json table{{"frames", a.frames},
          {"samples", a.samples},
          {"reference_rays_per_side", a.side},
          {"flip_mean", flip / flips},
          {"psnr_db", psnr / flips},
          {"flicker", sums.flicker / static_cast<double>(sums.pixels)},
          {"probe_change_fraction", share(sums.probe_changes, sums.pixels)},
          {"pop_fraction", share(sums.pops, sums.pixels)},
          {"jump_fraction", share(sums.jumps, sums.pixels)},
          {"surface_fraction", share(sums.surface_pixels, sums.pixels)},
          {"surface_flicker", sums.surface_flicker / static_cast<double>(sums.surface_pixels)},
          {"surface_pop_fraction", share(sums.surface_pops, sums.surface_pixels)},
          {"surface_pop_fraction_worst_frame", worst_pops},
          {"surface_jump_fraction", share(sums.surface_jumps, sums.surface_pixels)},
          {"lookups_mean", lookups / all},
          {"attribute_reads_mean", reads / all},
          {"rays_mean", rays / all},
          {"trace_ms_median", median(trace_ms)},
          {"trace_ms_min", *std::min_element(trace_ms.begin(), trace_ms.end())}};
  add_pair_rows(table, "eyes", eyes);
  add_pair_rows(table, "frames", in_time);
  return table;
}

}  // namespace
}  // namespace probewalk::bench

int main(int argc, char** argv) {
  try {
    const probewalk::bench::Arguments arguments = probewalk::bench::parse(argc, argv);
    const nlohmann::json table = probewalk::bench::measure(arguments);
    for (const auto& [name, value] : table.items()) fmt::print("{:<36} {:>12.6g}\n", name, value.get<double>());
    std::ofstream(arguments.dir / "motion.json") << table.dump(2) << "\n";
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
