// Answers from a pack's probes, by any of the methods.
#pragma once

#include <memory>

#include "content/baseline/baseline_maps.h"
#include "render/device.h"
#include "tools/probewalk/bench/contender.h"
#include "tools/probewalk/bench/pack_levels.h"

namespace probewalk::bench {

// Level and maps must outlive the contender; `maps` may be null where the choice needs none.
std::unique_ptr<Contender> make_probe_contender(const Device& device, const PackLevel& level, const BaselineMaps* maps,
                                                const TraceConstants& dials, const TracerChoice& choice);

}  // namespace probewalk::bench
