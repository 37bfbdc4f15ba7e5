#include "content/baseline/baseline_cache.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <system_error>

#include "content/error.h"
#include "content/pack/file_io.h"
#include "content/pack/pack_format.h"
#include "content/scene/ray_scene.h"

namespace probewalk {
namespace {

namespace fs = std::filesystem;

constexpr std::array<char, 8> kMagic{'P', 'W', 'B', 'A', 'S', 'E', '0', '1'};
constexpr std::size_t kHashDigits = 32;
constexpr std::size_t kHashed = kMagic.size() + kHashDigits;  // where what the hash covers begins

std::size_t header_bytes() { return kHashed + 2 * kHashDigits + 2 * sizeof(std::uint32_t); }

std::size_t texels_of(const BaselineKey& key) { return static_cast<std::size_t>(key.n) * static_cast<std::size_t>(key.n); }

std::size_t file_bytes(const BaselineKey& key) {
  return header_bytes() + key.probe_count * texels_of(key) * (sizeof(float) + sizeof(std::uint32_t));
}

// What the file holds between its own hash and the first probe.
std::vector<std::byte> key_bytes(const BaselineKey& key) {
  std::vector<std::byte> bytes(header_bytes() - kHashed);
  const std::array<std::uint32_t, 2> sizes{static_cast<std::uint32_t>(key.n), static_cast<std::uint32_t>(key.probe_count)};
  std::memcpy(bytes.data(), key.scene_hash.data(), std::min(key.scene_hash.size(), kHashDigits));
  std::memcpy(bytes.data() + kHashDigits, key.pack_hash.data(), std::min(key.pack_hash.size(), kHashDigits));
  std::memcpy(bytes.data() + 2 * kHashDigits, sizes.data(), sizeof(sizes));
  return bytes;
}

}  // namespace

BaselineKey baseline_key(const Scene& scene, const Pack& pack, int n) {
  const std::vector<std::byte> manifest = read_file(pack.path() / "pack.json", PackLimits::kManifestBytes);
  return {scene.content_hash, content_hash(manifest), n, pack.manifest().probe_positions_m.size()};
}

std::string baseline_file_name(const BaselineKey& key) {
  return content_hash(key_bytes(key)) + ".baseline";
}

std::optional<BaselineMaps> read_baseline_file(const fs::path& file, const BaselineKey& key, std::string* why) {
  const auto refuse = [&](std::string reason) -> std::optional<BaselineMaps> {
    if (why != nullptr) *why = fmt::format("{} {}", file.string(), reason);
    return std::nullopt;
  };
  std::error_code error;
  if (!fs::exists(file, error)) return std::nullopt;
  std::vector<std::byte> bytes;
  try {
    bytes = read_file(file, file_bytes(key));
  } catch (const BadInput& problem) {
    if (why != nullptr) *why = problem.what();
    return std::nullopt;
  }
  if (bytes.size() != file_bytes(key)) return refuse(fmt::format("has {} bytes instead of {}", bytes.size(), file_bytes(key)));
  if (std::memcmp(bytes.data(), kMagic.data(), kMagic.size()) != 0) return refuse("holds no maps of this version");
  const std::span<const std::byte> hashed = std::span(bytes).subspan(kHashed);
  const std::string digits = content_hash(hashed);
  if (std::memcmp(bytes.data() + kMagic.size(), digits.data(), kHashDigits) != 0) return refuse("does not match its hash");
  const std::vector<std::byte> wanted = key_bytes(key);
  if (std::memcmp(hashed.data(), wanted.data(), wanted.size()) != 0) return refuse("is of another scene, pack or size");

  BaselineMaps maps;
  maps.n = key.n;
  const std::byte* at = bytes.data() + header_bytes();
  const std::size_t plane_bytes = texels_of(key) * sizeof(float);
  for (std::size_t k = 0; k < key.probe_count; ++k) {
    std::vector<float> distance_m(texels_of(key));
    std::vector<std::uint32_t> normal(texels_of(key));
    std::memcpy(distance_m.data(), at, plane_bytes);
    std::memcpy(normal.data(), at + plane_bytes, plane_bytes);
    at += 2 * plane_bytes;
    // Positive and finite: what the walks rely on. The hash vouches for accidents, not for malice.
    const bool usable = std::all_of(distance_m.begin(), distance_m.end(),
                                    [](float d) { return d > 0.0f && d <= kBaselineSky_m; });
    if (!usable) return refuse("holds distances that are none");
    maps.probes.push_back(derive_baseline_map(key.n, std::move(distance_m), std::move(normal)));
  }
  maps.farthest_m = farthest_seen_m(maps.probes);
  return maps;
}

void write_baseline_file(const fs::path& file, const BaselineKey& key, const BaselineMaps& maps) {
  std::vector<std::byte> bytes(file_bytes(key));
  std::memcpy(bytes.data(), kMagic.data(), kMagic.size());
  const std::vector<std::byte> wanted = key_bytes(key);
  std::memcpy(bytes.data() + kHashed, wanted.data(), wanted.size());
  std::byte* at = bytes.data() + header_bytes();
  const std::size_t plane_bytes = texels_of(key) * sizeof(float);
  for (const BaselineMap& map : maps.probes) {
    std::memcpy(at, map.distance_m.data(), plane_bytes);
    std::memcpy(at + plane_bytes, map.normal.data(), plane_bytes);
    at += 2 * plane_bytes;
  }
  const std::string digits = content_hash(std::span(bytes).subspan(kHashed));
  std::memcpy(bytes.data() + kMagic.size(), digits.data(), kHashDigits);
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  write_file_whole(file, bytes);
}

BaselineMaps cached_baseline_maps(const Scene& scene, const Pack& pack, int n, const fs::path& folder,
                                  Progress& progress) {
  const BaselineKey key = baseline_key(scene, pack, n);
  const fs::path file = folder / baseline_file_name(key);
  std::string why;
  if (std::optional<BaselineMaps> maps = read_baseline_file(file, key, &why)) return std::move(*maps);
  if (!why.empty()) progress.note(fmt::format("baseline maps are made anew: {}", why));
  const RayScene rays(scene);
  BaselineMaps maps = make_baseline_maps(rays, pack.manifest().probe_positions_m, n, progress);
  try {
    write_baseline_file(file, key, maps);
  } catch (const BadInput& problem) {
    progress.note(fmt::format("baseline maps are not kept: {}", problem.what()));
  }
  return maps;
}

int finest_geometry_size(const Manifest& manifest) {
  std::uint32_t finest = kLeastBaselineSide;
  for (const RoomEntry& room : manifest.rooms) {
    for (const LevelEntry& level : room.levels) finest = std::max(finest, level.geometry_size);
  }
  return static_cast<int>(finest);
}

}  // namespace probewalk
