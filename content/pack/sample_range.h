// Which values a probe's arrays may hold in a pack: the same for the writer and the reader.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "content/pack/pack_format.h"
#include "content/probe/probe_map.h"

namespace probewalk {

// Sky (exactly +0) or within the limits; NaN, infinities, negatives (-0 too) and denormals are not.
inline bool is_storable_w(float w) {
  return (w >= PackLimits::kLeastW_per_m && w <= PackLimits::kGreatestW_per_m) || (w == 0.0f && !std::signbit(w));
}

inline bool edges_in_range(std::span<const std::uint8_t> edges) {
  return std::all_of(edges.begin(), edges.end(), [](std::uint8_t edge) { return edge <= kCutSteps; });
}

// Whether any edge of the map is disconnected.
inline bool has_cut(const ProbeGeometry& geometry) {
  const auto any = [](std::span<const std::uint8_t> edges) {
    return std::any_of(edges.begin(), edges.end(), [](std::uint8_t edge) { return edge != kConnected; });
  };
  return any(geometry.edges_horizontal) || any(geometry.edges_vertical) || any(geometry.edges_diagonal);
}

}  // namespace probewalk
