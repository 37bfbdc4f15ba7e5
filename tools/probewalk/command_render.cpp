// probewalk render: stills of a pack, their auxiliary pictures, and the same picture from the triangles.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "content/error.h"
#include "content/pack/pack_format.h"
#include "content/probe/probe_set.h"
#include "render/second_eye.h"
#include "render/view.h"
#include "shaders/shared/display_transform.h"
#include "tools/probewalk/commands.h"
#include "tools/probewalk/foveation_option.h"
#include "tools/probewalk/method_options.h"
#include "tools/probewalk/named_poses.h"
#include "tools/probewalk/reference_picture.h"
#include "tools/probewalk/second_eye_option.h"
#include "tools/probewalk/still.h"
#include "xr/eyes.h"

namespace probewalk {

namespace {

namespace fs = std::filesystem;

constexpr unsigned kMaxSide_px = 8192;
const std::vector<std::string> kAovNames{"radiance", "distance", "depth", "lookups", "probe", "class", "rays"};

struct RenderArguments {
  std::string pack, output;
  std::vector<double> pose;  // x, y, z, yaw, pitch; metres and degrees
  std::string poses_file;
  std::string size = "1280x720";
  double fov_deg = 70.0;
  bool stereo = false;
  double ipd_m = 0.063;
  std::vector<std::string> aov;
  std::uint32_t samples = 1;
  std::string foveation = "off";
  std::string second_eye = kSecondEyeFromFirst;
  double ev = 0.0;
  CLI::Option* ev_option = nullptr;
  bool reference = false;
  MethodOptions method;  // its scene is the reference's, too
  double scale = 0.0;
  std::optional<double> own_scale() const { return scale > 0.0 ? std::optional(scale) : std::nullopt; }
};

VkExtent2D parse_size(const std::string& text) {
  unsigned width = 0, height = 0;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%5ux%5u%c", &width, &height, &rest) != 2 || width < 1 || height < 1 ||
      width > kMaxSide_px || height > kMaxSide_px) {
    throw BadUsage(fmt::format("--size {}: write WxH in pixels of one eye, such as 1280x720, at most {} a side", text,
                               kMaxSide_px));
  }
  return {width, height};
}

struct Views {
  glm::dvec3 head_m{0.0};
  std::vector<ViewConstants> constants;
};

Views make_views(const RenderArguments& arguments, const Pose& pose, VkExtent2D extent) {
  ViewPose head;
  const std::vector<ViewPose> eyes =
      eyes_of(pose, {arguments.ipd_m, glm::radians(arguments.fov_deg)}, extent, &head);
  Views views{head.position_m, {}};
  for (const ViewPose& eye : arguments.stereo ? eyes : std::vector<ViewPose>{head}) {
    views.constants.push_back(view_constants(
        eye.position_m, eye.orientation, {eye.fov_left_rad, eye.fov_right_rad, eye.fov_up_rad, eye.fov_down_rad},
        static_cast<int>(extent.width)));
  }
  return views;
}

// Maps of equal size side by side: what side_by_side does for pictures.
template <typename T, typename Value>
std::vector<float> joined(const std::vector<std::vector<T>>& maps, VkExtent2D extent, Value value) {
  std::vector<float> result;
  result.reserve(maps.size() * maps.front().size());
  for (std::size_t y = 0; y < extent.height; ++y) {
    for (const auto& map : maps) {
      for (std::size_t x = 0; x < extent.width; ++x) result.push_back(value(map[y * extent.width + x]));
    }
  }
  return result;
}

std::vector<std::vector<glm::vec3>> texels(const std::vector<ImageRgbF>& images) {
  std::vector<std::vector<glm::vec3>> result;
  for (const ImageRgbF& image : images) result.push_back(image.rgb);
  return result;
}

// Rays of a pixel, from its counts (StereoTracer::aov).
std::uint32_t rays_of(glm::uvec4 counts) { return counts.w >> 8 & 255u; }

// An auxiliary map of the whole picture.
std::vector<float> aov_map(const Still& still, const std::string& name, VkExtent2D extent) {
  const auto metres = [](float m) { return m; };
  if (name == "distance") return joined(still.distance_m, extent, metres);
  if (name == "depth") return joined(still.depth_m, extent, metres);
  const auto count = [&](auto value) { return joined(still.counts, extent, value); };
  if (name == "lookups") return count([](glm::uvec4 c) { return static_cast<float>(c.z); });
  if (name == "probe") return count([](glm::uvec4 c) { return static_cast<float>(static_cast<std::int32_t>(c.y)); });
  if (name == "rays") return count([](glm::uvec4 c) { return static_cast<float>(rays_of(c)); });
  return count([](glm::uvec4 c) { return static_cast<float>(c.x); });  // class
}

std::vector<ExrChannel> colour_channels(const std::vector<ImageRgbF>& images, VkExtent2D extent) {
  const auto rgb = texels(images);
  return {{"R", joined(rgb, extent, [](glm::vec3 c) { return c.x; })},
          {"G", joined(rgb, extent, [](glm::vec3 c) { return c.y; })},
          {"B", joined(rgb, extent, [](glm::vec3 c) { return c.z; })}};
}

// OUT with `tag` before its extension.
fs::path beside(const fs::path& output, const std::string& tag, const std::string& extension) {
  return output.parent_path() / (output.stem().string() + "-" + tag + extension);
}

float largest_finite(const std::vector<float>& values) {
  float largest = 0.0f;
  for (const float value : values) {
    if (std::isfinite(value)) largest = std::max(largest, value);
  }
  return largest;
}

class RenderJob {
 public:
  RenderJob(const RenderArguments& arguments, const CommonOptions& common)
      : arguments_(arguments),
        output_(arguments.output),
        is_exr_(output_.extension() == ".exr"),
        pack_(Pack::open(arguments.pack)),
        ev_(arguments.ev_option->count() > 0 ? arguments.ev : pack_.manifest().exposure_ev),
        extent_(parse_size(arguments.size)),
        poses_(chosen_poses()),
        progress_(make_progress(common)),
        choice_(chosen_tracer(arguments.method)),
        device_({}, {.device = common.device}),
        drawer_(pack_, device_, extent_, arguments.stereo ? 2 : 1, arguments.samples, *progress_, choice_,
                chosen_maps(choice_, arguments.method, pack_, arguments.own_scale(), common.threads, *progress_).get(),
                foveation_of(arguments.foveation), arguments.second_eye == kSecondEyeFromFirst) {
    if (arguments.reference) {
      reference_ = std::make_unique<ReferenceCaster>(arguments.method.scene, pack_.manifest(), arguments.own_scale(),
                                                     common.threads, *progress_);
    }
  }

  // One report a picture.
  std::vector<nlohmann::json> run();

 private:
  std::vector<NamedPose> chosen_poses() const;
  nlohmann::json draw(const NamedPose& pose);
  std::vector<ImageRgb8> displayed(const std::vector<ImageRgbF>& images) const;
  void write(const fs::path& file, const std::vector<ImageRgb8>& shown, const std::vector<ImageRgbF>& radiance,
             std::vector<ExrChannel> more = {}) const;
  void write_still(const fs::path& file, const Still& still) const;
  void compare(const fs::path& file, const Views& views, const Still& still, nlohmann::json& report) const;
  void count(const Still& still, nlohmann::json& report) const;
  int view_count() const { return arguments_.stereo ? 2 : 1; }
  int width_px() const { return static_cast<int>(extent_.width) * view_count(); }
  int height_px() const { return static_cast<int>(extent_.height); }

  const RenderArguments& arguments_;
  const fs::path output_;
  const bool is_exr_;
  const Pack pack_;
  const double ev_;
  const VkExtent2D extent_;
  const std::vector<NamedPose> poses_;
  const std::unique_ptr<Progress> progress_;
  const TracerChoice choice_;
  const Device device_;
  StillDrawer drawer_;
  std::unique_ptr<ReferenceCaster> reference_;
};

// Without --poses one, without a name.
std::vector<NamedPose> RenderJob::chosen_poses() const {
  if (!arguments_.poses_file.empty()) return read_named_poses(arguments_.poses_file);
  return {{"", arguments_.pose.empty() ? pack_.manifest().start : pose_of_numbers(arguments_.pose, "--pose")}};
}

std::vector<nlohmann::json> RenderJob::run() {
  std::vector<nlohmann::json> reports;
  for (const NamedPose& pose : poses_) {
    if (progress_->cancelled()) throw Interrupted("interrupted; finished pictures are kept");
    reports.push_back(draw(pose));
  }
  return reports;
}

nlohmann::json RenderJob::draw(const NamedPose& pose) {
  const Views views = make_views(arguments_, pose.pose, extent_);
  FrameSettings settings;
  settings.trace = default_dials(pack_.manifest().radiance_scale);
  settings.exposure = exposure_from_ev(static_cast<float>(ev_));
  const Still still = drawer_.draw(views.head_m, views.constants, settings);
  const fs::path file = pose.name.empty() ? output_ : beside(output_, pose.name, output_.extension().string());
  nlohmann::json report = {{"picture", file.string()},
                           {"device", device_.info().name},
                           {"width", width_px()},
                           {"height", height_px()},
                           {"views", view_count()},
                           {"method", name_of(choice_)},
                           {"settings", describe(choice_)},
                           {"exposure_ev", ev_}};
  if (!pose.name.empty()) report["name"] = pose.name;
  count(still, report);
  if (reference_) {
    compare(file, views, still, report);
  } else {
    write_still(file, still);
  }
  return report;
}

std::vector<ImageRgb8> RenderJob::displayed(const std::vector<ImageRgbF>& images) const {
  std::vector<ImageRgb8> result;
  for (const ImageRgbF& image : images) result.push_back(display_transform(image, static_cast<float>(ev_)));
  return result;
}

void RenderJob::write(const fs::path& file, const std::vector<ImageRgb8>& shown,
                      const std::vector<ImageRgbF>& radiance, std::vector<ExrChannel> more) const {
  if (!is_exr_) return write_png(file, side_by_side(shown));
  std::vector<ExrChannel> channels = colour_channels(radiance, extent_);
  std::move(more.begin(), more.end(), std::back_inserter(channels));
  write_exr(file, width_px(), height_px(), channels);
}

void RenderJob::write_still(const fs::path& file, const Still& still) const {
  std::vector<ExrChannel> maps;
  for (const std::string& name : arguments_.aov) {
    // Z is what OpenEXR's convention calls the distance along the view's axis.
    const std::string channel = is_exr_ && name == "depth" ? "Z" : name;
    if (name != "radiance") maps.push_back({channel, aov_map(still, name, extent_)});
  }
  write(file, still.shown, still.radiance_cd_m2, maps);
  if (is_exr_) return;
  for (const ExrChannel& map : maps) {
    write_png(beside(file, map.name, ".png"),
              false_colour(map.values, width_px(), height_px(), std::max(largest_finite(map.values), 1e-6f)));
  }
  if (std::find(arguments_.aov.begin(), arguments_.aov.end(), "radiance") != arguments_.aov.end()) {
    // Luminance (Rec. 709) in false colour: what the tone curve hides.
    const auto luminance = joined(texels(still.radiance_cd_m2), extent_,
                                  [](glm::vec3 c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; });
    write_png(beside(file, "radiance", ".png"),
              false_colour(luminance, width_px(), height_px(), std::max(largest_finite(luminance), 1e-6f)));
  }
}

// FILE from the triangles; FILE-probes from the probes; FILE-difference, the error as an eye sees it.
void RenderJob::compare(const fs::path& file, const Views& views, const Still& still, nlohmann::json& report) const {
  const auto reference = reference_->cast(views.constants, static_cast<int>(extent_.width), height_px());
  // Both without dither, which is no error of the probes.
  const auto expected = displayed(reference), actual = displayed(still.radiance_cd_m2);
  write(file, expected, reference);
  write_still(beside(file, "probes", file.extension().string()), still);
  std::vector<float> map;
  const float pixels_per_degree = static_cast<float>(extent_.height / arguments_.fov_deg);
  const ImageRgb8 expected_picture = side_by_side(expected), actual_picture = side_by_side(actual);
  const float flip = flip_mean(expected_picture, actual_picture, pixels_per_degree, &map);
  const double psnr = psnr_db(expected_picture, actual_picture);
  write_png(beside(file, "difference", ".png"), false_colour(map, width_px(), height_px(), 1.0f));
  report["flip_mean"] = flip;
  report["psnr_db"] = std::isfinite(psnr) ? nlohmann::json(psnr) : nlohmann::json();
  report["pixels_per_degree"] = pixels_per_degree;
}

void RenderJob::count(const Still& still, nlohmann::json& report) const {
  std::vector<std::uint32_t> lookups;
  double sum = 0.0;
  std::size_t unknown = 0, hits = 0, rays = 0;
  for (const auto& view : still.counts) {
    for (const glm::uvec4& texel : view) {
      lookups.push_back(texel.z);
      sum += texel.z;
      rays += rays_of(texel);
      hits += texel.x == static_cast<std::uint32_t>(kClassHit);
      unknown += texel.x == static_cast<std::uint32_t>(kClassUnknown);
    }
  }
  const auto share = [&](std::size_t n) { return static_cast<double>(n) / static_cast<double>(lookups.size()); };
  const auto p99 = lookups.begin() + static_cast<std::ptrdiff_t>(lookups.size() * 99 / 100);
  std::nth_element(lookups.begin(), p99, lookups.end());
  report["hit_fraction"] = share(hits);
  report["unknown_fraction"] = share(unknown);
  report["samples"] = arguments_.samples;
  report["foveation"] = arguments_.foveation;
  if (arguments_.stereo) {
    const bool shares = arguments_.second_eye == kSecondEyeFromFirst &&
                        SecondEye::suits(extent_, 2, foveation_of(arguments_.foveation).has_value(), choice_);
    report["second_eye"] = shares ? kSecondEyeFromFirst : kSecondEyeTraced;
  }
  report["rays_mean"] = static_cast<double>(rays) / static_cast<double>(lookups.size());
  report["lookups_mean"] = sum / static_cast<double>(lookups.size());
  report["lookups_p99"] = *p99;
  report["trace_ns"] = still.times.trace.end_ns - still.times.trace.begin_ns;
}

void check_usage(const RenderArguments& arguments) {
  const std::string extension = fs::path(arguments.output).extension().string();
  if (extension != ".png" && extension != ".exr") {
    throw BadUsage(fmt::format("-o {}: give a file that ends in .png or .exr", arguments.output));
  }
  if (!arguments.pose.empty() && !arguments.poses_file.empty()) {
    throw BadUsage("--pose and --poses: give one of them");
  }
  const std::string& scene = arguments.method.scene;
  if (arguments.reference && scene.empty()) {
    throw BadUsage("--reference casts at the triangles: name the scene that the pack was baked from with --scene FILE");
  }
  if (!arguments.reference && !scene.empty() && !chosen_tracer(arguments.method).needs_maps()) {
    throw BadUsage("--scene is read for --reference and for methods that need maps: add --reference or leave it away");
  }
}

double mean_of(const std::vector<nlohmann::json>& reports, const char* key) {
  double sum = 0.0;
  for (const nlohmann::json& report : reports) sum += report[key].get<double>();
  return sum / static_cast<double>(reports.size());
}

std::string psnr_text(const nlohmann::json& psnr) {
  return psnr.is_null() ? "infinite" : fmt::format("{:.2f}", psnr.get<double>());
}

// A line a picture, and what they have in common.
void print_table(const std::vector<nlohmann::json>& reports) {
  fmt::print("{:<16} {:>8} {:>9} {:>9} {:>9} {:>8}\n", "view", "FLIP", "PSNR dB", "unknown", "look-ups", "p99");
  for (const nlohmann::json& r : reports) {
    fmt::print("{:<16} {:>8.4f} {:>9} {:>7.2f} % {:>9.1f} {:>8}\n", r["name"].get<std::string>(),
               r["flip_mean"].get<double>(), psnr_text(r["psnr_db"]), 100.0 * r["unknown_fraction"].get<double>(),
               r["lookups_mean"].get<double>(), r["lookups_p99"].get<unsigned>());
  }
  fmt::print("{:<16} {:>8.4f} {:>9} {:>7.2f} % {:>9.1f}\n", "mean", mean_of(reports, "flip_mean"), "",
             100.0 * mean_of(reports, "unknown_fraction"), mean_of(reports, "lookups_mean"));
}

void run_render(const RenderArguments& arguments, const CommonOptions& common) {
  check_usage(arguments);
  const std::vector<nlohmann::json> reports = RenderJob(arguments, common).run();
  const bool is_list = !arguments.poses_file.empty();
  if (common.json) {
    std::puts((is_list ? nlohmann::json{{"pictures", reports}} : reports.front()).dump(2).c_str());
  } else if (arguments.reference && is_list) {
    fmt::print("at {:.1f} pixels per degree\n", reports.front()["pixels_per_degree"].get<double>());
    print_table(reports);
  } else if (arguments.reference) {
    const nlohmann::json& report = reports.front();
    fmt::print("{}: FLIP {:.4f} at {:.1f} pixels per degree, PSNR {} dB\n", arguments.output,
               report["flip_mean"].get<double>(), report["pixels_per_degree"].get<double>(), psnr_text(report["psnr_db"]));
  }
}

}  // namespace

void add_render_command(CLI::App& app, CommonOptions& common) {
  CLI::App* command = app.add_subcommand("render", "Draw stills of a pack, or the same picture from the triangles");
  command->footer(
      "A PNG is what the display would get (exposure, tone curve, sRGB); an EXR is linear radiance in cd/m^2. With --aov a\n"
      "PNG gets false-colour pictures beside it (OUT-distance.png, ...), an EXR gets channels of those names: distance is\n"
      "metres along each pixel's ray, depth metres along the view's axis (channel Z in an EXR), both infinite where the\n"
      "sky is; where the probes do not know what is there, both tell how far the way is free. With --reference, OUT is\n"
      "cast at the triangles, OUT-probes is the same picture from the probes, OUT-difference.png the error as an eye sees\n"
      "it (FLIP), and FLIP and PSNR are printed. With --poses there is a picture a line of the file, OUT-NAME, and with\n"
      "--reference a table of them; the scene's light is built once for all.\n\n"
      "  probewalk render house.probes -o still.png --pose 1,1.6,2,30,0 --stereo\n"
      "  probewalk render house.probes -o still.png --reference --scene house.glb\n"
      "  probewalk render house.probes -o still.png --poses views.txt\n"
      "  probewalk render house.probes -o still.png --method two-level --scene house.glb");
  auto arguments = std::make_shared<RenderArguments>();
  command->add_option("pack", arguments->pack, "The pack (a folder NAME.probes)")->required();
  command->add_option("-o,--output", arguments->output, "The picture: .png or .exr")->required();
  command->add_option("--pose", arguments->pose,
                      "Head: x,y,z in metres, yaw (0 looks along -z, positive to the left) and pitch (positive up) in "
                      "degrees (default: the pack's start)")->delimiter(',')->expected(5);
  command->add_option("--poses", arguments->poses_file,
                      "File with a picture a line: NAME x,y,z,yaw,pitch; the picture is OUT-NAME");
  command->add_option("--size", arguments->size, "Pixels of one eye, WxH")->capture_default_str();
  command->add_option("--fov", arguments->fov_deg, "Vertical field of view in degrees")
      ->check(CLI::Range(1.0, 170.0))->capture_default_str();
  command->add_flag("--stereo", arguments->stereo, "Left and right eye in one picture");
  command->add_option("--ipd", arguments->ipd_m, "Metres between the eyes")->check(CLI::Range(0.0, 1.0))->capture_default_str();
  command->add_option("--aov", arguments->aov, "Auxiliary pictures: radiance,distance,depth,lookups,probe,class,rays")
      ->delimiter(',')->check(CLI::IsMember(kAovNames));
  command->add_option("--samples", arguments->samples, "Rays of a pixel at an edge: 1, 2 or 4")
      ->check(CLI::IsMember({1, 2, 4}))->capture_default_str();
  add_foveation_option(*command, arguments->foveation);
  add_second_eye_option(*command, arguments->second_eye);
  arguments->ev_option = command->add_option("--ev", arguments->ev, "Exposure value at ISO 100 (default: the pack's)")
      ->check(CLI::Range(-30.0, 30.0));
  command->add_flag("--reference", arguments->reference, "Cast the picture at the triangles, and compare");
  command->add_option("--scene", arguments->method.scene,
                      "The scene that the pack was baked from, for --reference and for methods that need maps of it");
  command->add_option("--scale", arguments->scale, "Metres per unit of the scene's file (default: as the pack was baked)")
      ->check(CLI::PositiveNumber);
  add_method_options(*command, arguments->method);
  add_common_options(*command, common);
  command->callback([arguments, &common] { run_render(*arguments, common); });
}

}  // namespace probewalk
