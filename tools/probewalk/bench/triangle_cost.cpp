#include "tools/probewalk/bench/triangle_cost.h"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>

#include "content/bake/bake_job.h"
#include "content/error.h"
#include "content/image/image.h"
#include "content/pack/pack_io.h"
#include "content/probe/probe_set.h"
#include "content/scene/embree_query.h"
#include "content/scene/procedural/procedural.h"
#include "content/scene/scene.h"
#include "render/probe_store.h"
#include "render/ray_batch.h"
#include "render/triangle_query.h"

namespace probewalk::bench {
namespace {

constexpr float kFov_rad = 1.3f;
constexpr float kAgreement = 0.02f;

// Eyes in the room and what they look at.
constexpr std::array<std::array<glm::dvec3, 2>, 4> kViews{
    {{glm::dvec3(-1.6, 1.6, 1.6), glm::dvec3(0.4, 0.7, -1.5)},
     {glm::dvec3(1.7, 1.5, 1.3), glm::dvec3(-2.4, 1.2, -0.3)},
     {glm::dvec3(-1.2, 1.2, -0.4), glm::dvec3(2.6, 1.5, 0.1)},
     {glm::dvec3(0.9, 1.0, 0.9), glm::dvec3(0.2, 0.5, 0.0)}}};

// The rays of all views, in tiles of 8 x 8 pixels, those in blocks of 4 x 4: sixteen rays in a row look
// alike.
std::vector<TriangleRay> make_rays(int width_px, int height_px) {
  std::vector<TriangleRay> rays;
  const double half = std::tan(0.5 * static_cast<double>(kFov_rad));
  for (const auto& [eye, target] : kViews) {
    const glm::dvec3 ahead = glm::normalize(target - eye),
                     right = glm::normalize(glm::cross(ahead, glm::dvec3(0, 1, 0)));
    const glm::dvec3 up = glm::cross(right, ahead);
    for (int tile_y = 0; tile_y < height_px; tile_y += 8) {
      for (int tile_x = 0; tile_x < width_px; tile_x += 8) {
        for (int k = 0; k < 64; ++k) {
          const int x = tile_x + (k >> 4 & 1) * 4 + (k & 3), y = tile_y + (k >> 5) * 4 + (k >> 2 & 3);
          if (x >= width_px || y >= height_px) continue;
          const double u = (2.0 * (x + 0.5) - width_px) / height_px * half,
                       v = (1.0 - 2.0 * (y + 0.5) / height_px) * half;
          rays.push_back({glm::vec3(eye), 0.0f, glm::vec3(glm::normalize(ahead + u * right + v * up)), 0.0f});
        }
      }
    }
  }
  return rays;
}

struct Contender {
  std::string name;
  std::function<std::int64_t(std::span<float>)> run;  // fills distances, returns ns
  double setup_s = 0.0, setup_mib = 0.0;
  std::vector<double> ns{}, cpu_ns{};  // by repeat
  std::vector<float> t_m{};            // of the last run
  double lookups_mean = 0.0;
};

// Processor time of this process, all threads together.
double cpu_now_ns() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e9 * static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec);
}

// One room with everything that its contenders need.
class Room {
 public:
  Room(const std::string& name, const Device& device, const TriangleCostOptions& options,
       std::span<const TriangleRay> rays, Progress& progress)
      : name_(name), rays_(rays), file_(options.folder / (name + ".glb")) {
    if (!std::filesystem::exists(file_)) {
      progress.note(fmt::format("making {}", file_.string()));
      const std::vector<std::byte> bytes = make_procedural_glb(name);
      write_file_atomically(file_, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    }
    add_tracer(device, options, progress);
    scene_ = load_scene(file_);
    add_triangles(device, progress);
  }
  Room(const Room&) = delete;
  Room& operator=(const Room&) = delete;

  const std::string& name() const { return name_; }
  std::size_t triangles() const { return scene_.triangles.size(); }
  std::vector<Contender>& contenders() { return contenders_; }

 private:
  void add_tracer(const Device& device, const TriangleCostOptions& options, Progress& progress) {
    BakeOptions bake_options;
    bake_options.scene_file = file_;
    bake_options.pack = options.folder / (name_ + ".probes");
    bake_options.resolution = options.resolution;
    bake_options.radiance_resolution = 64;
    bake_options.coarse_resolution = std::min(128, options.resolution);
    bake_options.placement.max_probes = options.max_probes;
    // Times do not depend on what colour a probe shows: as little light as a bake takes.
    bake_options.light.samples = 16;
    bake_options.light.bounces = 1;
    Contender oat{.name = "oat", .run = {}};
    if (!std::filesystem::exists(bake_options.pack)) oat.setup_s = bake(bake_options, progress).seconds;
    const Pack pack = Pack::open(bake_options.pack);
    const ProbeSet probes = ProbeSet::read(pack);
    store_ = std::make_unique<ProbeStore>(device, pack.manifest().grid,
                                          static_cast<std::uint32_t>(probes.probes().size()));
    store_->upload({0, 0, 0, probes.probes()});
    store_->settle();
    oat.setup_mib = static_cast<double>(store_->device_bytes()) / 1048576.0;
    batch_ = std::make_unique<RayBatch>(device);
    for (const TriangleRay& ray : rays_)
      world_rays_.push_back({glm::dvec3(ray.origin_m), glm::dvec3(ray.unit_direction)});
    const TraceConstants dials = default_dials(pack.manifest().radiance_scale);
    const float spread_rad = kFov_rad / static_cast<float>(options.height_px);
    oat.run = [this, dials, spread_rad](std::span<float> t_m) {
      const TracedRays traced = batch_->trace_timed(*store_, dials, world_rays_, spread_rad);
      const std::vector<BatchAnswer>& answers = traced.answers;
      double lookups = 0.0;
      for (std::size_t i = 0; i < answers.size(); ++i) {
        t_m[i] = answers[i].t_m;
        lookups += answers[i].lookups;
      }
      contenders_.front().lookups_mean = lookups / static_cast<double>(answers.size());
      return traced.device_ns;
    };
    contenders_.push_back(std::move(oat));
  }

  void add_triangles(const Device& device, Progress& progress) {
    if (has_ray_query(device)) {
      progress.note(fmt::format("{}: building the device's acceleration structure", name_));
      query_ = std::make_unique<TriangleQuery>(device, scene_);
      contenders_.push_back({"ray-query", [this](std::span<float> t_m) { return query_->trace(rays_, t_m); },
                             1e-9 * static_cast<double>(query_->build_ns()),
                             static_cast<double>(query_->structure_bytes()) / 1048576.0});
    }
    progress.note(fmt::format("{}: building Embree's hierarchy", name_));
    embree_ = std::make_unique<EmbreeQuery>(scene_);
    for (const auto& [name, width] :
         {std::pair{"embree-1", RayWidth::kOne}, std::pair{"embree-16", RayWidth::kSixteen}}) {
      contenders_.push_back(
          {name, [this, width](std::span<float> t_m) { return embree_->trace(width, rays_, t_m); },
           1e-9 * static_cast<double>(embree_->build_ns()), 0.0});
    }
  }

  std::string name_;
  std::span<const TriangleRay> rays_;
  std::filesystem::path file_;
  Scene scene_;
  std::vector<WorldRay> world_rays_;
  std::unique_ptr<ProbeStore> store_;
  std::unique_ptr<RayBatch> batch_;
  std::unique_ptr<TriangleQuery> query_;
  std::unique_ptr<EmbreeQuery> embree_;
  std::vector<Contender> contenders_;
};

double quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  const double place = q * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
}

// Of the quotients repeat by repeat.
double median_ratio(const std::vector<double>& values, const std::vector<double>& to) {
  std::vector<double> ratios;
  for (std::size_t r = 0; r < values.size(); ++r) ratios.push_back(values[r] / to[r]);
  return quantile(ratios, 0.5);
}

double agreement(const std::vector<float>& t_m, const std::vector<float>& expected_m) {
  std::size_t same = 0;
  for (std::size_t i = 0; i < t_m.size(); ++i)
    same += std::abs(t_m[i] - expected_m[i]) <= kAgreement * expected_m[i];
  return static_cast<double>(same) / static_cast<double>(t_m.size());
}

std::vector<TriangleCostRow> rows_of(std::vector<std::unique_ptr<Room>>& rooms, std::size_t rays) {
  std::vector<TriangleCostRow> rows;
  for (const std::unique_ptr<Room>& room : rooms) {
    const std::vector<Contender>& smallest = rooms.front()->contenders();
    const std::vector<Contender>& all = room->contenders();
    const auto truth =
        std::find_if(all.begin(), all.end(), [](const Contender& c) { return c.name == "embree-1"; });
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double per_ray = 1.0 / static_cast<double>(rays);
      TriangleCostRow row;
      row.room = room->name(), row.contender = all[i].name;
      row.triangles = room->triangles(), row.rays = rays;
      row.ns_per_ray_median = quantile(all[i].ns, 0.5) * per_ray;
      row.ns_per_ray_spread = (quantile(all[i].ns, 0.75) - quantile(all[i].ns, 0.25)) * per_ray;
      row.ratio_to_smallest = median_ratio(all[i].ns, smallest[i].ns);
      row.cpu_ns_per_ray_median = quantile(all[i].cpu_ns, 0.5) * per_ray;
      row.cpu_ratio_to_smallest = median_ratio(all[i].cpu_ns, smallest[i].cpu_ns);
      row.lookups_mean = all[i].lookups_mean;
      row.agreement_fraction = agreement(all[i].t_m, truth->t_m);
      row.setup_s = all[i].setup_s, row.setup_mib = all[i].setup_mib;
      rows.push_back(row);
    }
  }
  return rows;
}

}  // namespace

std::vector<TriangleCostRow> measure_triangle_cost(const Device& device, const TriangleCostOptions& options,
                                                   Progress& progress) {
  if (options.rooms.empty() || options.repeats < 1 || options.width_px < 1 || options.height_px < 1) {
    throw BadUsage("the cost against triangles takes at least one room, one repeat and one pixel");
  }
  std::filesystem::create_directories(options.folder);
  const std::vector<TriangleRay> rays = make_rays(options.width_px, options.height_px);
  if (!has_ray_query(device)) {
    progress.note(fmt::format("{} has no ray query (VK_KHR_ray_query): it is left out", device.info().name));
  }
  std::vector<std::unique_ptr<Room>> rooms;
  for (const std::string& name : options.rooms) {
    rooms.push_back(std::make_unique<Room>(name, device, options, rays, progress));
    if (progress.cancelled()) throw Interrupted("interrupted; the rooms and packs made so far are kept");
  }
  progress.begin("cost against triangles", static_cast<std::uint64_t>(options.repeats) * rooms.size(),
                 "rounds");
  for (int repeat = -1; repeat < options.repeats; ++repeat) {  // the first round warms up and does not count
    for (const std::unique_ptr<Room>& room : rooms) {
      for (Contender& contender : room->contenders()) {
        contender.t_m.resize(rays.size());
        const double cpu_begin_ns = cpu_now_ns();
        const std::int64_t ns = contender.run(contender.t_m);
        const double cpu_ns = cpu_now_ns() - cpu_begin_ns;
        if (repeat >= 0) {
          contender.ns.push_back(static_cast<double>(ns));
          contender.cpu_ns.push_back(cpu_ns);
        }
        if (progress.cancelled()) throw Interrupted("interrupted; the rooms and packs made so far are kept");
      }
      if (repeat >= 0) progress.advance(1);
    }
  }
  return rows_of(rooms, rays.size());
}

}  // namespace probewalk::bench
