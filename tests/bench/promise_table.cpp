// Error promised against error measured, beside uniform grids: by hand, not run by ctest.
//   promise_table [--plans-only] [--grids N] SCENE [TARGET...]
// For each target the bake is planned and measured on views that the planner has not seen. Then grids of many numbers
// of probes and sizes are measured on the same views: the smallest of no greater error, and the best of no more bytes.
// Not tried are grids of more than N times the bytes of the largest plan (8), of less than an eighth of the probes that
// the smallest has, and maps more than twice as fine as the finest plan's. Prints a line a target, and a line of grids;
// what grids were found so far on stderr.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "content/bake/bake_job.h"
#include "content/bake/map_store.h"
#include "content/bake/placement/head_space.h"
#include "content/bake/plan/planned_maps.h"
#include "content/bake/plan/planner.h"
#include "content/probe/host_address.h"
#include "content/probe/probe_set.h"
#include "content/scene/scene.h"

namespace probewalk::bench {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kJudges = 40;  // number of the set of views that judge both
constexpr double kMiB = 1 << 20;

struct Measured {
  std::string what;
  RoomError error;
  std::uint64_t bytes = 0;
  double seconds = 0.0;
  std::size_t probes = 0;
  int finest = 0;  // texels a side of its finest map
};

// The grids that come nearest to a plan: the smallest of no greater error, and the best of no more bytes.
struct Rivals {
  std::optional<Measured> equal_error, equal_bytes;
  bool may_want(std::uint64_t bytes, const Measured& plan) const {
    return bytes <= plan.bytes || !equal_error || bytes < equal_error->bytes;
  }
  void consider(const Measured& grid, const Measured& plan) {
    if (grid.error.worst() <= plan.error.worst() && (!equal_error || grid.bytes < equal_error->bytes))
      equal_error = grid;
    if (grid.bytes <= plan.bytes && (!equal_bytes || grid.error.worst() < equal_bytes->error.worst()))
      equal_bytes = grid;
  }
};

std::string text_of(const Measured& measured) {
  return fmt::format("FLIP {:.4f}, lost {:.2f} %, {:.2f} MiB, {:.1f} s ({})", measured.error.flip,
                     100.0 * measured.error.lost(), double(measured.bytes) / kMiB, measured.seconds, measured.what);
}

std::string text_of(const Rivals& rivals, const Measured& plan) {
  const auto& [equal_error, equal_bytes] = rivals;
  return fmt::format(
      "grid of equal error: {}; of equal bytes: {}",
      equal_error ? fmt::format("{}: bytes x {:.2f}, its bake alone x {:.2f} of the plan's time", text_of(*equal_error),
                                double(equal_error->bytes) / double(plan.bytes), equal_error->seconds / plan.seconds)
                  : std::string("none of those tried"),
      equal_bytes
          ? fmt::format("{}: error x {:.2f}", text_of(*equal_bytes), equal_bytes->error.worst() / plan.error.worst())
          : std::string("none is as small"));
}

class Table {
 public:
  explicit Table(const fs::path& file, fs::path folder)
      : scene_(load_scene(file)),
        rays_(scene_),
        space_(find_space(scene_, rays_, {}, progress_)),
        heads_(scene_, rays_, space_),
        light_(scene_, rays_, light_options(), progress_),
        folder_(std::move(folder)) {
    std::vector<Pose> tour = space_.tour;
    if (tour.empty()) tour.push_back(space_.start);
    exposure_ = choose_exposure(light_, tour);
    const int each = int(std::clamp<std::size_t>(1600 / space_.rooms.size(), 60, 300));
    views_ = sample_views(space_, heads_, rays_, light_, {each * 10, each}, kJudges, progress_);
  }

  Measured plan(double target) {
    const BakeState state(folder_ / fmt::format("plan-{}", target), "promise-table");
    MapStore store(rays_, light_, exposure_.radiance_scale, state, SpaceCells::around(scene_.bounds));
    PlanTarget wanted;
    wanted.error = target;
    const Plan plan = plan_bake(space_, heads_, rays_, light_, exposure_, store, wanted, progress_);
    PlannedMaps maps(store, BakeOptions{}.samples);
    Measured measured;
    std::vector<ProbeRecord> records;
    std::size_t least = 4096, most = 0;
    for (const PlannedRoom& room : plan.rooms) {
      for (const glm::dvec3& position : room.probes_m) {
        records.push_back(maps.record(std::uint32_t(records.size()), position, room.size.geometry, room.size.radiance));
      }
      measured.bytes += room.bytes_disk;
      if (room.probes_m.empty()) continue;
      least = std::min(least, std::size_t(std::min(room.size.geometry, room.size.radiance)));
      most = std::max(most, std::size_t(std::max(room.size.geometry, room.size.radiance)));
    }
    measured.what =
        fmt::format("{} probes, {}..{}, {}", records.size(), least, most, plan.kept ? "said kept" : "said NOT kept");
    measured.error = measure(plan.grid, records);
    measured.seconds = plan.seconds;
    measured.probes = records.size();
    measured.finest = int(most);
    state.remove();
    return measured;
  }

  // Compares grids with the plans, each with every pair of sizes that is not too large; the plans are in any order.
  std::vector<Rivals> rivals(const std::vector<Measured>& plans, double most_plans) {
    std::vector<Rivals> found(plans.size());
    std::uint64_t most_bytes = 0;
    for (const Measured& plan : plans)
      most_bytes = std::max(most_bytes, std::uint64_t(most_plans * double(plan.bytes)));
    std::size_t before = 0, least = plans.front().probes;
    int finest = 0;
    for (const Measured& plan : plans) least = std::min(least, plan.probes), finest = std::max(finest, plan.finest);
    for (const int probes : {1, 2, 4, 8, 16, 32, 64, 128}) {
      if (std::size_t(probes) < least / 8) continue;
      PlacementOptions options;
      options.max_probes = probes;
      const Placement placement = place_probes(scene_, rays_, space_, options);
      if (placement.sites.size() == before) continue;
      before = placement.sites.size();
      const BakeState state(folder_ / "grids", "promise-table");
      MapStore store(rays_, light_, exposure_.radiance_scale, state, SpaceCells::around(scene_.bounds));
      PlannedMaps maps(store, BakeOptions{}.samples);
      const std::vector<Layer> geometry = layers(placement, maps, store, false, most_bytes, 2 * finest),
                               radiance = layers(placement, maps, store, true, most_bytes, 2 * finest);
      for (const Layer& near : geometry) {
        for (const Layer& light : radiance) {
          Measured measured;
          measured.bytes = near.bytes + light.bytes;
          measured.seconds = near.seconds + light.seconds;
          bool is_wanted = false;
          for (std::size_t k = 0; k < plans.size(); ++k) is_wanted |= found[k].may_want(measured.bytes, plans[k]);
          if (!is_wanted || measured.bytes > most_bytes) continue;
          std::vector<ProbeRecord> records;
          for (std::uint32_t k = 0; k < placement.sites.size(); ++k) {
            records.push_back(maps.record(k, placement.sites[k].position_m, near.side, light.side));
          }
          measured.what = fmt::format("{} probes, {} and {}", records.size(), near.side, light.side);
          measured.error = measure(placement.grid, records);
          for (std::size_t k = 0; k < plans.size(); ++k) found[k].consider(measured, plans[k]);
        }
      }
      state.remove();
      for (std::size_t k = 0; k < plans.size(); ++k) {
        fmt::print(stderr, "up to {} probes: {}\n", before, text_of(found[k], plans[k]));
      }
    }
    return found;
  }

 private:
  static constexpr int kSides[] = {64, 128, 256, 512, 1024};
  // One of the two maps of all probes of a grid.
  struct Layer {
    int side = 0;
    std::uint64_t bytes = 0;
    double seconds = 0.0;
  };

  // Baked with ever more texels until they are too large.
  static std::vector<Layer> layers(const Placement& placement, PlannedMaps& maps, const MapStore& store, bool is_light,
                                   std::uint64_t most_bytes, int most_side) {
    std::vector<Layer> all;
    for (const int side : kSides) {
      if (side > most_side && !all.empty()) break;
      if (!all.empty() && 3 * all.back().bytes > most_bytes) break;  // four times the texels
      Layer layer{side};
      const double start_s = store.baking_seconds();
      for (std::uint32_t k = 0; k < placement.sites.size(); ++k) {
        const glm::dvec3 position = placement.sites[k].position_m;
        layer.bytes +=
            is_light ? maps.radiance(k, position, side).bytes_disk : maps.geometry(k, position, side).bytes_disk;
      }
      layer.seconds = store.baking_seconds() - start_s;
      all.push_back(layer);
    }
    return all;
  }

  static LightOptions light_options() {
    LightOptions options;
    options.samples = 32;
    options.bounces = 2;
    return options;
  }

  RoomError measure(const ProbeGrid& grid, const std::vector<ProbeRecord>& records) const {
    ProbeView view{grid_constants(grid, records.size()), default_dials(double(exposure_.radiance_scale))};
    view.grid.table_address = host_address(grid.probe.data());
    view.grid.probes_address = host_address(records.data());
    return mean_error(measure_error(views_, view, rays_, float(exposure_.exposure_ev), space_.rooms.size()),
                      views_.room_share);
  }

  SilentProgress progress_;
  const Scene scene_;
  const RayScene rays_;
  const Space space_;
  const HeadSpace heads_;
  const LightField light_;
  const fs::path folder_;
  Exposure exposure_;
  WalkerViews views_;
};

// most_plans: bytes of a grid, in plans; 0: no grids.
void run(const fs::path& file, const std::vector<double>& targets, double most_plans) {
  const fs::path folder = fs::temp_directory_path() / fmt::format("promise-table-{}", file.stem().string());
  fs::create_directories(folder);
  Table table(file, folder);
  std::vector<Measured> plans;
  for (const double target : targets) {
    plans.push_back(table.plan(target));
    fmt::print("{} promised {:.3g}: {}; {}\n", file.stem().string(), target, text_of(plans.back()),
               plans.back().error.worst() <= target ? "held" : "did NOT hold");
    std::fflush(stdout);
  }
  const std::vector<Rivals> rivals = most_plans > 0.0 ? table.rivals(plans, most_plans) : std::vector<Rivals>();
  for (std::size_t k = 0; k < rivals.size(); ++k) {
    fmt::print("{} {:.3g}: {}\n", file.stem().string(), targets[k], text_of(rivals[k], plans[k]));
  }
  fs::remove_all(folder);
}

}  // namespace
}  // namespace probewalk::bench

int main(int argc, char** argv) {
  double most_plans = 8.0;
  try {
    for (; argc > 2; --argc, ++argv) {
      if (std::string(argv[1]) == "--plans-only") {
        most_plans = 0.0;
      } else if (std::string(argv[1]) == "--grids") {
        most_plans = std::stod(argv[2]);
        --argc, ++argv;
      } else {
        break;
      }
    }
    if (argc < 2) {
      std::fputs("promise_table [--plans-only] [--grids N] SCENE [TARGET...]\n", stderr);
      return 2;
    }
    std::vector<double> targets;
    for (int k = 2; k < argc; ++k) targets.push_back(std::stod(argv[k]));
    if (targets.empty()) targets = {0.15, 0.1, 0.07, 0.05};
    probewalk::bench::run(argv[1], targets, most_plans);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "promise_table: %s\n", error.what());
    return 1;
  }
}
