#include "content/pack/chunk_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "content/error.h"
#include "content/pack/sample_tiles.h"

namespace probewalk {

namespace {

static_assert(std::endian::native == std::endian::little, "packs are read and written in place, little endian");

constexpr std::uint64_t kFixedHeaderBytes = 8 + 6 * 4 + 3 * 8;
constexpr std::uint64_t kSectionEntryBytes = 4 + 4 + 8 + 8;

[[noreturn]] void refuse(const std::string& source, const std::string& what) {
  throw BadInput(fmt::format("{}: {}; bake the pack again or copy it anew", source, what));
}

template <class T>
void put(std::vector<std::byte>& out, T value) {
  const auto bytes = std::bit_cast<std::array<std::byte, sizeof(T)>>(value);
  out.insert(out.end(), bytes.begin(), bytes.end());
}

// The caller has checked that the bytes are there.
template <class T>
T take(std::span<const std::byte>& in) {
  T value;
  std::memcpy(&value, in.data(), sizeof(T));
  in = in.subspan(sizeof(T));
  return value;
}

void check_side(std::uint32_t side, const char* what, const std::string& source) {
  if (side < PackLimits::kMinMapSide || side > PackLimits::kMapSide || !std::has_single_bit(side)) {
    refuse(source, fmt::format("{} size {} is not a power of two from {} to {}", what, side, PackLimits::kMinMapSide,
                               PackLimits::kMapSide));
  }
}

}  // namespace

std::uint64_t section_bytes_per_probe(ChunkSection kind, const ChunkCounts& counts) {
  switch (kind) {
    case ChunkSection::kPositions: return 3 * sizeof(float);
    case ChunkSection::kSamples: return vertex_count(counts) * sizeof(float);
    case ChunkSection::kEdges: return 2 * straight_edge_count(counts) + cell_count(counts);
    case ChunkSection::kNormals: return vertex_count(counts) * sizeof(std::uint16_t);
    case ChunkSection::kRadiance: return mip_texel_count(counts) * sizeof(std::uint32_t);
    case ChunkSection::kTexelW: return texel_count(counts) * sizeof(std::uint16_t);
    case ChunkSection::kQuantisedSamples: return tiled_sample_bytes(counts.geometry_n);
  }
  return 0;
}

bool has_quantised_samples(const ChunkHeader& header) {
  return std::any_of(header.sections.begin(), header.sections.end(),
                     [](const SectionEntry& section) { return section.kind == ChunkSection::kQuantisedSamples; });
}

std::uint64_t chunk_header_bytes(std::size_t section_count) {
  return kFixedHeaderBytes + section_count * kSectionEntryBytes;
}

void check_chunk_counts(const ChunkCounts& counts, const std::string& source) {
  if (counts.probes == 0 || counts.probes > PackLimits::kProbesPerRoom) {
    refuse(source,
           fmt::format("{} probes in one room; 1 to {} are allowed", counts.probes, PackLimits::kProbesPerRoom));
  }
  check_side(counts.geometry_n, "geometry", source);
  check_side(counts.radiance_r, "radiance", source);
  std::uint64_t per_probe = 0;
  for (std::uint32_t kind = 1; kind <= static_cast<std::uint32_t>(ChunkSection::kQuantisedSamples); ++kind) {
    per_probe += section_bytes_per_probe(static_cast<ChunkSection>(kind), counts);
  }
  per_probe -= section_bytes_per_probe(ChunkSection::kSamples, counts);  // one or the other; these are fewer
  if (per_probe > PackLimits::kChunkRawBytes / counts.probes) {
    refuse(source, fmt::format("{} probes of {} and {} a side make more than {} GiB in one room", counts.probes,
                               counts.geometry_n, counts.radiance_r, PackLimits::kChunkRawBytes >> 30));
  }
}

std::vector<std::byte> write_chunk_header(const ChunkHeader& header) {
  std::vector<std::byte> out;
  for (const char c : kChunkMagic) put(out, c);
  put(out, kPackFormatVersion);
  put(out, header.counts.probes);
  put(out, header.counts.geometry_n);
  put(out, header.counts.radiance_r);
  put(out, static_cast<std::uint32_t>(header.sections.size()));
  put(out, std::uint32_t{0});
  for (int axis = 0; axis < 3; ++axis) put(out, header.room_origin_m[axis]);
  for (const SectionEntry& section : header.sections) {
    put(out, static_cast<std::uint32_t>(section.kind));
    put(out, static_cast<std::uint32_t>(section.codec));
    put(out, section.raw_bytes);
    put(out, section.stored_bytes);
  }
  return out;
}

ChunkHeader read_chunk_header(std::span<const std::byte> chunk, const std::string& source) {
  if (chunk.size() < kFixedHeaderBytes) refuse(source, fmt::format("truncated: {} bytes are no chunk", chunk.size()));
  std::span<const std::byte> in = chunk;
  if (std::memcmp(in.data(), kChunkMagic.data(), kChunkMagic.size()) != 0) refuse(source, "is not a probe chunk");
  in = in.subspan(kChunkMagic.size());
  if (const auto version = take<std::uint32_t>(in); version != kPackFormatVersion) {
    throw BadInput(fmt::format("{}: chunk version {} is not known, this probewalk reads {}; update probewalk or bake "
                               "the pack again", source, version, kPackFormatVersion));
  }
  ChunkHeader header;
  header.counts.probes = take<std::uint32_t>(in);
  header.counts.geometry_n = take<std::uint32_t>(in);
  header.counts.radiance_r = take<std::uint32_t>(in);
  const auto section_count = take<std::uint32_t>(in);
  if (const auto reserved = take<std::uint32_t>(in); reserved != 0) {
    refuse(source, fmt::format("reserved word is {}, not 0", reserved));
  }
  for (int axis = 0; axis < 3; ++axis) {
    header.room_origin_m[axis] = take<double>(in);
    if (!(std::abs(header.room_origin_m[axis]) <= PackLimits::kCoordinate_m)) {
      refuse(source, fmt::format("room origin {} m is out of range", header.room_origin_m[axis]));
    }
  }
  check_chunk_counts(header.counts, source);
  if (section_count > PackLimits::kSections) refuse(source, fmt::format("{} sections are too many", section_count));
  if (chunk.size() < chunk_header_bytes(section_count)) refuse(source, "truncated in its table of sections");

  std::uint64_t left = chunk.size() - chunk_header_bytes(section_count);
  std::uint32_t last_kind = 0, kinds = 0;
  for (std::uint32_t s = 0; s < section_count; ++s) {
    const auto kind = take<std::uint32_t>(in);
    const auto codec = take<std::uint32_t>(in);
    SectionEntry section{static_cast<ChunkSection>(kind), static_cast<ChunkCodec>(codec), take<std::uint64_t>(in),
                         take<std::uint64_t>(in)};
    if (kind < static_cast<std::uint32_t>(ChunkSection::kPositions) ||
        kind > static_cast<std::uint32_t>(ChunkSection::kQuantisedSamples)) {
      refuse(source, fmt::format("section kind {} is not known", kind));
    }
    if (kind <= last_kind) refuse(source, fmt::format("section kind {} is out of order", kind));
    last_kind = kind;
    kinds |= 1u << kind;
    if (codec > static_cast<std::uint32_t>(ChunkCodec::kZstd)) {
      refuse(source, fmt::format("section codec {} is not known", codec));
    }
    const std::uint64_t expected = header.counts.probes * section_bytes_per_probe(section.kind, header.counts);
    if (section.raw_bytes != expected) {
      refuse(source,
             fmt::format("section {} claims {} bytes where its counts make {}", kind, section.raw_bytes, expected));
    }
    if (section.codec == ChunkCodec::kRaw && section.stored_bytes != section.raw_bytes) {
      refuse(source, fmt::format("raw section {} stores {} bytes for {}", kind, section.stored_bytes, expected));
    }
    if (section.stored_bytes > left) refuse(source, fmt::format("truncated in section {}", kind));
    left -= section.stored_bytes;
    header.sections.push_back(section);
  }
  if (left != 0) refuse(source, fmt::format("{} bytes too many at its end", left));
  const auto bit = [](ChunkSection kind) { return 1u << static_cast<std::uint32_t>(kind); };
  const std::uint32_t quantised = bit(ChunkSection::kQuantisedSamples), samples = bit(ChunkSection::kSamples);
  if ((kinds & quantised) != 0 && (kinds & samples) != 0) refuse(source, "has its samples twice");
  if ((kinds & quantised) != 0) kinds = (kinds ^ quantised) | samples;
  constexpr std::uint32_t kAllKinds = 0b1111110;
  if ((kinds | bit(ChunkSection::kNormals)) != kAllKinds) refuse(source, "lacks a section");
  return header;
}

}  // namespace probewalk
