#include "tools/probewalk/bench/ground_truth.h"

#include <tbb/parallel_for.h>

#include "content/error.h"

namespace probewalk::bench {

struct GroundTruth::Impl {
  Progress& progress;
  // One or the other: the caster owns a scene of its own.
  std::unique_ptr<ReferenceCaster> caster;
  std::unique_ptr<Scene> scene;
  std::unique_ptr<RayScene> rays;
};

GroundTruth::GroundTruth(const std::filesystem::path& scene_file, const Pack& pack, bool pictures, int threads,
                         Progress& progress)
    : impl_(new Impl{progress, nullptr, nullptr, nullptr}) {
  if (pictures) {
    impl_->caster = std::make_unique<ReferenceCaster>(scene_file, pack.manifest(), std::nullopt, threads, progress);
  } else {
    impl_->scene = std::make_unique<Scene>(load_scene_as_baked(scene_file, pack.manifest(), std::nullopt, progress));
    impl_->rays = std::make_unique<RayScene>(*impl_->scene);
  }
}

GroundTruth::~GroundTruth() = default;

const Scene& GroundTruth::scene() const { return triangles().scene(); }

const RayScene& GroundTruth::triangles() const { return impl_->caster ? impl_->caster->triangles() : *impl_->rays; }

std::vector<float> GroundTruth::distances_m(const ViewRays& rays) const {
  std::vector<float> distances(rays.rays.size());
  const RayScene& scene = triangles();
  tbb::parallel_for(std::size_t{0}, rays.rays.size(), [&](std::size_t k) {
    distances[k] = scene.closest(glm::vec3(rays.rays[k].origin_m), device_direction(rays.rays[k])).t;
  });
  return distances;
}

std::vector<ImageRgb8> GroundTruth::pictures(const ViewRays& rays, float exposure_ev) const {
  std::vector<ImageRgb8> shown;
  for (const ImageRgbF& picture : impl_->caster->cast(rays.views, rays.size.width_px, rays.size.height_px)) {
    shown.push_back(display_transform(picture, exposure_ev));
  }
  return shown;
}

}  // namespace probewalk::bench
