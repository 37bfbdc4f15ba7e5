// Chunks without compression, so that a mutated byte is a mutated value.
#pragma once

#include <bit>
#include <cstring>
#include <vector>

#include "content/pack/chunk_layout.h"
#include "content/pack/pack_io.h"
#include "content/pack/sample_tiles.h"
#include "content/pack/section_transform.h"

namespace probewalk::fuzz {

template <class T>
void append(std::vector<std::byte>& out, const std::vector<T>& values) {
  const auto bytes = std::as_bytes(std::span(values));
  out.insert(out.end(), bytes.begin(), bytes.end());
}

template <class Word>
void append_planes(std::vector<std::byte>& out, const std::vector<Word>& words) {
  out.resize(out.size() + words.size() * sizeof(Word));
  split_byte_planes<Word>(words, std::span(out).last(words.size() * sizeof(Word)));
}

inline void append_section(std::vector<std::byte>& out, ChunkSection kind, const RoomLevel& level) {
  for (const ProbeMap& probe : level.probes) {
    const ProbeGeometry& g = probe.geometry;
    const ProbeRadiance& r = probe.radiance;
    switch (kind) {
      case ChunkSection::kPositions: {
        const glm::vec3 relative(g.position_m - level.origin_m);
        append(out, std::vector<float>{relative.x, relative.y, relative.z});
        break;
      }
      case ChunkSection::kSamples: {
        std::vector<std::uint32_t> bits;
        for (const float w : g.w) bits.push_back(std::bit_cast<std::uint32_t>(w));
        append_planes(out, residuals_of<std::uint32_t>(bits, static_cast<std::size_t>(g.n) + 1));
        break;
      }
      case ChunkSection::kEdges:
        append(out, g.edges_horizontal);
        append(out, g.edges_vertical);
        append(out, g.edges_diagonal);
        break;
      case ChunkSection::kNormals: append_planes(out, g.normals); break;
      case ChunkSection::kRadiance: append_planes(out, r.rgb9e5); break;
      case ChunkSection::kTexelW:
        append_planes(out, residuals_of<std::uint16_t>(r.texel_w, static_cast<std::size_t>(r.r)));
        break;
      case ChunkSection::kQuantisedSamples:
        append(out, encode_tiled_samples(g.w, static_cast<std::size_t>(g.n)).bytes);
        break;
    }
  }
}

// Every section is raw; normals are always there. Quantised: borders are folded.
inline std::vector<std::byte> plain_chunk(const RoomLevel& level, bool quantised = false) {
  ChunkHeader header;
  const ProbeMap& first = level.probes.front();
  header.counts = {static_cast<std::uint32_t>(level.probes.size()), static_cast<std::uint32_t>(first.geometry.n),
                   static_cast<std::uint32_t>(first.radiance.r)};
  header.room_origin_m = level.origin_m;
  std::vector<std::byte> body;
  for (std::uint32_t kind = 1; kind <= static_cast<std::uint32_t>(ChunkSection::kQuantisedSamples); ++kind) {
    if (static_cast<ChunkSection>(kind) == (quantised ? ChunkSection::kSamples : ChunkSection::kQuantisedSamples)) continue;
    const std::size_t before = body.size();
    append_section(body, static_cast<ChunkSection>(kind), level);
    const std::uint64_t bytes = body.size() - before;
    header.sections.push_back({static_cast<ChunkSection>(kind), ChunkCodec::kRaw, bytes, bytes});
  }
  std::vector<std::byte> chunk = write_chunk_header(header);
  chunk.insert(chunk.end(), body.begin(), body.end());
  return chunk;
}

}  // namespace probewalk::fuzz
