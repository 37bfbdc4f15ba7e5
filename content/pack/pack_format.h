// The pack format, version 1: this header is its normative text.
//
// A pack is a folder NAME.probes/ with one manifest `pack.json` and immutable chunks `chunks/<32 lower-case hex digits>`,
// the name being the XXH3-128 of the file's bytes. The manifest is written last, by rename; its member "manifest_hash"
// is the XXH3-128 (hex) of the manifest's canonical text (keys sorted, no white space) without that member.
//
// A chunk is one room at one level. Little endian:
//   char magic[8] = "PWCHUNK1"; u32 version = 1; u32 probe_count; u32 geometry_n; u32 radiance_r;
//   u32 section_count; u32 reserved = 0; f64 room_origin_m[3];
//   section_count times { u32 kind; u32 codec; u64 raw_bytes; u64 stored_bytes; }; then the sections' bytes in order.
// Each section covers all probes of the chunk in order and is compressed by itself. Kinds, codecs and the transform
// before compression are the enums below. raw_bytes is implied by the counts and checked before anything is allocated.
#pragma once

#include <array>
#include <cstdint>

namespace probewalk {

inline constexpr std::uint32_t kPackFormatVersion = 1;
inline constexpr std::array<char, 8> kChunkMagic{'P', 'W', 'C', 'H', 'U', 'N', 'K', '1'};

enum class ChunkSection : std::uint32_t {
  kPositions = 1,  // probe_count * 3 f32: position relative to room_origin_m
  kSamples = 2,    // probe_count * (n+1)^2 f32: w. Transform: plane predictor on the bit patterns, byte planes
  kEdges = 3,      // probe_count * (2 n (n+1) + n^2) u8: horizontal, vertical, diagonal
  kNormals = 4,    // probe_count * (n+1)^2 u16; absent when no probe of the chunk has a cut
  kRadiance = 5,   // probe_count * mip chain of r^2 u32 E5B9G9R9, byte planes
  kTexelW = 6,     // probe_count * r^2 u16, delta along rows, byte planes
};
// Codec of a section. A reader refuses codes it does not know, by number.
enum class ChunkCodec : std::uint32_t { kRaw = 0, kZstd = 1 };

// What a reader accepts. Checked before anything is allocated.
struct PackLimits {
  static constexpr std::uint64_t kManifestBytes = 64ull << 20;
  static constexpr std::uint32_t kRooms = 65536;
  static constexpr std::uint32_t kProbesPerRoom = 4096;
  static constexpr std::uint32_t kMapSide = 8192;
  static constexpr std::uint32_t kMinMapSide = 8;
  static constexpr std::uint32_t kLevels = 16;
  static constexpr std::uint32_t kSections = 32;
  static constexpr std::uint64_t kChunkRawBytes = 8ull << 30;
  static constexpr int kZstdWindowLog = 23;  // 8 MiB
  static constexpr double kCoordinate_m = 1e7;
};

}  // namespace probewalk
