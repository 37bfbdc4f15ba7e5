#include "tools/probewalk/reference_picture.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "content/error.h"
#include "shaders/shared/view_ray.h"

namespace probewalk {
namespace {

LightOptions light_as_baked(const Manifest& manifest, int threads, Progress& progress) {
  LightOptions options;
  options.threads = threads;
  if (!manifest.light) {
    progress.note("the pack does not say how its light was sampled: the bake's defaults are taken");
    return options;
  }
  options.samples = manifest.light->samples;
  options.bounces = manifest.light->bounces;
  options.cache_spacing_m = manifest.light->cache_spacing_m;
  options.seed = manifest.light->seed;
  return options;
}

}  // namespace

Scene load_scene_as_baked(const std::filesystem::path& file, const Manifest& manifest, std::optional<double> scale,
                          Progress& progress) {
  SceneLoadOptions options;
  options.scale = scale.value_or(manifest.scale);
  options.recentre = manifest.light && manifest.light->recentred;
  Scene scene = load_scene(file, options);
  if (scene.content_hash != manifest.scene_hash) {
    progress.note(fmt::format("{} is not the scene that the pack was baked from, or was loaded otherwise: the pictures "
                              "may differ for that reason", file.string()));
  }
  return scene;
}

ReferenceCaster::ReferenceCaster(const std::filesystem::path& scene_file, const Manifest& manifest,
                                 std::optional<double> scale, int threads, Progress& progress)
    : progress_(progress),
      scene_(load_scene_as_baked(scene_file, manifest, scale, progress)),
      rays_(scene_),
      light_(scene_, rays_, light_as_baked(manifest, threads, progress), progress) {}

std::vector<ImageRgbF> ReferenceCaster::cast(const std::vector<ViewConstants>& views, int width_px,
                                             int height_px) const {
  progress_.begin("reference", std::uint64_t{views.size()} * static_cast<std::uint64_t>(height_px), "rows");
  std::vector<ImageRgbF> pictures;
  for (const ViewConstants& view : views) {
    ImageRgbF picture{width_px, height_px, {}};
    picture.rgb.resize(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px));
    const glm::vec3 origin_m = view.origin_hi_m + view.origin_lo_m;
    tbb::parallel_for(0, height_px, [&](int y) {
      if (progress_.cancelled()) return;
      for (int x = 0; x < width_px; ++x) {
        const glm::vec3 direction = view_ray(view, {x, y}, {width_px, height_px});
        picture.rgb[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px) + static_cast<std::size_t>(x)] =
            light_.along(origin_m, direction, view.pixel_angle_rad);
      }
      progress_.advance(1);
    });
    if (progress_.cancelled()) throw Interrupted("interrupted while casting the reference; finished pictures are kept");
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

}  // namespace probewalk
