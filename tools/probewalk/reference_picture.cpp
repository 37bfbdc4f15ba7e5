#include "tools/probewalk/reference_picture.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "content/error.h"
#include "content/scene/ray_scene.h"
#include "shaders/shared/view_ray.h"

namespace probewalk {

std::vector<ImageRgbF> cast_reference(const std::filesystem::path& scene_file, const SceneLoadOptions& load,
                                      const LightOptions& light_options, const Manifest& manifest,
                                      const std::vector<ViewConstants>& views, int width_px, int height_px,
                                      Progress& progress) {
  SceneLoadOptions options = load;
  if (!options.scale) options.scale = manifest.scale;
  const Scene scene = load_scene(scene_file, options);
  if (scene.content_hash != manifest.scene_hash) {
    progress.note(fmt::format("{} is not the scene that the pack was baked from, or was loaded otherwise: the pictures "
                              "may differ for that reason", scene_file.string()));
  }
  const RayScene rays(scene);
  const LightField light(scene, rays, light_options, progress);

  progress.begin("reference", std::uint64_t{views.size()} * static_cast<std::uint64_t>(height_px), "rows");
  std::vector<ImageRgbF> pictures;
  for (const ViewConstants& view : views) {
    ImageRgbF picture{width_px, height_px, {}};
    picture.rgb.resize(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px));
    const glm::vec3 origin_m = view.origin_hi_m + view.origin_lo_m;
    tbb::parallel_for(0, height_px, [&](int y) {
      if (progress.cancelled()) return;
      for (int x = 0; x < width_px; ++x) {
        const glm::vec3 direction = view_ray(view, {x, y}, {width_px, height_px});
        picture.rgb[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px) + static_cast<std::size_t>(x)] =
            light.along(origin_m, direction, view.pixel_angle_rad);
      }
      progress.advance(1);
    });
    if (progress.cancelled()) throw Interrupted("interrupted while casting the reference; nothing was written");
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

}  // namespace probewalk
