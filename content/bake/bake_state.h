// What an interrupted bake keeps: the indirect light and finished maps, one file each, in a folder beside the pack. A file
// is only believed when it was made by the same bake (its key) and is whole (its hash).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "content/bake/cached_light.h"
#include "content/bake/rebake/map_inputs.h"
#include "content/probe/probe_map.h"

namespace probewalk {

class BakeState {
 public:
  // key: 32 hex digits that name scene and options. What another bake kept is removed.
  BakeState(std::filesystem::path folder, std::string key);

  // Whether this very bake has left its state there.
  static bool is_there(const std::filesystem::path& folder, const std::string& key);

  // The light cache's values (LightField::cache_values). Empty when it is not there or cannot be believed.
  std::vector<CachedLight> load_light() const;
  // Throws BadInput when the disk is full.
  void store_light(const std::vector<CachedLight>& values) const;

  // A map by the place it was baked from and its size, and what it was made of. Nothing when it is not there or cannot
  // be believed.
  std::optional<ProbeGeometry> load_geometry(glm::dvec3 position_m, int n, MapInputs& inputs) const;
  std::optional<ProbeRadiance> load_radiance(glm::dvec3 position_m, int r, MapInputs& inputs) const;
  // Throw BadInput when the disk is full.
  void store(const ProbeGeometry& map, const MapInputs& inputs) const;
  void store(glm::dvec3 position_m, const ProbeRadiance& map, const MapInputs& inputs) const;
  // After the manifest is written.
  void remove() const;

 private:
  std::filesystem::path file(const char* kind, glm::dvec3 position_m, int side) const;
  template <typename Map>
  bool load_map(const std::filesystem::path& file, Map& map, MapInputs& inputs) const;
  template <typename Map>
  void store_map(const std::filesystem::path& file, const Map& map, const MapInputs& inputs) const;

  std::filesystem::path folder_;
  std::string key_;
};

}  // namespace probewalk
