// Where a probe's sample tiles lie and how a sample follows from a tile's plane: the same for encoder and decoder.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "content/pack/pack_format.h"
#include "content/pack/sample_tiles.h"

namespace probewalk {

// What a vertex's index says: the sky, one of the tile's planes (1..kTilePlanes), or a sample predicted from those
// before it.
inline constexpr std::uint8_t kSkyIndex = 0;
inline constexpr std::uint8_t kStrayIndex = kTilePlanes + 1;
// A plane's source: given in the tile's head (0), or the plane 1..kTilePlanes of the tile to the left, then of that
// above.
inline constexpr unsigned kLastSource = 2 * kTilePlanes;
inline constexpr std::uint32_t kFloatTile = 1u << 16;  // beside the sources

struct TilePlane {
  float base = 0.0f;                     // 1/m, at the tile's first vertex
  float along_x = 0.0f, along_y = 0.0f;  // 1/m a vertex

  // Products are exact in double, so that contracted arithmetic gives the same bits.
  double at(std::size_t x, std::size_t y) const {
    return double{base} + (double{along_x} * static_cast<double>(x) + double{along_y} * static_cast<double>(y));
  }
  // The same plane as the tile to the right, or below, sees it.
  TilePlane right() const { return {rounded(at(kSampleTileSide, 0)), along_x, along_y}; }
  TilePlane below() const { return {rounded(at(0, kSampleTileSide)), along_x, along_y}; }

  // To float, but for what no float of a pack is.
  static float rounded(double w) { return std::abs(w) <= 1e30 ? static_cast<float>(w) : -1.0f; }
};

// Vertices of one tile, and where they stand in the map.
struct TileArea {
  std::size_t x0, y0, width, height, pitch;
  std::size_t first;  // number of its first vertex, counted tile after tile
  std::size_t vertex(std::size_t x, std::size_t y) const { return (y0 + y) * pitch + x0 + x; }
};

// Calls visit(tile's number, area) for the tiles of a map of n cells a side, row after row.
template <class Visit>
void each_sample_tile(std::size_t n, Visit visit) {
  const std::size_t across = sample_tiles_across(n);
  const auto side = [&](std::size_t t) { return t + 1 == across ? n + 1 - t * kSampleTileSide : kSampleTileSide; };
  std::size_t first = 0;
  for (std::size_t ty = 0; ty < across; ++ty) {
    for (std::size_t tx = 0; tx < across; ++tx) {
      const TileArea area{tx * kSampleTileSide, ty * kSampleTileSide, side(tx), side(ty), n + 1, first};
      visit(ty * across + tx, area);
      first += area.width * area.height;
    }
  }
}

// A stray's sample as those to the left, above and between tell it; 0 where nothing does.
inline double predicted_sample(std::span<const float> w, const TileArea& area, std::size_t x, std::size_t y) {
  const std::size_t i = area.x0 + x, j = area.y0 + y, here = j * area.pitch + i;
  const double left = i > 0 ? w[here - 1] : 0.0f, up = j > 0 ? w[here - area.pitch] : 0.0f;
  if (!(left > 0.0) || !(up > 0.0)) return std::max(left, up);
  const double between = w[here - area.pitch - 1], plane = left + up - between;
  return between > 0.0 && plane > 0.0 ? plane : left;
}

// Calls visit(vertex, the vertex it is a copy of) for the border of a map of n cells a side: each of the square's four
// edges is folded onto itself.
template <class Visit>
void each_border_vertex(std::size_t n, Visit visit) {
  for (std::size_t k = 0; k <= n; ++k) {
    const std::size_t same = std::min(k, n - k);
    for (const std::size_t edge : {std::size_t{0}, n}) {
      const bool corner = same == 0;
      visit(edge * (n + 1) + k, corner ? 0 : edge * (n + 1) + same);
      visit(k * (n + 1) + edge, corner ? 0 : same * (n + 1) + edge);
    }
  }
}

}  // namespace probewalk
