// Packs on disk: encode and decode chunks, write and open packs, verify.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "content/pack/manifest.h"
#include "content/probe/probe_map.h"
#include "content/progress.h"

namespace probewalk {

// All probes of one room at one level.
struct RoomLevel {
  glm::dvec3 origin_m{0.0};
  std::vector<ProbeMap> probes;  // all of the same sizes
};

enum class SampleCoding {
  kFloat,      // to the bit
  kQuantised,  // within kStraySampleError, on planes kPlaneSampleError (sample_tiles.h)
  kSmaller,    // whichever takes fewer bytes
};

// What a chunk's samples take in each coding that was tried; 0 = was not.
struct SampleSizes {
  std::uint64_t bytes_float = 0, bytes_quantised = 0;
};

// Deterministic. Positions are stored relative to origin_m in float. Maps whose border is not folded onto itself, which
// nothing bakes, can be kept to the bit only: kQuantised refuses them.
std::vector<std::byte> encode_chunk(const RoomLevel& level, SampleCoding samples = SampleCoding::kFloat,
                                    SampleSizes* sizes = nullptr);
// Refuses anything out of the format or its limits, non-finite or negative samples, positions off by kCoordinate_m.
// `source` names the chunk in errors. Throws BadInput.
RoomLevel decode_chunk(std::span<const std::byte> bytes, const std::string& source);
// XXH3-128 as 32 lower-case hex digits.
std::string content_hash(std::span<const std::byte> bytes);
// XXH3-64, where millions are kept.
std::uint64_t short_hash(std::span<const std::byte> bytes, std::uint64_t seed = 0);

// A chunk of the same probes with other radiance: the bytes that encode_chunk makes of both, without coding the
// geometry again. `chunk` is one that a bake of the same producer has made; `radiance` has one map a probe. Throws
// BadInput.
std::vector<std::byte> replace_radiance(std::span<const std::byte> chunk, std::vector<ProbeRadiance> radiance,
                                        const std::string& source);

// Bytes of chunks/<hash> in the folder `pack`, exactly bytes_disk of them, hash checked. Throws BadInput. Thread-safe.
std::vector<std::byte> read_chunk_file(const std::filesystem::path& pack, const std::string& hash,
                                       std::uint64_t bytes_disk);

// Decodes the chunk of a room's level and checks that it is the one the manifest means: number, sizes and positions of
// its probes. Throws BadInput. Thread-safe.
RoomLevel decode_level(const Manifest& manifest, std::size_t room, std::size_t level, std::span<const std::byte> bytes);

class PackWriter {
 public:
  // Creates the folder (and `chunks/`) if needed.
  explicit PackWriter(std::filesystem::path pack);
  // Writes chunks/<hash> by rename (nothing when it is there already); returns the hash.
  std::string add_chunk(std::span<const std::byte> bytes);
  // Writes pack.json last, by rename, then removes chunks that it does not name.
  void finish(const Manifest& manifest);

 private:
  std::filesystem::path pack_;
};

class Pack {
 public:
  // A pack whose list of rooms is known; `path` is what it is called.
  Pack(std::filesystem::path path, Manifest manifest) : path_(std::move(path)), manifest_(std::move(manifest)) {}
  // Reads and checks the manifest. Throws BadInput: missing, foreign, truncated, edited.
  static Pack open(const std::filesystem::path& pack);
  const Manifest& manifest() const { return manifest_; }
  const std::filesystem::path& path() const { return path_; }
  // The chunk's bytes, hash checked. Throws BadInput. Thread-safe.
  std::vector<std::byte> read_chunk(const LevelEntry& level) const;
  RoomLevel read_level(std::size_t room, std::size_t level) const;
  // Reads and checks every byte; one line per damaged chunk. Empty = sound.
  std::vector<std::string> verify(Progress& progress) const;

 private:
  std::filesystem::path path_;
  Manifest manifest_;
};

}  // namespace probewalk
