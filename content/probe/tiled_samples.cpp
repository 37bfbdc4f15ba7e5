#include "content/probe/tiled_samples.h"

#include <algorithm>
#include <array>
#include <bit>
#include <optional>

#include "shaders/shared/probe_layout.h"

namespace probewalk {

namespace {

constexpr std::size_t kSide = kDeviceTileSide + 1, kVertices = kSide * kSide;
constexpr std::uint32_t kSignificand = 0x7fffffu, kHidden = 0x800000u;
// What reaches over more octaves stays floats.
constexpr std::uint32_t kMostOctaves = 3;
// Slopes this large, times the tile's side and twice, are within 32 bits; and times 16.
constexpr std::int32_t kMostSlope = (1 << 26) - 1;
// What a vertex has of its own, and what a row has in common.
constexpr std::int32_t kMostOwn = 7, kLeastCommon = -16, kMostCommon = 15;

using TileBits = std::array<std::uint32_t, kVertices>;
using TileWords = std::array<std::uint32_t, kDeviceTileWords>;

// Samples as whole numbers of a unit, which is so many octaves finer than the first one's last place.
struct Units {
  std::array<std::int32_t, kVertices> of;
  std::uint32_t finer = 0;
};

std::optional<Units> in_units(const TileBits& bits) {
  std::uint32_t least = ~0u, most = 0;
  for (const std::uint32_t each : bits) {
    least = std::min(least, each);
    most = std::max(most, each);
  }
  Units units;
  if (most == 0) {
    units.of.fill(0);
    return units;
  }
  // Beside the sky there is no unit for what is not sky; and none for infinities, negatives and what is close to 0.
  const std::uint32_t lowest = least >> 23, highest = most >> 23;
  if (lowest <= 23 || highest >= 255 || highest - lowest > kMostOctaves) return std::nullopt;
  for (std::size_t k = 0; k < kVertices; ++k) {
    units.of[k] = static_cast<std::int32_t>(((bits[k] & kSignificand) | kHidden) << ((bits[k] >> 23) - lowest));
  }
  units.finer = (bits[0] >> 23) - lowest;
  return units;
}

std::optional<TileWords> words_of(const TileBits& bits) {
  const std::optional<Units> units = in_units(bits);
  if (!units) return std::nullopt;
  const std::int32_t first = units->of[0];
  const std::int32_t slope_x = units->of[kDeviceTileSide] - first;
  const std::int32_t slope_y = units->of[kDeviceTileSide * kSide] - first;
  if (std::max(std::abs(slope_x), std::abs(slope_y)) > kMostSlope) return std::nullopt;
  TileWords words{bits[0], static_cast<std::uint32_t>(slope_x) << 4 | units->finer,
                  static_cast<std::uint32_t>(slope_y)};
  for (std::size_t y = 0; y < kSide; ++y) {
    std::array<std::int32_t, kSide> off;
    for (std::size_t x = 0; x < kSide; ++x) {
      const std::int32_t along = slope_x * static_cast<std::int32_t>(x) + slope_y * static_cast<std::int32_t>(y);
      off[x] = units->of[y * kSide + x] - (first + (along >> 3));
    }
    const auto [least, most] = std::minmax_element(off.begin(), off.end());
    const std::int32_t common = std::clamp(*least, kLeastCommon, kMostCommon);
    if (*least < common || *most - common > kMostOwn) return std::nullopt;
    std::uint32_t& row = words[3 + y];
    row = static_cast<std::uint32_t>(common) << 27;
    for (std::size_t x = 0; x < kSide; ++x) row |= static_cast<std::uint32_t>(off[x] - common) << (3 * x);
  }
  return words;
}

}  // namespace

DeviceTiles tile_samples(std::span<const float> w, int n) {
  const std::size_t pitch = static_cast<std::size_t>(n) + 1,
                    across = (static_cast<std::size_t>(n) >> kDeviceTileLog2) + 1;
  DeviceTiles out;
  out.tiles.reserve(across * across * kDeviceTileWords);
  TileBits bits;
  for (std::size_t ty = 0; ty < across; ++ty) {
    for (std::size_t tx = 0; tx < across; ++tx) {
      const float* const corner = &w[(ty * pitch + tx) * kDeviceTileSide];
      TileWords words{std::bit_cast<std::uint32_t>(*corner)};
      if (tx + 1 < across && ty + 1 < across) {
        for (std::size_t y = 0; y < kSide; ++y) {
          for (std::size_t x = 0; x < kSide; ++x)
            bits[y * kSide + x] = std::bit_cast<std::uint32_t>(corner[y * pitch + x]);
        }
        if (const std::optional<TileWords> found = words_of(bits)) {
          words = *found;
        } else {
          words[1] = static_cast<std::uint32_t>(out.floats.size()) << 4 | kTileOfFloats;
          out.floats.insert(out.floats.end(), bits.begin(), bits.end());
          ++out.of_floats;
        }
      }
      out.tiles.insert(out.tiles.end(), words.begin(), words.end());
    }
  }
  return out;
}

void place_tiles(const DeviceTiles& tiles, std::uint32_t first, std::span<std::uint32_t> words) {
  std::copy(tiles.tiles.begin(), tiles.tiles.end(), words.begin());
  for (std::size_t k = 1; k < tiles.tiles.size(); k += kDeviceTileWords) {
    if ((words[k] & 15u) == kTileOfFloats) words[k] += first << 4;
  }
}

}  // namespace probewalk
