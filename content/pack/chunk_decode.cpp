// The bytes of a chunk to probes. The bytes are hostile until every check has passed.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include "content/error.h"
#include "content/pack/chunk_layout.h"
#include "content/pack/pack_io.h"
#include "content/pack/sample_range.h"
#include "content/pack/sample_tiles.h"
#include "content/pack/section_transform.h"
#include "content/pack/zstd_stream.h"

namespace probewalk {

namespace {

[[noreturn]] void refuse(const std::string& source, const std::string& what) {
  throw BadInput(fmt::format("{}: {}; bake the pack again or copy it anew", source, what));
}

// A section's raw bytes, front to back.
class SectionReader {
 public:
  SectionReader(const SectionEntry& entry, std::span<const std::byte> stored, const std::string& source)
      : kind_(entry.kind), stored_(stored), source_(source) {
    if (entry.codec == ChunkCodec::kZstd) stream_.emplace(stored);
  }

  void read(std::span<std::byte> out) {
    if (stream_) {
      if (!stream_->read(out)) {
        refuse(source_, fmt::format("section {} does not decompress", static_cast<std::uint32_t>(kind_)));
      }
    } else {
      std::memcpy(out.data(), stored_.data(), out.size());
      stored_ = stored_.subspan(out.size());
    }
  }

  void finish() {
    if (stream_ && !stream_->at_end()) {
      refuse(source_, fmt::format("section {} holds more than its counts say", static_cast<std::uint32_t>(kind_)));
    }
  }

 private:
  ChunkSection kind_;
  std::span<const std::byte> stored_;
  const std::string& source_;
  std::optional<ZstdStream> stream_;
};

template <class Word>
std::vector<Word> read_planes(SectionReader& section, std::vector<std::byte>& scratch, std::size_t count) {
  scratch.resize(count * sizeof(Word));
  section.read(scratch);
  std::vector<Word> words(count);
  join_byte_planes<Word>(scratch, words);
  return words;
}

std::vector<std::uint8_t> read_edges(SectionReader& section, std::size_t count, const std::string& source) {
  std::vector<std::uint8_t> edges(count);
  section.read(std::as_writable_bytes(std::span(edges)));
  if (!edges_in_range(edges)) refuse(source, fmt::format("a cut lies beyond step {}", kCutSteps));
  return edges;
}

glm::dvec3 read_position(SectionReader& section, const glm::dvec3& origin_m, const std::string& source) {
  glm::vec3 relative;
  section.read(std::as_writable_bytes(std::span(&relative, 1)));
  const glm::dvec3 position_m = origin_m + glm::dvec3(relative);
  for (int axis = 0; axis < 3; ++axis) {
    if (!(std::abs(position_m[axis]) <= PackLimits::kCoordinate_m)) {
      refuse(source, fmt::format("probe position {} m is out of range", position_m[axis]));
    }
  }
  return position_m;
}

std::vector<float> read_samples(SectionReader& section, std::vector<std::byte>& scratch, const ChunkCounts& counts,
                                const std::string& source) {
  auto bits = read_planes<std::uint32_t>(section, scratch, vertex_count(counts));
  restore_from_residuals<std::uint32_t>(bits, counts.geometry_n + 1);
  std::vector<float> w(bits.size());
  std::memcpy(w.data(), bits.data(), bits.size() * sizeof(float));
  if (const auto bad = std::find_if_not(w.begin(), w.end(), is_storable_w); bad != w.end()) {
    refuse(source, fmt::format("sample {} is out of range", *bad));
  }
  return w;
}

std::vector<float> read_quantised_samples(SectionReader& section, std::vector<std::byte>& scratch,
                                          const ChunkCounts& counts, const std::string& source) {
  scratch.resize(tiled_sample_bytes(counts.geometry_n));
  section.read(scratch);
  std::vector<float> w(vertex_count(counts));
  if (!decode_tiled_samples(scratch, counts.geometry_n, w)) {
    refuse(source, "a quantised sample is out of range or not of the format");
  }
  return w;
}

}  // namespace

RoomLevel decode_chunk(std::span<const std::byte> bytes, const std::string& source) {
  const ChunkHeader header = read_chunk_header(bytes, source);
  const ChunkCounts& counts = header.counts;
  RoomLevel level{header.room_origin_m, {}};
  // Probes are made as the first section's data come, so that memory follows the file's real contents.
  std::vector<std::byte> scratch;
  std::size_t offset = chunk_header_bytes(header.sections.size());
  bool cuts = false, normals = false;
  for (const SectionEntry& entry : header.sections) {
    SectionReader section(entry, bytes.subspan(offset, entry.stored_bytes), source);
    offset += entry.stored_bytes;
    for (std::uint32_t p = 0; p < counts.probes; ++p) {
      if (entry.kind == ChunkSection::kPositions) level.probes.emplace_back();
      ProbeGeometry& g = level.probes[p].geometry;
      ProbeRadiance& r = level.probes[p].radiance;
      switch (entry.kind) {
        case ChunkSection::kPositions:
          g.position_m = read_position(section, header.room_origin_m, source);
          g.n = static_cast<int>(counts.geometry_n);
          r.r = static_cast<int>(counts.radiance_r);
          break;
        case ChunkSection::kQuantisedSamples: g.w = read_quantised_samples(section, scratch, counts, source); break;
        case ChunkSection::kSamples: g.w = read_samples(section, scratch, counts, source); break;
        case ChunkSection::kEdges:
          g.edges_horizontal = read_edges(section, straight_edge_count(counts), source);
          g.edges_vertical = read_edges(section, straight_edge_count(counts), source);
          g.edges_diagonal = read_edges(section, cell_count(counts), source);
          cuts = cuts || has_cut(g);
          break;
        case ChunkSection::kNormals:
          g.normals = read_planes<std::uint16_t>(section, scratch, vertex_count(counts));
          normals = true;
          break;
        case ChunkSection::kRadiance:
          r.rgb9e5 = read_planes<std::uint32_t>(section, scratch, mip_texel_count(counts));
          break;
        case ChunkSection::kTexelW:
          r.texel_w = read_planes<std::uint16_t>(section, scratch, texel_count(counts));
          restore_from_residuals<std::uint16_t>(r.texel_w, counts.radiance_r);
          break;
      }
    }
    section.finish();
  }
  if (cuts && !normals) refuse(source, "has cuts but no normals");
  if (!normals) {
    for (ProbeMap& probe : level.probes) probe.geometry.normals.assign(vertex_count(counts), 0);
  }
  return level;
}

}  // namespace probewalk
