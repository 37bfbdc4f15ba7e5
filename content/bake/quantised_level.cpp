#include "content/bake/quantised_level.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "content/pack/sample_tiles.h"
#include "content/probe/device_probe.h"

namespace probewalk {

namespace {

constexpr double kPlanarKept = 0.97;  // of the entries; below, the look-ups lost would be felt

// Of the geometry alone, on whose samples the pyramid depends.
std::size_t planar_entries(const ProbeGeometry& geometry) {
  return count_planar_entries(build_device_probe({geometry, {}}));
}

}  // namespace

bool QuantisedLevel::keeps_bounds() const {
  return worst <= kStraySampleError &&
         static_cast<double>(planar_after) >= kPlanarKept * static_cast<double>(planar_before);
}

QuantisedLevel compare_samples(const RoomLevel& baked, const RoomLevel& stored) {
  if (baked.probes.size() != stored.probes.size()) throw std::logic_error("levels of different probes are compared");
  QuantisedLevel found;
  for (std::size_t p = 0; p < baked.probes.size(); ++p) {
    const ProbeGeometry &a = baked.probes[p].geometry, &b = stored.probes[p].geometry;
    if (a.w.size() != b.w.size() || a.edges_horizontal != b.edges_horizontal || a.edges_vertical != b.edges_vertical ||
        a.edges_diagonal != b.edges_diagonal || a.normals != b.normals) {
      throw std::logic_error("quantising has changed more than samples");
    }
    for (std::size_t k = 0; k < a.w.size(); ++k) {
      const double should = a.w[k], is = b.w[k];
      if (should != is)
        found.worst = std::max(found.worst, should > 0.0 && is > 0.0 ? std::abs(is - should) / should : HUGE_VAL);
    }
    found.planar_before += planar_entries(a);
    found.planar_after += planar_entries(b);
  }
  return found;
}

}  // namespace probewalk
