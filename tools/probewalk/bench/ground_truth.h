// What is right: the triangles that a pack was baked from, along the same rays and with the same light.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "content/image/image.h"
#include "content/pack/pack_io.h"
#include "content/progress.h"
#include "content/scene/ray_scene.h"
#include "tools/probewalk/bench/bench_views.h"
#include "tools/probewalk/reference_picture.h"

namespace probewalk::bench {

class GroundTruth {
 public:
  // Loads the scene as the pack's bake did, and with `pictures` builds its light (long). `progress` must outlive this.
  // Throws BadInput, Interrupted.
  GroundTruth(const std::filesystem::path& scene_file, const Pack& pack, bool pictures, int threads, Progress& progress);
  ~GroundTruth();
  GroundTruth(const GroundTruth&) = delete;
  GroundTruth& operator=(const GroundTruth&) = delete;

  const Scene& scene() const;
  const RayScene& triangles() const;

  // Metres along each ray to the nearest triangle; infinity = none. Throws Interrupted.
  std::vector<float> distances_m(const ViewRays& rays) const;
  // One picture a view as a display would get it; made with `pictures` only. Throws Interrupted.
  std::vector<ImageRgb8> pictures(const ViewRays& rays, float exposure_ev) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace probewalk::bench
