// How bright the picture is shown and how radiance is scaled into the pack: chosen once, from views along the tour, and
// never changed while somebody walks.
#pragma once

#include <vector>

#include "content/bake/light_field.h"
#include "content/scene/space.h"

namespace probewalk {

struct Exposure {
  float radiance_scale = 1.0f;  // a power of two; the 99.99th percentile of radiance times this fits 16384
  double exposure_ev = 0.0;     // ISO 100, as exposure_from_ev (shaders/shared/display_transform.h) takes it
};

// Looks from up to 32 poses of the tour (at least one is needed). Deterministic.
Exposure choose_exposure(const LightField& light, const std::vector<Pose>& tour);

}  // namespace probewalk
