// A chunk's header as values, and the sizes that follow from its counts (pack_format.h is the normative text).
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "content/pack/pack_format.h"

namespace probewalk {

struct ChunkCounts {
  std::uint32_t probes = 0;
  std::uint32_t geometry_n = 0;
  std::uint32_t radiance_r = 0;
};

struct SectionEntry {
  ChunkSection kind = ChunkSection::kPositions;
  ChunkCodec codec = ChunkCodec::kRaw;
  std::uint64_t raw_bytes = 0;
  std::uint64_t stored_bytes = 0;
};

struct ChunkHeader {
  ChunkCounts counts;
  glm::dvec3 room_origin_m{0.0};
  std::vector<SectionEntry> sections;
};

// Array lengths of one probe.
constexpr std::uint64_t vertex_count(const ChunkCounts& c) {
  return std::uint64_t{c.geometry_n + 1} * (c.geometry_n + 1);
}
constexpr std::uint64_t straight_edge_count(const ChunkCounts& c) {
  return std::uint64_t{c.geometry_n} * (c.geometry_n + 1);
}
constexpr std::uint64_t cell_count(const ChunkCounts& c) { return std::uint64_t{c.geometry_n} * c.geometry_n; }
constexpr std::uint64_t texel_count(const ChunkCounts& c) { return std::uint64_t{c.radiance_r} * c.radiance_r; }
constexpr std::uint64_t mip_texel_count(const ChunkCounts& c) { return (4 * texel_count(c) - 1) / 3; }

// Bytes of one probe's array in a section, before compression.
std::uint64_t section_bytes_per_probe(ChunkSection kind, const ChunkCounts& counts);

bool has_quantised_samples(const ChunkHeader& header);

// Throws BadInput unless the counts are in PackLimits, all sections together included.
void check_chunk_counts(const ChunkCounts& counts, const std::string& source);

std::vector<std::byte> write_chunk_header(const ChunkHeader& header);
// Checks everything that can be known without decompressing, the file's size included. Throws BadInput.
ChunkHeader read_chunk_header(std::span<const std::byte> chunk, const std::string& source);
std::uint64_t chunk_header_bytes(std::size_t section_count);

}  // namespace probewalk
