// The picture that the probes stand for: the same rays against the triangles, with the light that was baked.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "content/bake/light_field.h"
#include "content/image/image.h"
#include "content/pack/manifest.h"
#include "content/progress.h"
#include "content/scene/ray_scene.h"
#include "content/scene/scene.h"
#include "shaders/shared/probe_layout.h"

namespace probewalk {

// Loads a scene as the pack's bake did (`scale` overrides). Notes when it is not the one that was baked. Throws BadInput.
Scene load_scene_as_baked(const std::filesystem::path& file, const Manifest& manifest, std::optional<double> scale,
                          Progress& progress);

class ReferenceCaster {
 public:
  // Loads the scene as the pack's bake did (`scale` overrides) and builds its light (long, once for all pictures). Notes
  // when the scene is not the one that was baked. `progress` must outlive the caster. Throws BadInput, Interrupted.
  ReferenceCaster(const std::filesystem::path& scene_file, const Manifest& manifest, std::optional<double> scale,
                  int threads, Progress& progress);

  // One picture a view, in cd/m^2, rays through the pixels' centres. Throws Interrupted.
  std::vector<ImageRgbF> cast(const std::vector<ViewConstants>& views, int width_px, int height_px) const;
  const RayScene& triangles() const { return rays_; }

 private:
  Progress& progress_;
  const Scene scene_;
  const RayScene rays_;
  const LightField light_;
};

}  // namespace probewalk
