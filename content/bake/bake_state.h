// What an interrupted bake keeps: the indirect light and finished probes, one file each, in a folder beside the pack. A file is only believed
// when it was made by the same bake (its key) and is whole (its hash).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "content/probe/probe_map.h"

namespace probewalk {

class BakeState {
 public:
  // key: 32 hex digits that name scene and options. Probes kept by another bake are removed.
  BakeState(std::filesystem::path folder, std::string key);

  // The light cache's values (LightField::cache_values). Empty when it is not there or cannot be believed.
  std::vector<glm::vec3> load_light() const;
  // Throws BadInput when the disk is full.
  void store_light(const std::vector<glm::vec3>& values) const;

  // Nothing when it is not there or cannot be believed.
  std::optional<ProbeMap> load(std::size_t probe, glm::dvec3 position_m, int n, int r) const;
  // Throws BadInput when the disk is full.
  void store(std::size_t probe, const ProbeMap& map) const;
  // After the manifest is written.
  void remove() const;

 private:
  std::filesystem::path file(std::size_t probe, int n, int r) const;
  std::filesystem::path folder_;
  std::string key_;
};

}  // namespace probewalk
