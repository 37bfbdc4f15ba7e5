// A probe's samples as the device can hold them in fewer bits than floats have: tile by tile as whole units off a
// plane, to the bit the same samples (layout: shaders/shared/probe_layout.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace probewalk {

// How samples lie on the device: the tracer sees the same floats.
enum class DeviceSamples {
  kFloat,
  kTiled,        // in fewer bits, of probes where that saves at least a third of the samples' bytes
  kTiledAlways,  // of all of at least kDeviceTileSide cells a side: for checks
};

// What is kept where nothing else is asked for.
inline constexpr DeviceSamples kDefaultSamples = DeviceSamples::kTiled;

// Smaller maps stay floats: their tiles would have more cut than they save.
inline constexpr int kLeastTiledSide = 64;

struct DeviceTiles {
  std::vector<std::uint32_t> tiles;   // kDeviceTileWords each; floats are counted from their first word
  std::vector<std::uint32_t> floats;  // of the tiles that are not in units
  std::size_t of_floats = 0;          // tiles

  std::uint64_t words() const { return tiles.size() + floats.size(); }
};

// w: (n+1)^2 floats of any bits, n a power of two of at least kDeviceTileSide (shaders/shared/probe_layout.h).
DeviceTiles tile_samples(std::span<const float> w, int n);

// Counts the floats' words from `first` on in the tiles that are written to `words`.
void place_tiles(const DeviceTiles& tiles, std::uint32_t first, std::span<std::uint32_t> words);

}  // namespace probewalk
