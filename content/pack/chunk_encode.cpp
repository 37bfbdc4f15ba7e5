// Probes to the bytes of a chunk.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "content/error.h"
#include "content/pack/chunk_layout.h"
#include "content/pack/pack_io.h"
#include "content/pack/sample_range.h"
#include "content/pack/sample_tiles.h"
#include "content/pack/section_transform.h"
#include "content/pack/zstd_stream.h"

namespace probewalk {

namespace {

[[noreturn]] void refuse(std::size_t probe, const std::string& what) {
  throw BadInput(fmt::format("cannot pack probe {}: {}", probe, what));
}

ChunkCounts counts_of(const RoomLevel& level) {
  if (level.probes.empty()) throw BadInput("cannot pack a room without probes");
  if (level.probes.size() > PackLimits::kProbesPerRoom) {
    throw BadInput(fmt::format("cannot pack {} probes in one room, at most {}; lower --max-probes", level.probes.size(),
                               PackLimits::kProbesPerRoom));
  }
  const ProbeMap& first = level.probes.front();
  const ChunkCounts counts{static_cast<std::uint32_t>(level.probes.size()),
                           static_cast<std::uint32_t>(std::max(first.geometry.n, 0)),
                           static_cast<std::uint32_t>(std::max(first.radiance.r, 0))};
  check_chunk_counts(counts, "cannot pack a room");
  return counts;
}

void check_probe(const ProbeMap& probe, std::size_t index, const ChunkCounts& counts) {
  const ProbeGeometry& g = probe.geometry;
  const ProbeRadiance& r = probe.radiance;
  if (g.n != static_cast<int>(counts.geometry_n) || r.r != static_cast<int>(counts.radiance_r) ||
      g.w.size() != vertex_count(counts) || g.edges_horizontal.size() != straight_edge_count(counts) ||
      g.edges_vertical.size() != straight_edge_count(counts) || g.edges_diagonal.size() != cell_count(counts) ||
      g.normals.size() != vertex_count(counts) || r.rgb9e5.size() != mip_texel_count(counts) ||
      r.texel_w.size() != texel_count(counts)) {
    refuse(index, "its arrays do not have the sizes of the room's first probe");
  }
  if (const auto bad = std::find_if_not(g.w.begin(), g.w.end(), is_storable_w); bad != g.w.end()) {
    refuse(index, fmt::format("sample {} is out of range", *bad));
  }
  for (const auto* edges : {&g.edges_horizontal, &g.edges_vertical, &g.edges_diagonal}) {
    if (!edges_in_range(*edges)) refuse(index, "an edge's cut is out of range");
  }
}

std::span<std::byte> put_bytes(std::span<const std::uint8_t> values, std::span<std::byte> out) {
  std::memcpy(out.data(), values.data(), values.size());
  return out.subspan(values.size());
}

void put_position(const ProbeMap& probe, const glm::dvec3& origin_m, std::span<std::byte> out) {
  const glm::vec3 relative(probe.geometry.position_m - origin_m);
  std::memcpy(out.data(), &relative, 3 * sizeof(float));
}

void put_probe(ChunkSection kind, const ProbeMap& probe, const RoomLevel& level, std::span<std::byte> out) {
  const ProbeGeometry& g = probe.geometry;
  switch (kind) {
    case ChunkSection::kPositions: put_position(probe, level.origin_m, out); break;
    case ChunkSection::kSamples: {
      std::vector<std::uint32_t> bits(g.w.size());
      std::memcpy(bits.data(), g.w.data(), g.w.size() * sizeof(float));
      const auto residuals = residuals_of<std::uint32_t>(bits, static_cast<std::size_t>(g.n) + 1);
      split_byte_planes<std::uint32_t>(residuals, out);
      break;
    }
    case ChunkSection::kEdges:
      put_bytes(g.edges_diagonal, put_bytes(g.edges_vertical, put_bytes(g.edges_horizontal, out)));
      break;
    case ChunkSection::kNormals: split_byte_planes<std::uint16_t>(g.normals, out); break;
    case ChunkSection::kRadiance: split_byte_planes<std::uint32_t>(probe.radiance.rgb9e5, out); break;
    case ChunkSection::kTexelW: {
      const auto side = static_cast<std::size_t>(probe.radiance.r);
      split_byte_planes<std::uint16_t>(residuals_of<std::uint16_t>(probe.radiance.texel_w, side), out);
      break;
    }
    case ChunkSection::kQuantisedSamples: {
      const TiledSamples tiled = encode_tiled_samples(g.w, static_cast<std::size_t>(g.n));
      std::memcpy(out.data(), tiled.bytes.data(), tiled.bytes.size());
      break;
    }
  }
}

struct Section {
  SectionEntry entry;
  std::vector<std::byte> stored;
};

Section make_section(ChunkSection kind, const RoomLevel& level, const ChunkCounts& counts) {
  const std::uint64_t per_probe = section_bytes_per_probe(kind, counts);
  std::vector<std::byte> raw(per_probe * counts.probes);
  for (std::size_t p = 0; p < level.probes.size(); ++p) {
    put_probe(kind, level.probes[p], level, std::span(raw).subspan(p * per_probe, per_probe));
  }
  Section section{{kind, ChunkCodec::kZstd, raw.size(), 0}, zstd_compress(raw)};
  if (section.stored.size() >= raw.size()) {
    section.entry.codec = ChunkCodec::kRaw;
    section.stored = std::move(raw);
  }
  section.entry.stored_bytes = section.stored.size();
  return section;
}

std::vector<std::byte> join_sections(const ChunkCounts& counts, const glm::dvec3& origin_m,
                                     const std::vector<Section>& sections) {
  ChunkHeader header{counts, origin_m, {}};
  for (const Section& section : sections) header.sections.push_back(section.entry);
  std::vector<std::byte> chunk = write_chunk_header(header);
  for (const Section& section : sections) chunk.insert(chunk.end(), section.stored.begin(), section.stored.end());
  return chunk;
}

}  // namespace

std::vector<std::byte> encode_chunk(const RoomLevel& level, SampleCoding samples, SampleSizes* sizes) {
  const ChunkCounts counts = counts_of(level);
  bool cuts = false, folded = true;
  for (std::size_t p = 0; p < level.probes.size(); ++p) {
    check_probe(level.probes[p], p, counts);
    cuts = cuts || has_cut(level.probes[p].geometry);
    folded = folded && has_folded_border(level.probes[p].geometry.w, counts.geometry_n);
    if (!folded && samples == SampleCoding::kQuantised) refuse(p, "its border is not folded onto itself");
  }
  if (!folded) samples = SampleCoding::kFloat;
  std::vector<ChunkSection> kinds{ChunkSection::kPositions};
  if (samples != SampleCoding::kQuantised) kinds.push_back(ChunkSection::kSamples);
  kinds.push_back(ChunkSection::kEdges);
  if (cuts) kinds.push_back(ChunkSection::kNormals);
  kinds.insert(kinds.end(), {ChunkSection::kRadiance, ChunkSection::kTexelW});
  if (samples != SampleCoding::kFloat) kinds.push_back(ChunkSection::kQuantisedSamples);

  std::vector<Section> sections(kinds.size());
  tbb::parallel_for(std::size_t{0}, kinds.size(),
                    [&](std::size_t s) { sections[s] = make_section(kinds[s], level, counts); });

  for (const Section& section : sections) {
    if (sizes && section.entry.kind == ChunkSection::kSamples) sizes->bytes_float = section.entry.stored_bytes;
    if (sizes && section.entry.kind == ChunkSection::kQuantisedSamples) sizes->bytes_quantised = section.entry.stored_bytes;
  }
  if (samples == SampleCoding::kSmaller) {
    const bool quantised = sections.back().entry.stored_bytes < sections[1].entry.stored_bytes;
    sections.erase(quantised ? sections.begin() + 1 : sections.end() - 1);
  }

  return join_sections(counts, level.origin_m, sections);
}

std::vector<std::byte> replace_radiance(std::span<const std::byte> chunk, std::vector<ProbeRadiance> radiance,
                                        const std::string& source) {
  const ChunkHeader header = read_chunk_header(chunk, source);
  RoomLevel level{header.room_origin_m, {}};
  if (radiance.size() != header.counts.probes)
    throw BadInput(source + ": it has another number of probes than radiance maps");
  for (ProbeRadiance& map : radiance) {
    if (map.r != static_cast<int>(header.counts.radiance_r) || map.rgb9e5.size() != mip_texel_count(header.counts) ||
        map.texel_w.size() != texel_count(header.counts)) {
      throw BadInput(source + ": its radiance maps have another size");
    }
    level.probes.push_back({{}, std::move(map)});
  }
  std::vector<Section> sections;
  std::size_t at = chunk_header_bytes(header.sections.size());
  for (const SectionEntry& entry : header.sections) {
    if (entry.kind == ChunkSection::kRadiance || entry.kind == ChunkSection::kTexelW) {
      sections.push_back(make_section(entry.kind, level, header.counts));
    } else {
      const auto stored = chunk.subspan(at, entry.stored_bytes);
      sections.push_back({entry, {stored.begin(), stored.end()}});
    }
    at += entry.stored_bytes;
  }
  return join_sections(header.counts, header.room_origin_m, sections);
}

}  // namespace probewalk
