// What pack.json says, as values. Reading checks every limit of pack_format.h and refuses non-finite numbers, bad ids,
// unknown versions and features by name.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "content/bake/placement.h"
#include "content/probe/tiled_samples.h"
#include "content/scene/space.h"

namespace probewalk {

// Of a pack with quantised levels; a reader that does not know it refuses the pack by this name.
inline constexpr const char* kQuantisedFeature = "quantised-samples";

struct LevelEntry {
  std::string chunk;  // 32 hex digits
  std::uint32_t geometry_size = 0;
  std::uint32_t radiance_size = 0;
  std::uint64_t bytes_disk = 0;
  std::uint64_t bytes_device = 0;  // with samples as floats
  double error = -1.0;  // measured; negative = not measured (null in JSON)
  bool quantised = false;  // its geometry's samples are (sample_tiles.h); the feature "quantised-samples" then
  std::uint64_t bytes_tiled = 0;  // on the device with samples in tiles; 0 = not stated: bytes_device or less

  std::uint64_t stated_bytes(DeviceSamples samples) const {
    return samples == DeviceSamples::kTiled && bytes_tiled > 0 ? bytes_tiled : bytes_device;
  }
};

struct RoomEntry {
  std::string id;
  std::string name;
  Bounds bounds;
  glm::dvec3 origin_m{0.0};
  std::uint32_t first_probe = 0;  // global index of its first probe; a room's probes are consecutive
  std::uint32_t probe_count = 0;
  std::vector<LevelEntry> levels;  // coarse to fine
};

// How the bake sampled light, so that a reference picture can do the same.
struct BakedLight {
  int samples = 0, bounces = 0;
  double cache_spacing_m = 0.0;
  std::uint32_t seed = 0;
  bool recentred = false;  // the scene was moved to the origin

  bool operator==(const BakedLight&) const = default;
};

struct Manifest {
  std::uint32_t format_version = 1;
  std::string producer;
  std::string scene_name;
  std::string scene_hash;
  std::string options_hash;
  double scale = 1.0;
  std::string scale_statement;
  std::string light_statement;
  std::optional<BakedLight> light;
  std::string credits;
  Bounds bounds;
  std::vector<std::string> features;  // known: "sky" (some probe sees it), "cuts", "quantised-samples"
  double radiance_scale = 1.0;
  double exposure_ev = 0.0;
  std::vector<RoomEntry> rooms;
  std::vector<Portal> portals;
  ProbeGrid grid;                          // building-wide; entries are global probe indices
  std::vector<glm::dvec3> probe_positions_m;  // true positions, by global index
  FloorMap floor;
  Pose start;
  std::vector<Pose> tour;
  std::vector<std::string> warnings;

  std::uint64_t bytes_disk() const;    // sum over chunks
  // With every level resident.
  std::uint64_t bytes_device(DeviceSamples samples = kDefaultSamples) const;
};

// Parses and checks; `source` names the text in errors. Throws BadInput.
Manifest parse_manifest(const std::string& text, const std::string& source);
std::string serialise_manifest(const Manifest& manifest);

}  // namespace probewalk
