// The pack format, version 1: this header is its normative text. Everything is little endian.
//
// THE FOLDER. A pack is a folder NAME.probes/ with one manifest `pack.json` and immutable chunks
// `chunks/<32 lower-case hex digits>`. A chunk's name is the XXH3-128 (seed 0) of the file's bytes, most significant
// digit first, as `xxhsum -H2` prints it. The manifest is written last and by rename; manifest.h and manifest_json.cpp
// say what it holds. Its member "manifest_hash" is the XXH3-128 of the whole file with the 32 digits of that member's
// value replaced by 32 zeros.
//
// A CHUNK is one room at one level:
//   char magic[8] = "PWCHUNK1"; u32 version = 1; u32 probe_count; u32 geometry_n; u32 radiance_r;
//   u32 section_count; u32 reserved = 0; f64 room_origin_m[3];
//   section_count times { u32 kind; u32 codec; u64 raw_bytes; u64 stored_bytes; }, kinds strictly ascending;
//   then the sections' stored bytes in the same order. Nothing lies between or behind them.
// Every kind below is present once, but for kNormals, which may be absent, and kSamples and kQuantisedSamples, of which
// one is there. A section is the concatenation, probe after probe, of
// that probe's array after the kind's transform; raw_bytes is its size, implied by the counts; the codec then
// compresses the section as a whole (kZstd: one or more zstd frames, window at most 2^kZstdWindowLog bytes).
//
// TRANSFORMS, each on one probe's array of `bits`-bit unsigned words (floats by their bit patterns):
//   prediction  The array is a grid of `side` columns. With a = left, b = up and c = upper left neighbour, a word is
//               predicted as a + b - c, in the first row as a, in the first column as b, the first word as 0. What is
//               stored is the residual (word - prediction) mod 2^bits as a zig-zag code: with s the residual read as a
//               two's complement number, 2 s for s >= 0 and -2 s - 1 for s < 0. Planes of the world are affine in w
//               over the map and a float's bits are affine in its value within an octave, so that little but rounding
//               is left.
//   byte planes The words' most significant bytes, all of them in order, then the next bytes, down to the least.
// Both where both are named: prediction first.
#pragma once

#include <array>
#include <cstdint>

namespace probewalk {

inline constexpr std::uint32_t kPackFormatVersion = 1;
inline constexpr std::array<char, 8> kChunkMagic{'P', 'W', 'C', 'H', 'U', 'N', 'K', '1'};

// Content of a section, per probe, with n = geometry_n and r = radiance_r; both are powers of two. Layouts as in
// content/probe/probe_map.h.
enum class ChunkSection : std::uint32_t {
  kPositions = 1,  // 3 f32: position minus room_origin_m. No transform
  kSamples = 2,    // (n+1)^2 f32: w. Prediction with side n+1, byte planes
  kEdges = 3,      // 2 n (n+1) + n^2 u8: horizontal, vertical, diagonal; 0..64. No transform
  kNormals = 4,    // (n+1)^2 u16. Byte planes. Absent when the chunk has no cut; then all are 0
  kRadiance = 5,   // mips of r^2, (r/2)^2 ... 1 u32 E5B9G9R9. Byte planes
  kTexelW = 6,     // r^2 u16. Prediction with side r, byte planes
  // The same samples as kSamples, each within kStraySampleError of what it was, in about a third of the bytes. Transform:
  // content/pack/sample_tiles.cpp. The manifest names the feature "quantised-samples" where a chunk has them.
  kQuantisedSamples = 7,
};

// A reader refuses codes it does not know, by number.
enum class ChunkCodec : std::uint32_t { kRaw = 0, kZstd = 1 };

// What a reader accepts. Checked before anything is allocated.
struct PackLimits {
  static constexpr std::uint64_t kManifestBytes = 64ull << 20;
  // Parsed JSON takes far more memory than its text: 16 bytes a value, 50 more for each list, object or text.
  static constexpr std::uint64_t kManifestValues = 1ull << 24;
  static constexpr std::uint64_t kManifestNested = 1ull << 22;  // lists, objects and texts
  static constexpr std::uint32_t kRooms = 65536;
  static constexpr std::uint32_t kProbesPerRoom = 4096;
  static constexpr std::uint32_t kMapSide = 8192;
  static constexpr std::uint32_t kMinMapSide = 8;
  static constexpr std::uint32_t kLevels = 16;
  static constexpr std::uint32_t kSections = 32;
  static constexpr std::uint64_t kChunkRawBytes = 8ull << 30;
  static constexpr std::uint64_t kDeviceBytesPerLevel = 64ull << 30;
  static constexpr int kZstdWindowLog = 23;  // 8 MiB
  static constexpr double kCoordinate_m = 1e7;
  // Samples other than the sky's 0: from a micrometre to beyond any coordinate, far from denormals.
  static constexpr float kLeastW_per_m = 1e-9f;
  static constexpr float kGreatestW_per_m = 1e6f;
  static constexpr std::uint64_t kGridVertices = 1ull << 24;
  static constexpr std::uint32_t kFloorNodes = 1u << 22;
  static constexpr std::int32_t kFloorColumns = 1 << 16;  // a side
  static constexpr std::uint32_t kPortals = 1u << 18;
  static constexpr std::uint32_t kPortalCorners = 64;
  static constexpr std::uint32_t kTourPoses = 1u << 18;
  static constexpr std::uint32_t kWarnings = 4096;
  static constexpr std::uint32_t kTextBytes = 1u << 20;  // of one string
};

}  // namespace probewalk
