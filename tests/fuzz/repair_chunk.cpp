#include "fuzz/repair_chunk.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "content/pack/chunk_layout.h"
#include "content/pack/sample_range.h"
#include "content/pack/sample_tiles.h"
#include "content/pack/section_transform.h"
#include "content/pack/zstd_stream.h"

namespace probewalk::fuzz {

namespace {

constexpr std::uint32_t kMaxProbes = 3;
constexpr std::uint32_t kSides = 3;  // 8, 16, 32

// Values from the front of some bytes; zeros behind their end.
class Source {
 public:
  explicit Source(std::span<const std::byte> bytes) : bytes_(bytes) {}

  std::vector<std::byte> take(std::uint64_t count) {
    std::vector<std::byte> out(count);
    const std::size_t there = std::min<std::size_t>(count, bytes_.size());
    std::copy_n(bytes_.begin(), there, out.begin());
    bytes_ = bytes_.subspan(there);
    return out;
  }
  template <class T>
  T value() {
    T out;
    std::memcpy(&out, take(sizeof(T)).data(), sizeof(T));
    return out;
  }
  template <class Word>
  std::vector<Word> planes(std::uint64_t count) {
    std::vector<Word> words(count);
    join_byte_planes<Word>(take(count * sizeof(Word)), words);
    return words;
  }
  std::span<const std::byte> left() const { return bytes_; }

 private:
  std::span<const std::byte> bytes_;
};

std::uint32_t side_near(std::uint32_t stated) {
  const bool small = stated >= 8 && stated < (8u << kSides) && std::has_single_bit(stated);
  return small ? stated : 8u << (stated % kSides);
}

double coordinate_near(double stated, double limit) { return std::abs(stated) <= limit ? stated : 0.0; }

// The stored bits with an exponent that a sample may have; zero stays the sky.
float sample_near(std::uint32_t bits) {
  const float w = std::abs(std::bit_cast<float>(bits));
  if (is_storable_w(w)) return w;
  return 0.001f * static_cast<float>(1 + bits % 4096);
}

std::vector<std::uint8_t> edges(Source& source, std::uint64_t count) {
  std::vector<std::uint8_t> out;
  for (const std::byte byte : source.take(count)) {
    out.push_back(static_cast<std::uint8_t>(std::to_integer<unsigned>(byte) % (kCutSteps + 1)));
  }
  return out;
}

void read_section(Source source, ChunkSection kind, const ChunkCounts& counts, RoomLevel& level) {
  for (ProbeMap& probe : level.probes) {
    ProbeGeometry& g = probe.geometry;
    switch (kind) {
      case ChunkSection::kPositions:
        for (int axis = 0; axis < 3; ++axis) {
          // As a chunk holds it: a float beside the origin.
          g.position_m[axis] = level.origin_m[axis] + coordinate_near(static_cast<double>(source.value<float>()), 4e6);
        }
        break;
      case ChunkSection::kSamples: {
        std::vector<std::uint32_t> bits = source.planes<std::uint32_t>(vertex_count(counts));
        restore_from_residuals<std::uint32_t>(bits, counts.geometry_n + 1);
        g.w.clear();
        for (const std::uint32_t word : bits) g.w.push_back(sample_near(word));
        break;
      }
      case ChunkSection::kQuantisedSamples: {
        const std::vector<std::byte> bytes = source.take(tiled_sample_bytes(counts.geometry_n));
        g.w.resize(vertex_count(counts));
        if (decode_tiled_samples(bytes, counts.geometry_n, g.w)) break;
        for (float& w : g.w) w = sample_near(std::bit_cast<std::uint32_t>(w));
        break;
      }
      case ChunkSection::kEdges:
        g.edges_horizontal = edges(source, straight_edge_count(counts));
        g.edges_vertical = edges(source, straight_edge_count(counts));
        g.edges_diagonal = edges(source, cell_count(counts));
        break;
      case ChunkSection::kNormals: g.normals = source.planes<std::uint16_t>(vertex_count(counts)); break;
      case ChunkSection::kRadiance:
        probe.radiance.rgb9e5 = source.planes<std::uint32_t>(mip_texel_count(counts));
        break;
      case ChunkSection::kTexelW:
        probe.radiance.texel_w = source.planes<std::uint16_t>(texel_count(counts));
        restore_from_residuals<std::uint16_t>(probe.radiance.texel_w, counts.radiance_r);
        break;
    }
  }
}

}  // namespace

RoomLevel repaired_level(std::span<const std::byte> damaged) {
  Source header(damaged);
  header.take(12);  // magic, version
  ChunkCounts counts;
  counts.probes = 1 + (header.value<std::uint32_t>() + kMaxProbes - 1) % kMaxProbes;
  counts.geometry_n = side_near(header.value<std::uint32_t>());
  counts.radiance_r = side_near(header.value<std::uint32_t>());
  const std::uint32_t section_count = std::min(header.value<std::uint32_t>(), 6u);
  header.take(4);
  RoomLevel level;
  for (int axis = 0; axis < 3; ++axis) level.origin_m[axis] = coordinate_near(header.value<double>(), 4e6);
  level.probes.resize(counts.probes);
  for (ProbeMap& probe : level.probes) {
    probe.geometry.n = static_cast<int>(counts.geometry_n);
    probe.radiance.r = static_cast<int>(counts.radiance_r);
  }
  // Whatever has no section in the bytes is read from none: zeros.
  for (std::uint32_t kind = 1; kind <= 6; ++kind)
    read_section(Source({}), static_cast<ChunkSection>(kind), counts, level);

  Source table(header.left());
  Source body(damaged.subspan(std::min<std::size_t>(chunk_header_bytes(section_count), damaged.size())));
  for (std::uint32_t s = 0; s < section_count; ++s) {
    const auto kind = static_cast<ChunkSection>(1 + (table.value<std::uint32_t>() + 6) % 7);
    const bool packed = table.value<std::uint32_t>() == static_cast<std::uint32_t>(ChunkCodec::kZstd);
    table.take(8);
    const auto stored = table.value<std::uint64_t>();
    const std::uint64_t raw_bytes = counts.probes * section_bytes_per_probe(kind, counts);
    const std::vector<std::byte> bytes =
        body.take(std::min<std::uint64_t>(packed ? stored : raw_bytes, body.left().size()));
    if (!packed) {
      read_section(Source(bytes), kind, counts, level);
    } else {
      std::vector<std::byte> raw(raw_bytes);
      ZstdStream stream(bytes);
      stream.read(raw);  // as much as there is
      read_section(Source(raw), kind, counts, level);
    }
  }
  return level;
}

}  // namespace probewalk::fuzz
