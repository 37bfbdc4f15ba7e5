// What a ray costs against how many triangles the room has; see tools/probewalk/bench/triangle_cost.h.
//   triangle_cost_table FOLDER [REPEATS [ROOM...]]
// Keeps rooms and packs in FOLDER. Prints one line for each room and contender.
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <string>

#include "render/triangle_query.h"
#include "tools/probewalk/bench/triangle_cost.h"

namespace probewalk::bench {
namespace {

class Notes final : public Progress {
 public:
  void begin(std::string_view stage, std::uint64_t, std::string_view) override { note(stage); }
  void advance(std::uint64_t) override {}
  void note(std::string_view line) override { fmt::print(stderr, "{}\n", line); }
};

void run(const TriangleCostOptions& options) {
  const Device device(with_ray_query(), {});
  Notes notes;
  fmt::print("{}, {}\n", device.info().name, device.info().driver);
  fmt::print("{:14} {:>9} {:>9}  {:>8} {:>8} {:>7} {:>9} {:>7} {:>8} {:>7} {:>8} {:>8}\n", "room",
             "triangles", "contender", "ns/ray", "spread", "ratio", "cpu/ray", "ratio", "lookups", "agree",
             "setup s", "MiB");
  for (const TriangleCostRow& row : measure_triangle_cost(device, options, notes)) {
    fmt::print(
        "{:14} {:>9} {:>9}  {:>8.1f} {:>8.1f} {:>7.3f} {:>9.1f} {:>7.3f} {:>8.2f} {:>7.4f} {:>8.2f} "
        "{:>8.1f}\n",
        row.room, row.triangles, row.contender, row.ns_per_ray_median, row.ns_per_ray_spread,
        row.ratio_to_smallest, row.cpu_ns_per_ray_median, row.cpu_ratio_to_smallest, row.lookups_mean,
        row.agreement_fraction, row.setup_s, row.setup_mib);
  }
}

}  // namespace
}  // namespace probewalk::bench

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fputs("triangle_cost_table FOLDER [REPEATS [ROOM...]]\n", stderr);
    return 2;
  }
  try {
    probewalk::bench::TriangleCostOptions options;
    options.folder = argv[1];
    if (argc > 2) options.repeats = std::stoi(argv[2]);
    if (argc > 3) options.rooms.assign(argv + 3, argv + argc);
    probewalk::bench::run(options);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "triangle_cost_table: %s\n", error.what());
    return 1;
  }
}
