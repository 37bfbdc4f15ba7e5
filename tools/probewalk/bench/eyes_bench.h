// What two eyes cost beside one, by the tracer that draws frames: time and look-ups of the second over the first, with
// the answers' errors beside them.
#pragma once

#include <string>
#include <vector>

#include "content/progress.h"
#include "render/device.h"
#include "tools/probewalk/bench/bench_options.h"
#include "tools/probewalk/bench/eyes_row.h"
#include "tools/probewalk/bench/ground_truth.h"
#include "tools/probewalk/bench/pack_levels.h"
#include "tools/probewalk/named_poses.h"

namespace probewalk::bench {

inline constexpr double kBenchIpd_m = 0.063;

// At each pose a head looks with both eyes. `truth`: null for none, then errors against it are missing. The first row
// is the product's own, kDefaultSettings, whose rays share nothing. Throws Interrupted.
std::vector<EyesRow> bench_eyes(const Device& device, const BenchOptions& options, const PackLevel& level,
                                const TraceConstants& dials, const std::vector<NamedPose>& poses,
                                const GroundTruth* truth, const std::string& scene, Progress& progress);

}  // namespace probewalk::bench
