// The eyes that a pack is measured from, and their rays.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "content/pack/manifest.h"
#include "render/ray_batch.h"
#include "shaders/shared/probe_layout.h"
#include "tools/probewalk/bench/bench_options.h"
#include "tools/probewalk/named_poses.h"

namespace probewalk::bench {

struct RaySize {
  int width_px = 0, height_px = 0;
  double vertical_fov_rad = 0.0;
};

// A view of its own for each pose, all of one size.
struct ViewRays {
  RaySize size;
  std::vector<ViewConstants> views;
  std::vector<WorldRay> rays;  // view by view, rows from the top
  float spread_rad = 0.0f;     // angular width of a ray

  std::size_t per_view() const { return static_cast<std::size_t>(size.width_px) * static_cast<std::size_t>(size.height_px); }
};

// Evenly along the tour, each looking where the walker looks; or those of the options' file. A tour that stands still is
// looked around from.
std::vector<NamedPose> bench_poses(const Manifest& manifest, const BenchOptions& options);

// Vertical field of view of a picture whose centre pixels are as wide as a headset's.
double fov_at_density(int height_px, double pixels_per_degree);
// Pixels per degree at the centre of a picture.
double density_of(const RaySize& size);

ViewRays rays_of(const std::vector<NamedPose>& poses, const RaySize& size);

// The direction that the device traces, to the bit.
glm::vec3 device_direction(const WorldRay& ray);

}  // namespace probewalk::bench
