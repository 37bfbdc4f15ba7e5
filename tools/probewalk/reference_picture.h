// The picture that the probes stand for: the same rays against the triangles, with the light that was baked.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "content/bake/light_field.h"
#include "content/image/image.h"
#include "content/pack/manifest.h"
#include "content/progress.h"
#include "content/scene/scene.h"
#include "shaders/shared/probe_layout.h"

namespace probewalk {

// One picture a view, in cd/m^2, rays through the pixels' centres. Loads the scene at the pack's scale and builds the
// light (long). Notes when the scene is not the one that was baked. Throws BadInput, Interrupted.
std::vector<ImageRgbF> cast_reference(const std::filesystem::path& scene_file, const SceneLoadOptions& load,
                                      const LightOptions& light, const Manifest& manifest,
                                      const std::vector<ViewConstants>& views, int width_px, int height_px,
                                      Progress& progress);

}  // namespace probewalk
