// Baseline maps on disk, so that a measurement casts their rays once: a file for each scene, pack and size, there whole or
// not at all. What cannot be used (truncated, edited, of another version) is as if it were not there, and is replaced.
//
// A file is, little endian: char magic[8] = "PWBASE01"; the XXH3-128 of all that follows as 32 hex digits; 32 digits of the
// scene's hash; 32 of the pack's; u32 n; u32 probe_count; then for each probe n^2 f32 distances and n^2 u32 normals, as in
// shaders/shared/baseline_layout.h. Pyramids and proxies follow from these.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "content/baseline/baseline_maps.h"
#include "content/pack/pack_io.h"

namespace probewalk {

struct BaselineKey {
  std::string scene_hash;  // Scene::content_hash
  std::string pack_hash;   // of pack.json's bytes
  int n = 0;
  std::size_t probe_count = 0;
};

BaselineKey baseline_key(const Scene& scene, const Pack& pack, int n);
// Name of the key's file within a folder.
std::string baseline_file_name(const BaselineKey& key);

// Empty when there is no such file or it cannot be used; `why` then says so, and stays empty when there is none.
std::optional<BaselineMaps> read_baseline_file(const std::filesystem::path& file, const BaselineKey& key,
                                               std::string* why = nullptr);
// Throws BadInput when it cannot be written.
void write_baseline_file(const std::filesystem::path& file, const BaselineKey& key, const BaselineMaps& maps);

// The pack's maps of n texels a side, from the folder's file if it serves, else from the scene, and then kept there. That
// they cannot be kept is noted. Throws BadUsage (n), Interrupted.
BaselineMaps cached_baseline_maps(const Scene& scene, const Pack& pack, int n, const std::filesystem::path& folder,
                                  Progress& progress);

// The geometry size of the pack's finest level: what --map-resolution is by default.
int finest_geometry_size(const Manifest& manifest);

}  // namespace probewalk
