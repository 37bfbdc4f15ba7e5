// From what decides how rays are answered (content/baseline/method.h) to pipelines: shader and specialisation constants.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

#include "content/baseline/method.h"
#include "render/baseline_store.h"
#include "render/device.h"

namespace probewalk {

// How a pass traces its rays. The default is the product: what its pipelines are made of and cost does not depend on
// the baselines then.
struct TracerSetup {
  TracerChoice choice;
  // The maps of a choice that needs some, made for it; outlives the pass. Else null.
  const BaselineStore* baselines = nullptr;
};

// What a view's rays have in common, or leave for another view.
struct SharedWork {
  bool shared_openings = false;  // what first probes are chosen from (shaders/openings.glsl)
  bool first_eyes = false;       // what they see (shaders/first_eye.glsl)
};

// Throws std::logic_error when the choice needs maps and there are none.
void check_setup(const TracerSetup& setup);

// The module that traces by the choice: the product's own, or the one that knows the baselines.
std::span<const std::uint32_t> tracing_module(const TracerChoice& choice, std::span<const std::uint32_t> own,
                                              std::span<const std::uint32_t> baseline);

// Specialisation constants of a tracing shader: `own` from 0 on, at most four of them, then the choice's from 4 on, as
// shaders/shared/tracer_glsl.h numbers them, and whether samples can be in tiles, and what is shared.
std::vector<std::uint32_t> tracing_constants(std::initializer_list<std::uint32_t> own, const TracerChoice& choice,
                                             SharedWork shared = {});

// Address for BatchConstants and FrameConstants; 0 = none.
glm::uvec2 baseline_address(const TracerSetup& setup);

// A software device gives each of its threads one contiguous part of a dispatch, one of which holds the costly pixels:
// parts taken in turn made cluttered scenes 1.75 times as fast on llvmpipe. Into so many (1 on other devices).
std::uint32_t choose_interleave(const Device& device);

}  // namespace probewalk
