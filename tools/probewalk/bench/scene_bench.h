// Measures one pack: every method with its settings over the same views.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "content/progress.h"
#include "render/device.h"
#include "tools/probewalk/bench/bench_options.h"
#include "tools/probewalk/bench/scene_report.h"

namespace probewalk::bench {

// `scene` is what the pack was baked from; without one there are no triangles to compare with, and no maps for the
// baselines. Pictures of the worst views go to `options.output`/pictures. Throws BadInput, BadUsage, Interrupted.
SceneReport bench_scene(const Device& device, const BenchOptions& options, const std::filesystem::path& pack,
                        const std::optional<std::filesystem::path>& scene, const std::string& name, Progress& progress);

}  // namespace probewalk::bench
