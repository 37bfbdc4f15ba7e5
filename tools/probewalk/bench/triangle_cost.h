// What a ray costs against how many triangles the room has: the probes' tracer, the device's ray query, and
// Embree on the same rays of the same room in a thousand triangles and more.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "content/progress.h"
#include "render/device.h"

namespace probewalk::bench {

struct TriangleCostOptions {
  std::vector<std::string> rooms{"triangles-1e3", "triangles-1e5", "triangles-1e6"};  // smallest first
  std::filesystem::path folder;  // keeps ROOM.glb and ROOM.probes from one run to the next
  int resolution = 512;          // of the probes' geometry
  int max_probes = 8;
  int width_px = 320, height_px = 240;  // of each view
  int repeats = 9;
};

// One contender in one room. The first room's rows are what the ratios are to.
struct TriangleCostRow {
  std::string room, contender;  // oat, ray-query, embree-1, embree-16
  std::size_t triangles = 0, rays = 0;
  double ns_per_ray_median = 0.0;
  double ns_per_ray_spread = 0.0;  // distance between the quartiles
  double ratio_to_smallest =
      1.0;  // median over repeats of the time beside the same contender's in the first room
  // Both again by the process's own processor time, all threads together, which does not count what others
  // run on the machine: of meaning where the device is the processor. For oat and ray-query it includes
  // copying in and out.
  double cpu_ns_per_ray_median = 0.0, cpu_ratio_to_smallest = 1.0;
  double lookups_mean = 0.0;        // oat only, else 0
  double agreement_fraction = 0.0;  // of rays whose distance is within 2 % of embree-1's
  double setup_s = 0.0;             // building the hierarchy, or baking (0 where the pack was there)
  double setup_mib = 0.0;           // of the device's structures; 0 = not known
};

// All rooms are held at once and the runs are interleaved, so that what else the machine does falls on all
// alike. Times are from submission to fence, or of the call; copying rays and distances is not in them. oat
// also finds the radiance, the others nothing but the distance. ray-query is left out, with a note, where
// has_ray_query(device) is not true.
std::vector<TriangleCostRow> measure_triangle_cost(const Device& device, const TriangleCostOptions& options,
                                                   Progress& progress);

}  // namespace probewalk::bench
