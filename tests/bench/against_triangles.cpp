// A pack's rays against the triangles that it was baked from, on the host: from eyes along the tour, in all directions.
//   against_triangles PACK SCENE [RAYS]
// Prints one line a pack: shares of all rays that are wrong (a distance off by over 2 %, a hit for a miss, a miss for a
// hit) and that are holes (unknown), and the distance error of the rays that hit in both, relative.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>

#include "bench/triangle_rays.h"
#include "content/pack/pack_io.h"

namespace probewalk::bench {
namespace {

void print(const std::string& name, const RaySummary& sum) {
  fmt::print(
      "{}: {} rays, wrong {:.2f} % (distance {:.2f}, hit for miss {:.2f}, miss for hit {:.2f}), hole {:.2f} %, error "
      "p50 {:.1e} p95 {:.1e} p99 {:.1e}, look-ups {:.1f} ({:.1f} of rays with an answer), probes {:.2f}, NaN {}\n",
      name, sum.rays, sum.wrong(), sum.distance, sum.hit_for_miss, sum.miss_for_hit, sum.hole, sum.p50, sum.p95,
      sum.p99, sum.lookups, sum.answered_lookups, sum.tries, sum.nan);
}

void run(const std::filesystem::path& pack_folder, const std::filesystem::path& scene_file, int count) {
  const Pack pack = Pack::open(pack_folder);
  const Manifest& manifest = pack.manifest();
  SceneLoadOptions options;
  options.scale = manifest.scale;
  options.recentre = manifest.light && manifest.light->recentred;
  const Scene scene = load_scene(scene_file, options);
  const RayScene triangles(scene);
  const ProbeSet probes = ProbeSet::read(pack);
  const TraceConstants dials = default_dials(manifest.radiance_scale);
  const Path tour = path_of_tour(manifest.tour);
  print(pack_folder.filename().string(), cast_all(probes, dials, triangles, tour, count));
}

}  // namespace
}  // namespace probewalk::bench

int main(int argc, char** argv) {
  if (argc < 3 || argc > 4) {
    std::fputs("against_triangles PACK SCENE [RAYS]\n", stderr);
    return 2;
  }
  try {
    probewalk::bench::run(argv[1], argv[2], argc > 3 ? std::stoi(argv[3]) : 1000000);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "against_triangles: %s\n", error.what());
    return 1;
  }
}
