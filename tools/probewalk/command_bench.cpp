// probewalk bench: speed against error, every method and setting over the same views.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "content/baseline/baseline_maps.h"
#include "content/error.h"
#include "content/pack/pack_io.h"
#include "render/device.h"
#include "render/triangle_query.h"
#include "tools/probewalk/bench/bench_files.h"
#include "tools/probewalk/bench/equal_error.h"
#include "tools/probewalk/bench/figures.h"
#include "tools/probewalk/bench/page_text.h"
#include "tools/probewalk/bench/scene_bench.h"
#include "tools/probewalk/bench/triangle_cost.h"
#include "tools/probewalk/commands.h"

namespace probewalk {
namespace {

namespace fs = std::filesystem;
using bench::BenchOptions;
using bench::BenchRow;
using bench::BenchSummary;

constexpr int kMaxSide_px = 4096;

struct BenchArguments {
  BenchOptions options;
  std::string size = "160x120", picture_size = "480x360";
  bool no_pictures = false, no_variants = false;
};

void parse_size(const std::string& option, const std::string& text, int& width_px, int& height_px) {
  char rest = 0;
  if (std::sscanf(text.c_str(), "%5dx%5d%c", &width_px, &height_px, &rest) != 2 || width_px < 8 || height_px < 8 ||
      width_px > kMaxSide_px || height_px > kMaxSide_px) {
    throw BadUsage(fmt::format("{} {}: write WxH in pixels of a view, such as 160x120, from 8 to {} a side", option, text, kMaxSide_px));
  }
}

void check_usage(BenchArguments& arguments) {
  BenchOptions& options = arguments.options;
  parse_size("--size", arguments.size, options.width_px, options.height_px);
  parse_size("--picture-size", arguments.picture_size, options.picture_width_px, options.picture_height_px);
  options.pictures = !arguments.no_pictures;
  options.variants = !arguments.no_variants;
  const std::vector<std::string> known = bench::all_method_names();
  for (const std::string& method : options.methods) {
    if (std::find(known.begin(), known.end(), method) == known.end()) {
      throw BadUsage(fmt::format("--methods {}: there is no such method; there are {}", method, fmt::join(known, ", ")));
    }
  }
  for (const int size : options.map_resolutions) {
    if (size < kLeastBaselineSide || size > kGreatestBaselineSide || !std::has_single_bit(static_cast<unsigned>(size))) {
      throw BadUsage(fmt::format("--map-resolutions {}: write powers of two from {} to {}", size, kLeastBaselineSide,
                                 kGreatestBaselineSide));
    }
  }
  const std::size_t scenes = options.scenes.size();
  if (options.packs.empty() && !options.figures && !options.triangles) {
    throw BadUsage("name a pack to measure, or ask for --figures or --triangles, which need none");
  }
  if (scenes > 1 && scenes != options.packs.size()) {
    throw BadUsage(fmt::format("--scene: {} scenes for {} packs; give one for all, or one a pack in the same order", scenes,
                               options.packs.size()));
  }
  if (!options.poses.empty() && options.packs.size() > 1) {
    throw BadUsage("--poses: views are places in one scene; measure one pack at a time with it");
  }
  if (scenes == 0 && !options.methods.empty() && std::all_of(options.methods.begin(), options.methods.end(), bench::needs_maps)) {
    throw BadUsage(fmt::format("--methods {}: these need maps made from the scene; name it with --scene FILE",
                               fmt::join(options.methods, ",")));
  }
}

// Names of the packs' folders without .probes; twice the same name gets a number.
std::vector<std::string> names_of(const std::vector<fs::path>& packs) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const fs::path& pack : packs) {
    fs::path folder = fs::absolute(pack).lexically_normal();
    if (!folder.has_filename()) folder = folder.parent_path();
    const std::string stem = folder.extension() == ".probes" ? folder.stem().string() : folder.filename().string();
    std::string name = stem;
    for (int k = 2; !taken.insert(name).second; ++k) name = fmt::format("{}-{}", stem, k);
    names.push_back(name);
  }
  return names;
}

void make_folders(const BenchOptions& options) {
  std::error_code error;
  fs::create_directories(options.pictures ? options.output / "pictures" : options.output, error);
  if (error) {
    throw BadInput(fmt::format("cannot make the directory {}: {}; choose another", options.output.string(), error.message()));
  }
}

void print_table(const BenchSummary& summary) {
  fmt::print("{:<14} {:<22} {:<22} {:>15} {:>9} {:>9} {:>9} {:>9} {:>8}\n", "scene", "method", "settings", "ns a ray", "look-ups",
             "p50", "wrong", "hole", "FLIP");
  for (const BenchRow& row : bench::rows_of(summary)) {
    fmt::print("{:<14} {:<22} {:<22} {:>15} {:>9.1f} {:>9} {:>9} {:>9} {:>8}\n", row.scene, row.method, row.settings,
               bench::time_text(row), row.lookups_mean, bench::error_text(row.hit_error_p50),
               bench::share_text(row.wrong_surface_fraction), bench::share_text(row.hole_fraction),
               bench::number_text(row.flip_mean, 4));
  }
  for (const bench::SceneReport& scene : summary.scenes) {
    for (const bench::EyesRow& row : scene.eyes) {
      fmt::print("{}: two eyes, {}: second / first {:.2f} ± {:.2f} in time, {:.1f} / {:.1f} look-ups, holes {} / {}; both "
                 "{:.2f} ± {:.2f} of the time without sharing, {} identical\n",
                 row.scene, row.settings, row.second_over_first, row.second_over_first_spread / 2.0,
                 row.second.lookups_mean, row.first.lookups_mean, bench::share_text(row.second.hole_fraction),
                 bench::share_text(row.first.hole_fraction), row.time_ratio, row.time_ratio_spread / 2.0,
                 bench::share_text(row.identity.identical_fraction));
    }
    for (const bench::Goal& goal : bench::goals_of(scene)) {
      const char* verdict = goal.verdict == bench::Verdict::kReached ? "reached" :
                            goal.verdict == bench::Verdict::kNotReached ? "not reached" : "not measured";
      fmt::print("{}: {}: {} ({})\n", goal.scene, goal.aim, verdict, goal.result);
    }
  }
}

void run_bench(BenchArguments& arguments, const CommonOptions& common) {
  check_usage(arguments);
  BenchSummary summary;
  summary.options = arguments.options;
  summary.options.threads = common.threads;
  summary.options.command = own_command_line();
  const BenchOptions& options = summary.options;
  for (const fs::path& pack : options.packs) Pack::open(pack);  // what cannot be read is told before hours of work
  const std::unique_ptr<Progress> progress = make_progress(common);
  const Device device({}, {.device = common.device});
  summary.device = {device.info().name, device.info().driver, device.info().api_version, device.info().is_software};
  summary.build = read_build_info();
  summary.started_utc = utc_now();
  make_folders(options);
  const std::vector<std::string> names = names_of(options.packs);
  for (std::size_t k = 0; k < options.packs.size(); ++k) {
    std::optional<fs::path> scene;
    if (!options.scenes.empty()) scene = options.scenes[options.scenes.size() == 1 ? 0 : k];
    summary.scenes.push_back(bench::bench_scene(device, options, options.packs[k], scene, names[k], *progress));
    bench::write_bench_files(summary);  // after every pack: what is done stays
  }
  if (options.triangles) {
    const Device querying(with_ray_query(), {.device = common.device});
    bench::TriangleCostOptions cost;
    cost.folder = options.output / "triangles";
    summary.triangles = bench::measure_triangle_cost(querying, cost, *progress);
    bench::write_bench_files(summary);
  }
  if (options.figures) {
    bench::write_figures(options.output / "figures", {}, *progress);
    summary.has_figures = true;
    bench::write_bench_files(summary);
  }
  if (common.json) {
    std::fputs(bench::rows_json(bench::rows_of(summary)).c_str(), stdout);
  } else {
    print_table(summary);
    if (!common.quiet) std::fprintf(stderr, "page: %s\n", (options.output / "index.html").c_str());
  }
}

}  // namespace

void add_bench_command(CLI::App& app, CommonOptions& common) {
  CLI::App* command = app.add_subcommand("bench", "Speed against error: every method and setting over the same views");
  command->footer(
      "DIR gets index.html (plots, tables, the worst views), results.json and results.csv, a row for each method with each\n"
      "of its settings in each scene, and eyes.json and eyes.csv: what the second of two eyes costs over the first. --scene names what the pack was baked from: without it there is nothing to measure\n"
      "errors against, and the methods that need maps of the scene (all but oat, oat-flat and environment) are left out.\n"
      "Those maps are kept in --cache from one run to the next. With --triangles and --figures alone no pack is needed.\n\n"
      "Times are the device's own, of all methods side by side in one run: compare rows of one run, not of two. The product\n"
      "with its defaults is the row whose settings are `default`. Errors are kept apart: the tracer's (against the same\n"
      "probes in double precision), the data's (against the triangles), the picture's (FLIP and PSNR).\n\n"
      "  probewalk bench house.probes -o bench --scene house.glb\n"
      "  probewalk bench house.probes -o bench --scene house.glb --methods oat,two-level --map-resolutions 512,1024,2048\n"
      "  probewalk bench a.probes b.probes -o bench --scene a.glb --scene b.glb --json > rows.json");
  auto arguments = std::make_shared<BenchArguments>();
  BenchOptions& options = arguments->options;
  command->add_option("PACK", options.packs, "The packs (folders NAME.probes)");
  command->add_option("-o,--output", options.output, "Directory for the page and the results")->required();
  command->add_option("--scene", options.scenes, "What the packs were baked from: one for all, or one a pack in the same order")
      ->take_all()->allow_extra_args(false);
  command->add_option("--methods", options.methods, fmt::format("Comma-separated, of {} (default: all)", fmt::join(bench::all_method_names(), ", ")))
      ->delimiter(',')->allow_extra_args(false);
  command->add_option("--map-resolutions", options.map_resolutions,
                      "Texels a side of the maps that baselines march through (default: the pack's own and its double)")
      ->delimiter(',')->allow_extra_args(false);
  command->add_option("--cache", options.cache, "Where those maps are kept (default: the user's cache folder)");
  command->add_option("--views", options.views, "Eyes along the tour")->check(CLI::Range(1, 1000))->capture_default_str();
  command->add_option("--poses", options.poses, "File with an eye a line instead: NAME x,y,z,yaw,pitch");
  command->add_option("--size", arguments->size, "Rays of a view for times and hit errors, WxH")->capture_default_str();
  command->add_option("--fov", options.fov_deg, "Their vertical field of view in degrees")->check(CLI::Range(1.0, 170.0))->capture_default_str();
  command->add_option("--picture-size", arguments->picture_size, "Pixels of the pictures that are compared, WxH")->capture_default_str();
  command->add_option("--pixels-per-degree", options.pixels_per_degree, "How dense those pictures are, as in a headset")
      ->check(CLI::Range(1.0, 200.0))->capture_default_str();
  command->add_flag("--no-pictures", arguments->no_pictures, "Leave pictures, FLIP and PSNR out: saves building the scene's light");
  command->add_flag("--no-variants", arguments->no_variants, "Leave oat's other settings and the accelerations out");
  command->add_flag("--triangles", options.triangles,
                    "Also the same room in 1e3, 1e5 and 1e6 triangles: oat beside Embree and the device's ray query");
  command->add_flag("--figures", options.figures,
                    "Also the figures: regions of probe ordering, and look-ups against the thesis's predictions");
  command->add_option("--repeats", options.repeats, "Timed repetitions after the warm-up")->check(CLI::Range(1, 1000))->capture_default_str();
  add_common_options(*command, common);
  command->callback([arguments, &common] { run_bench(*arguments, common); });
}

}  // namespace probewalk
