// A probe's samples as steps from planes, tile by tile, within a stated error. What the bytes mean: sample_tiles.cpp,
// the format's normative text of the section kTiledSamples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace probewalk {

// Vertices along a tile's side; the last tile of a row and of a column has one more, so that none is a sliver.
inline constexpr std::size_t kSampleTileSide = 16;
inline constexpr std::size_t kTilePlanes = 4;
// By how much of itself a sample may differ from the one it was made of. On a plane: half of kPlanarTolerance, so that
// walls stay planar for the tracer (one more bit loses a few more of their entries, one less makes more strays).
// Elsewhere: 0.3 mm at 10 m, far below what a map's resolution leaves open.
inline constexpr double kPlaneSampleError = 0x1p-20;
inline constexpr double kStraySampleError = 0x1p-15;

constexpr std::size_t sample_tiles_across(std::size_t n) {
  return n < kSampleTileSide ? 1 : n / kSampleTileSide;
}
inline constexpr std::size_t kTileHeadWords = 2 + 3 * kTilePlanes;
// Bytes of one probe's heads and words, before compression.
constexpr std::uint64_t tiled_sample_bytes(std::uint64_t n) {
  return 4 * (sample_tiles_across(n) * sample_tiles_across(n) * kTileHeadWords + (n + 1) * (n + 1));
}

struct TiledSamples {
  std::vector<std::byte> bytes;  // tiled_sample_bytes(n)
  std::vector<float> w;          // what they decode to
  std::size_t float_tiles = 0;   // of sample_tiles_across(n)^2: kept to the bit, since steps do not span them
  std::size_t strays = 0;        // samples on no plane of their tile
  double worst = 0.0;            // largest relative difference between a sample and what it decodes to
};

// w: (n+1)^2 samples that a pack may hold, the square's border folded onto itself bit for bit (has_folded_border).
TiledSamples encode_tiled_samples(std::span<const float> w, std::size_t n);
// Returns false when the bytes are not of the format or a sample comes out that no pack may hold; w is of no use then.
// bytes: tiled_sample_bytes(n); w: (n+1)^2.
bool decode_tiled_samples(std::span<const std::byte> bytes, std::size_t n, std::span<float> w);

// Whether vertices of the square's border that are the same point of the octahedron hold the same sample.
bool has_folded_border(std::span<const float> w, std::size_t n);

}  // namespace probewalk
