// Maps of probes, baked once: what an earlier run of the same bake, or its planner, has finished is taken from the
// state.
#pragma once

#include <cstdint>

#include "content/bake/bake_probe.h"
#include "content/bake/bake_state.h"

namespace probewalk {

class MapStore {
 public:
  // All must outlive this.
  MapStore(const RayScene& rays, const LightField& light, float radiance_scale, const BakeState& state,
           SpaceCells cells)
      : rays_(rays), light_(light), radiance_scale_(radiance_scale), state_(state), cells_(cells) {}

  // What the map was made of joins `inputs`.
  ProbeGeometry geometry(glm::dvec3 position_m, int n, MapInputs* inputs = nullptr);
  ProbeRadiance radiance(glm::dvec3 position_m, int r, MapInputs* inputs = nullptr);

  std::uint64_t rays_cast() const { return rays_cast_; }
  // Of the maps baked now, without those kept from before.
  std::uint64_t baked_texels() const { return baked_texels_; }
  double baking_seconds() const { return baking_seconds_; }

 private:
  const RayScene& rays_;
  const LightField& light_;
  const float radiance_scale_;
  const BakeState& state_;
  const SpaceCells cells_;
  std::uint64_t rays_cast_ = 0, baked_texels_ = 0;
  double baking_seconds_ = 0.0;
};

}  // namespace probewalk
