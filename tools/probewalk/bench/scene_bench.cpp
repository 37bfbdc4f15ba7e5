#include "tools/probewalk/bench/scene_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <set>

#include "content/cache_folder.h"
#include "content/baseline/baseline_cache.h"
#include "content/error.h"
#include "content/scene/embree_query.h"
#include "tools/probewalk/bench/eyes_bench.h"
#include "tools/probewalk/bench/ground_truth.h"
#include "tools/probewalk/bench/pack_levels.h"
#include "tools/probewalk/bench/probe_contender.h"
#include "tools/probewalk/bench/statistics.h"
#include "tools/probewalk/bench/timing.h"

namespace probewalk::bench {
namespace {

namespace fs = std::filesystem;

// Settings that are measured together, beside the yardstick: all of one level. A method with maps is a group of its own,
// since maps are large.
struct Group {
  std::size_t level = 0;
  int maps = 0;
  std::vector<Setting> settings;
};

std::vector<Group> groups_of(const std::vector<Setting>& settings) {
  std::vector<Group> groups;
  for (const Setting& setting : settings) {
    const auto same = [&](const Group& g) { return g.level == setting.level && g.maps == 0 && setting.maps == 0; };
    auto at = std::find_if(groups.begin(), groups.end(), same);
    if (at == groups.end()) at = groups.insert(groups.end(), Group{setting.level, setting.maps, {}});
    at->settings.push_back(setting);
  }
  return groups;
}

class SceneBench {
 public:
  SceneBench(const Device& device, const BenchOptions& options, const fs::path& pack,
             const std::optional<fs::path>& scene, const std::string& name, Progress& progress);
  SceneReport run();

 private:
  struct Measured {
    BenchRow row;
    std::vector<BatchAnswer> answers;  // kept where an acceleration may be told from them
    Timing timing;
  };

  SettingsRequest request() const;
  const BaselineMaps* maps_of(int size);
  void run_group(const Group& group, const PackLevel& level);
  void measure_errors(BenchRow& row, const Setting& setting, const PackLevel& level, const std::vector<BatchAnswer>& answers) const;
  void measure_pictures(BenchRow& row, Contender& contender);
  void tell_accelerations();
  void time_triangles();
  void check() const {
    if (progress_.cancelled()) throw Interrupted("interrupted; of this pack nothing was written");
  }

  const Device& device_;
  const BenchOptions& options_;
  Progress& progress_;
  const Pack pack_;
  const TraceConstants dials_;
  const std::vector<int> sizes_;
  const std::vector<NamedPose> poses_;
  const ViewRays rays_, picture_rays_;
  std::unique_ptr<GroundTruth> truth_;
  std::vector<float> truth_m_;
  std::vector<ImageRgb8> reference_;
  std::vector<Measured> measured_;
  std::unique_ptr<PackLevel> finest_;
  BaselineMaps maps_;  // the size last asked for
  std::set<std::string> pictured_;  // methods whose worst view has been kept
  SceneReport report_;
};

RaySize picture_size(const BenchOptions& options) {
  return {options.picture_width_px, options.picture_height_px, fov_at_density(options.picture_height_px, options.pixels_per_degree)};
}

SceneBench::SceneBench(const Device& device, const BenchOptions& options, const fs::path& pack,
                       const std::optional<fs::path>& scene, const std::string& name, Progress& progress)
    : device_(device),
      options_(options),
      progress_(progress),
      pack_(Pack::open(pack)),
      dials_(default_dials(pack_.manifest().radiance_scale)),
      sizes_(level_sizes(pack_.manifest())),
      poses_(bench_poses(pack_.manifest(), options)),
      rays_(rays_of(poses_, {options.width_px, options.height_px, glm::radians(options.fov_deg)})),
      picture_rays_(rays_of(poses_, picture_size(options))) {
  const Manifest& manifest = pack_.manifest();
  report_.name = name;
  report_.pack = pack.string();
  report_.scene_name = manifest.scene_name;
  report_.credits = manifest.credits;
  report_.rooms = manifest.rooms.size();
  report_.probes = manifest.probe_positions_m.size();
  report_.resolution = sizes_.back();
  if (scene) {
    report_.scene = scene->string();
    truth_ = std::make_unique<GroundTruth>(*scene, pack_, options.pictures, options.threads, progress);
    report_.triangles = truth_->scene().triangles.size();
    report_.has_truth = true;
    truth_m_ = truth_->distances_m(rays_);
    if (options.pictures) {
      reference_ = truth_->pictures(picture_rays_, static_cast<float>(manifest.exposure_ev));
      report_.has_pictures = true;
    } else {
      report_.missing.push_back("Pictures were not asked for: there is no FLIP, no PSNR and no difference picture.");
    }
  } else {
    report_.missing.push_back(
        "No scene was named (--scene): there are no triangles, so hit errors, wrong surfaces and picture errors are missing, "
        "and so are all methods that need maps made from the scene. Look-ups, times, holes and the tracer's own error are there.");
  }
}

SettingsRequest SceneBench::request() const {
  SettingsRequest request;
  request.level_sizes = sizes_;
  request.methods = options_.methods.empty() ? all_method_names() : options_.methods;
  request.map_sizes = options_.map_resolutions;
  if (request.map_sizes.empty()) request.map_sizes = {sizes_.back(), std::min(2 * sizes_.back(), kGreatestBaselineSide)};
  request.maps_possible = truth_ != nullptr;
  request.variants = options_.variants;
  return request;
}

void SceneBench::measure_errors(BenchRow& row, const Setting& setting, const PackLevel& level,
                                const std::vector<BatchAnswer>& answers) const {
  fill_counts(row, answers);
  if (!truth_m_.empty()) fill_hit_errors(row, answers, truth_m_);
  if (setting.choice.is_baseline()) return;
  const DoubleWalker walker(level.probes(), with_choice(dials_, setting.choice), setting.choice.rules);
  fill_tracer_errors(row, answers, walker.trace(rays_.rays), walker, rays_.rays);
}

void SceneBench::measure_pictures(BenchRow& row, Contender& contender) {
  if (reference_.empty()) return;
  const TraceRun run = contender.trace(picture_rays_);
  const PictureError error =
      picture_error(run.answers, picture_rays_, reference_, static_cast<float>(pack_.manifest().exposure_ev));
  row.flip_mean = error.flip_mean();
  row.psnr_db = error.psnr_db;
  row.pixels_per_degree = density_of(picture_rays_.size);
  row.worst_view = poses_[error.worst].name;
  // oat-flat's pictures are oat's own.
  if (row.method == "oat-flat" || !pictured_.insert(row.method).second) return;

  WorstPicture worst{row.method, row.settings, row.worst_view, error.flip[error.worst], {}, {}, {}};
  const fs::path folder = options_.output / "pictures";
  const auto write = [&](const std::string& what, const ImageRgb8& image) {
    const std::string file = fmt::format("{}-{}-{}.png", report_.name, row.method, what);
    write_png(folder / file, image);
    return "pictures/" + file;
  };
  worst.reference = write("triangles", reference_[error.worst]);
  worst.shown = write("probes", error.shown[error.worst]);
  worst.difference = write("difference", false_colour(error.maps[error.worst], picture_rays_.size.width_px,
                                                      picture_rays_.size.height_px, 1.0f));
  report_.pictures.push_back(worst);
}

// Null for none.
const BaselineMaps* SceneBench::maps_of(int size) {
  if (size == 0) return nullptr;
  if (maps_.n != size) {
    maps_ = {};  // the old ones make room first
    maps_ = cached_baseline_maps(truth_->scene(), pack_, size,
                                 options_.cache.empty() ? default_cache_folder() : options_.cache, progress_);
  }
  return &maps_;
}

void SceneBench::run_group(const Group& group, const PackLevel& level) {
  const BaselineMaps* maps = maps_of(group.maps);
  // The yardstick runs in every group; in its own it is the first setting anyway.
  const bool own = !group.settings.empty() && group.settings.front().settings == kDefaultSettings;
  std::vector<std::unique_ptr<Contender>> contenders;
  if (!own) contenders.push_back(make_probe_contender(device_, *finest_, nullptr, dials_, choice_of("oat")));
  const std::string stage = group.maps > 0 ? fmt::format("{}: {}, maps {}", report_.name, group.settings.front().method, group.maps)
                                           : fmt::format("{}: resolution {}", report_.name, sizes_[group.level]);
  progress_.begin(stage + ", errors", group.settings.size() * rays_.rays.size(), "rays");
  const std::size_t first = measured_.size();
  std::unique_ptr<PackLevel> otherwise;  // the same probes with samples as some settings ask for
  for (const Setting& setting : group.settings) {
    check();
    const bool as_is = setting.choice.samples == level.samples();
    if (!as_is && !otherwise) {
      otherwise = std::make_unique<PackLevel>(device_, pack_, group.level, setting.choice.samples);
    }
    contenders.push_back(make_probe_contender(device_, as_is ? level : *otherwise, maps, dials_, setting.choice));
    Contender& contender = *contenders.back();
    Measured measured;
    BenchRow& row = measured.row;
    row.scene = report_.name;
    row.method = setting.method;
    row.settings = setting.settings;
    row.device = device_.info().name;
    row.views = static_cast<int>(poses_.size());
    row.width = rays_.size.width_px;
    row.height = rays_.size.height_px;
    row.resolution = group.maps > 0 ? group.maps : sizes_[group.level];
    row.bytes_device = contender.bytes_device();
    measured.answers = contender.trace(rays_).answers;
    measure_errors(row, setting, level, measured.answers);
    measure_pictures(row, contender);
    if (group.maps > 0) measured.answers.clear();
    measured_.push_back(std::move(measured));
    progress_.advance(rays_.rays.size());
  }

  std::vector<Contender*> runners;
  for (const auto& contender : contenders) runners.push_back(contender.get());
  if (!own) runners.front()->trace(rays_);
  progress_.begin(stage + ", times", runners.size() * static_cast<std::size_t>(options_.repeats) * rays_.rays.size(), "rays");
  const std::vector<Timing> timings = time_side_by_side(runners, rays_, options_.repeats, progress_);
  for (std::size_t k = 0; k < group.settings.size(); ++k) {
    Measured& measured = measured_[first + k];
    measured.timing = timings[k + (own ? 0 : 1)];
    measured.row.ns_per_ray_median = median(measured.timing.ns_per_ray);
    measured.row.ns_per_ray_spread = spread(measured.timing.ns_per_ray);
    if (measured.timing.ratio.empty()) continue;
    measured.row.time_ratio = median(measured.timing.ratio);
    measured.row.time_ratio_spread = spread(measured.timing.ratio);
  }
}

void SceneBench::tell_accelerations() {
  const auto find = [&](const std::string& method, const std::string& settings) -> const Measured* {
    for (const Measured& m : measured_) {
      const bool at_finest = m.row.resolution == sizes_.back() && !m.answers.empty();
      if (at_finest && m.row.method == method && (settings.empty() || m.row.settings == settings)) return &m;
    }
    return nullptr;
  };
  for (const Acceleration& acceleration : accelerations()) {
    const Measured* without = find(acceleration.method_without, acceleration.settings_without);
    const Measured* with = find(acceleration.method_with, acceleration.settings_with);
    if (without == nullptr || with == nullptr) continue;
    AccelerationResult result{acceleration, without->row, with->row, 1.0, 0.0, identity_of(without->answers, with->answers)};
    std::vector<double> ratios;
    for (std::size_t k = 0; k < with->timing.ns_per_ray.size(); ++k) {
      ratios.push_back(with->timing.ns_per_ray[k] / std::max(without->timing.ns_per_ray[k], 1e-9));
    }
    result.time_ratio = median(ratios);
    result.time_ratio_spread = spread(ratios);
    report_.accelerations.push_back(result);
  }
}

void SceneBench::time_triangles() {
  const EmbreeQuery embree(truth_->scene());
  std::vector<TriangleRay> rays;
  for (const WorldRay& ray : rays_.rays) rays.push_back({glm::vec3(ray.origin_m), 0.0f, device_direction(ray), 0.0f});
  std::vector<float> t_m(rays.size());
  const auto product = make_probe_contender(device_, *finest_, nullptr, dials_, choice_of("oat"));
  const std::pair<const char*, RayWidth> ways[] = {{"one ray at a time", RayWidth::kOne}, {"sixteen at a time", RayWidth::kSixteen}};
  std::vector<double> ns[2], ratio[2];
  progress_.begin(report_.name + ": the triangles themselves, times", static_cast<std::uint64_t>(options_.repeats) + 1, "rounds");
  const double n = static_cast<double>(rays.size());
  for (int repeat = -1; repeat < options_.repeats; ++repeat) {  // the first warms up
    check();
    const double own_ns = static_cast<double>(product->trace(rays_).device_ns) / n;
    for (int k = 0; k < 2; ++k) {
      const double took_ns = static_cast<double>(embree.trace(ways[k].second, rays, t_m)) / n;
      if (repeat < 0) continue;
      ns[k].push_back(took_ns);
      ratio[k].push_back(took_ns / std::max(own_ns, 1e-9));
    }
    progress_.advance(1);
  }
  for (int k = 0; k < 2; ++k) report_.triangles_times.push_back({ways[k].first, median(ns[k]), spread(ns[k]), median(ratio[k])});
}

SceneReport SceneBench::run() {
  for (const Group& group : groups_of(settings_for(request()))) {
    check();
    if (!finest_) finest_ = std::make_unique<PackLevel>(device_, pack_, sizes_.size() - 1);
    if (group.level + 1 == sizes_.size()) {
      run_group(group, *finest_);
    } else {
      run_group(group, PackLevel(device_, pack_, group.level));
    }
  }
  tell_accelerations();
  report_.eyes = bench_eyes(device_, options_, *finest_, dials_, poses_, truth_.get(), report_.name, progress_);
  if (truth_) time_triangles();
  for (const Measured& measured : measured_) report_.rows.push_back(measured.row);
  return std::move(report_);
}

}  // namespace

SceneReport bench_scene(const Device& device, const BenchOptions& options, const fs::path& pack,
                        const std::optional<fs::path>& scene, const std::string& name, Progress& progress) {
  return SceneBench(device, options, pack, scene, name, progress).run();
}

}  // namespace probewalk::bench
