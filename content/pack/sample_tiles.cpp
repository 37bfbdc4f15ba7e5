// THE SECTION kTiledSamples holds, per probe of n cells a side, t^2 heads and (n+1)^2 words, t = max(1, n / 16).
// Tile (tx, ty) has the vertices 16 tx .. 16 tx + 15 and 16 ty .. 16 ty + 15, the last of a row and of a column those
// of index n, too. Heads lie row after row of tiles, words tile after tile, in a tile row after row.
//
// A HEAD is 14 words: step (f32 bits), sources, then base, along_x, along_y (f32 bits) of four planes. Four bits of
// `sources` a plane, the first lowest: 0 = as the head says; s in 1..4 = plane s of the tile to the left, 5..8 = plane
// s - 4 of that above, moved on: base + 16 along_x or base + 16 along_y rounded to f32. Bit 16: the tile is of floats.
//
// A WORD of another tile is code | residual << 24, with code 24 bits, zig-zag. residual = index xor that of the vertex
// to the left in the tile, in the first column of that above, of the first vertex xor 1. Index 0 is the sky, w =
// 0. 1..4 is a plane of the tile: w = base + (along_x x + along_y y), x and y counted from the tile's first vertex;
// code is 0. 5 is a stray: w = p + step code, where p is predicted from w of the vertices to the left (a), above (b)
// and between (c) in the whole map, 0 beyond it: a + b - c where all three and it are positive, else a and if that is
// 0, b. Sums are made in f64 and w rounded to f32; but for index 0, w is positive. A word of a tile of floats is the
// zig-zag code of the residual of w's f32 bits under the prediction of pack_format.h in the whole map. In the end the
// square's border is folded: each of its vertices k and n - k takes the sample of the smaller, all four corners that of
// the first.
//
// Heads and words are each stored in byte planes.
#include "content/pack/sample_tiles.h"

#include <array>
#include <bit>
#include <optional>

#include "content/pack/sample_range.h"
#include "content/pack/section_transform.h"
#include "content/pack/tile_encoder.h"
#include "content/pack/tile_plane.h"

namespace probewalk {

namespace {

void fold_border(std::span<float> w, std::size_t n) {
  each_border_vertex(n, [&](std::size_t vertex, std::size_t original) { w[vertex] = w[original]; });
}

// The planes of a tile from its head; none where a source is not of the format.
std::optional<TilePlanes> planes_of_head(const std::uint32_t* head, const std::vector<TilePlanes>& planes,
                                         std::size_t tile, std::size_t across) {
  TilePlanes out;
  const TilePlanes none{};
  const TilePlanes& left = tile % across > 0 ? planes[tile - 1] : none;
  const TilePlanes& above = tile >= across ? planes[tile - across] : none;
  if (head[1] > 0xffffu) return std::nullopt;
  for (std::size_t k = 0; k < kTilePlanes; ++k) {
    const unsigned source = head[1] >> (4 * k) & 15u;
    if (source > kLastSource) return std::nullopt;
    const std::uint32_t* given = head + 2 + 3 * k;
    if (source == 0)
      out[k] = {std::bit_cast<float>(given[0]), std::bit_cast<float>(given[1]), std::bit_cast<float>(given[2])};
    else
      out[k] = source <= kTilePlanes ? left[source - 1].right() : above[source - kTilePlanes - 1].below();
  }
  return out;
}

std::uint8_t neighbour_index(const std::uint8_t* index, std::size_t width, std::size_t x, std::size_t y) {
  return x > 0 ? index[y * width + x - 1] : y > 0 ? index[(y - 1) * width] : std::uint8_t{1};
}

}  // namespace

bool has_folded_border(std::span<const float> w, std::size_t n) {
  bool folded = true;
  each_border_vertex(n, [&](std::size_t vertex, std::size_t original) {
    folded = folded && std::bit_cast<std::uint32_t>(w[vertex]) == std::bit_cast<std::uint32_t>(w[original]);
  });
  return folded;
}

TiledSamples encode_tiled_samples(std::span<const float> w, std::size_t n) {
  const std::size_t across = sample_tiles_across(n);
  TiledSamples out;
  out.w.resize(w.size());
  std::vector<TilePlanes> planes(across * across);
  std::vector<std::uint32_t> heads(across * across * kTileHeadWords), words(w.size());
  each_sample_tile(n, [&](std::size_t index, const TileArea& area) {
    const TilePlanes none{};
    TileEncoder encoder(w, area, index % across > 0 ? planes[index - 1] : none,
                        index >= across ? planes[index - across] : none);
    std::uint32_t* head = &heads[index * kTileHeadWords];
    const std::optional<CodedTile> tile = encoder.encode(out.w);
    if (tile) {
      planes[index] = tile->planes;
      head[0] = std::bit_cast<std::uint32_t>(tile->step);
      for (std::size_t k = 0; k < kTilePlanes; ++k) {
        head[1] |= tile->sources[k] << (4 * k);
        if (tile->sources[k] != 0) continue;
        head[2 + 3 * k] = std::bit_cast<std::uint32_t>(tile->planes[k].base);
        head[3 + 3 * k] = std::bit_cast<std::uint32_t>(tile->planes[k].along_x);
        head[4 + 3 * k] = std::bit_cast<std::uint32_t>(tile->planes[k].along_y);
      }
    } else {
      head[1] = kFloatTile;
      ++out.float_tiles;
    }
    for (std::size_t y = 0; y < area.height; ++y) {
      for (std::size_t x = 0; x < area.width; ++x) {
        const std::size_t local = y * area.width + x;
        std::uint32_t& word = words[area.first + local];
        if (tile) {
          const std::uint8_t kind = tile->index[local];
          word = zigzag_encode(static_cast<std::uint32_t>(tile->code[local])) |
                 static_cast<std::uint32_t>(kind ^ neighbour_index(tile->index.data(), area.width, x, y)) << 24;
          out.strays += kind == kStrayIndex;
        } else {
          const auto bits = [&](std::size_t vertex) { return std::bit_cast<std::uint32_t>(out.w[vertex]); };
          const std::size_t vertex = area.vertex(x, y);
          out.w[vertex] = w[vertex];
          word = zigzag_encode(bits(vertex) - predicted_bits(out.w, area, x, y));
        }
      }
    }
  });
  fold_border(out.w, n);
  for (std::size_t k = 0; k < w.size(); ++k) {
    if (w[k] != 0.0f) out.worst = std::max(out.worst, std::abs(double{out.w[k]} - double{w[k]}) / double{w[k]});
  }
  out.bytes.resize(tiled_sample_bytes(n));
  const std::span<std::byte> bytes(out.bytes);
  split_byte_planes<std::uint32_t>(heads, bytes.first(4 * heads.size()));
  split_byte_planes<std::uint32_t>(words, bytes.subspan(4 * heads.size()));
  return out;
}

bool decode_tiled_samples(std::span<const std::byte> bytes, std::size_t n, std::span<float> w) {
  const std::size_t across = sample_tiles_across(n);
  std::vector<std::uint32_t> heads(across * across * kTileHeadWords), words(w.size());
  join_byte_planes<std::uint32_t>(bytes.first(4 * heads.size()), heads);
  join_byte_planes<std::uint32_t>(bytes.subspan(4 * heads.size()), words);
  std::vector<TilePlanes> planes(across * across);
  bool sound = true;
  std::array<std::uint8_t, kMostTileVertices> kinds;
  each_sample_tile(n, [&](std::size_t tile, const TileArea& area) {
    const std::uint32_t* head = &heads[tile * kTileHeadWords];
    const bool floats = head[1] == kFloatTile;
    const double step = std::bit_cast<float>(head[0]);
    if (!floats) {
      const auto given = planes_of_head(head, planes, tile, across);
      if (!given || !std::isfinite(step))
        sound = false;
      else
        planes[tile] = *given;
    }
    const std::uint32_t* word = &words[area.first];
    for (std::size_t y = 0; y < area.height; ++y) {
      for (std::size_t x = 0; x < area.width; ++x, ++word) {
        float& here = w[area.vertex(x, y)];
        if (floats) {
          here = std::bit_cast<float>(zigzag_decode(*word) + predicted_bits(w, area, x, y));
        } else {
          std::uint8_t& kind = kinds[y * area.width + x];
          kind = static_cast<std::uint8_t>(*word >> 24 ^ neighbour_index(kinds.data(), area.width, x, y));
          const std::uint32_t code = *word & 0xffffffu;
          if (kind == kStrayIndex) {
            here = TilePlane::rounded(predicted_sample(w, area, x, y) +
                                      step * static_cast<std::int32_t>(zigzag_decode(code)));
          } else {
            here = kind == kSkyIndex    ? 0.0f
                   : kind < kStrayIndex ? TilePlane::rounded(planes[tile][kind - 1u].at(x, y))
                                        : -1.0f;
            sound = sound && code == 0;
          }
          sound = sound && (kind == kSkyIndex || here > 0.0f);
        }
        sound = sound && is_storable_w(here);
      }
    }
  });
  fold_border(w, n);
  return sound;
}

}  // namespace probewalk
