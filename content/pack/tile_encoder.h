// Chooses a sample tile's planes and codes: planes of neighbouring tiles that go on, then planes found in it, and steps
// for what lies on none.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "content/pack/tile_plane.h"

namespace probewalk {

using TilePlanes = std::array<TilePlane, kTilePlanes>;
inline constexpr std::size_t kMostTileVertices = (kSampleTileSide + 1) * (kSampleTileSide + 1);

struct CodedTile {
  TilePlanes planes{};
  std::array<unsigned, kTilePlanes> sources{};
  float step = 0.0f;
  std::array<std::uint8_t, kMostTileVertices> index{};
  std::array<std::int32_t, kMostTileVertices> code{};
};

// Prediction of a sample's bits in the whole map.
std::uint32_t predicted_bits(std::span<const float> w, const TileArea& area, std::size_t x, std::size_t y);

class TileEncoder {
 public:
  // w: the map. left, above: the neighbouring tiles' planes; all zero where there are none.
  TileEncoder(std::span<const float> w, const TileArea& area, const TilePlanes& left, const TilePlanes& above);

  // `decoded` holds what the tiles before decode to; the tile's own are written into it. Nothing when a sample cannot
  // be held within its error: the tile is one of floats then.
  std::optional<CodedTile> encode(std::span<float> decoded);

 private:
  float at(std::size_t x, std::size_t y) const { return w_[area_.vertex(x, y)]; }
  bool lies_on(const TilePlane& plane, std::size_t x, std::size_t y) const;
  std::size_t count_on(const TilePlane& plane) const;
  void put(const TilePlane& plane, unsigned source);
  void take_over_planes(const TilePlanes& left, const TilePlanes& above);
  void find_planes();
  std::optional<TilePlane> grown(std::size_t x, std::size_t y) const;
  std::optional<TilePlane> fitted(const TilePlane& plane, double tolerance, std::size_t reach) const;
  bool code_strays(std::span<float> decoded);

  static constexpr std::uint8_t kOpen = 255;
  std::span<const float> w_;
  TileArea area_;
  const TilePlanes &left_, &above_;
  CodedTile tile_;
  std::size_t planes_ = 0;
};

}  // namespace probewalk
