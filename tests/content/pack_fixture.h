// Small packs made of arithmetic, for the tests of packs and streaming.
#pragma once

#include <unistd.h>

#include <bit>
#include <cstdint>
#include <filesystem>
#include <string>

#include "content/pack/pack_io.h"
#include "content/probe/device_probe.h"

namespace probewalk {

// A folder of its own under the build tree, removed at the end.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(const std::string& name)
      : path_(std::filesystem::path(PROBEWALK_TEST_OUTPUT_DIR) / (name + "-" + std::to_string(::getpid()))) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// Reproducible noise (SplitMix64), so that nothing compresses by accident.
class Noise {
 public:
  explicit Noise(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }
  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }

 private:
  std::uint64_t state_;
};

// A probe of noise: every array full, cuts included when asked for.
inline ProbeMap noise_probe(int n, int r, bool cuts, std::uint64_t seed, const glm::dvec3& position_m) {
  Noise noise(seed);
  ProbeMap probe;
  ProbeGeometry& g = probe.geometry;
  const std::size_t side = static_cast<std::size_t>(n) + 1, cells = static_cast<std::size_t>(n);
  g.position_m = position_m;
  g.n = n;
  for (std::size_t k = 0; k < side * side; ++k) g.w.push_back(static_cast<float>(0.01 + noise.unit()));
  const auto edge = [&] { return cuts ? static_cast<std::uint8_t>(noise.next() % (kCutSteps + 1)) : kConnected; };
  for (std::size_t k = 0; k < cells * side; ++k) g.edges_horizontal.push_back(edge());
  for (std::size_t k = 0; k < cells * side; ++k) g.edges_vertical.push_back(edge());
  for (std::size_t k = 0; k < cells * cells; ++k) g.edges_diagonal.push_back(edge());
  for (std::size_t k = 0; k < side * side; ++k) {
    g.normals.push_back(cuts ? static_cast<std::uint16_t>(noise.next()) : std::uint16_t{0});
  }
  probe.radiance.r = r;
  for (int mip = r; mip > 0; mip /= 2) {
    for (int k = 0; k < mip * mip; ++k) probe.radiance.rgb9e5.push_back(static_cast<std::uint32_t>(noise.next()));
  }
  for (int k = 0; k < r * r; ++k) probe.radiance.texel_w.push_back(static_cast<std::uint16_t>(noise.next()));
  return probe;
}

inline RoomLevel noise_level(int probes, int n, int r, bool cuts, std::uint64_t seed = 1) {
  RoomLevel level{{10.0, 1.5, -3.0}, {}};
  for (int p = 0; p < probes; ++p) {
    level.probes.push_back(noise_probe(n, r, cuts, seed + static_cast<std::uint64_t>(p), {10.25 + 0.5 * p, 2.0, -3.5}));
  }
  return level;
}

inline bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](float x, float y) {
    return std::bit_cast<std::uint32_t>(x) == std::bit_cast<std::uint32_t>(y);
  });
}

inline bool same_probe(const ProbeMap& a, const ProbeMap& b) {
  return a.geometry.position_m == b.geometry.position_m && a.geometry.n == b.geometry.n &&
         same_bits(a.geometry.w, b.geometry.w) && a.geometry.edges_horizontal == b.geometry.edges_horizontal &&
         a.geometry.edges_vertical == b.geometry.edges_vertical &&
         a.geometry.edges_diagonal == b.geometry.edges_diagonal && a.geometry.normals == b.geometry.normals &&
         a.radiance.r == b.radiance.r && a.radiance.rgb9e5 == b.radiance.rgb9e5 &&
         a.radiance.texel_w == b.radiance.texel_w;
}

inline bool same_level(const RoomLevel& a, const RoomLevel& b) {
  return a.origin_m == b.origin_m &&
         std::equal(a.probes.begin(), a.probes.end(), b.probes.begin(), b.probes.end(), same_probe);
}

// Two rooms side by side, joined by a door; `levels[room]` lists each room's chunks. Everything else is fixed.
inline Manifest small_manifest(const std::vector<std::vector<LevelEntry>>& levels, std::uint32_t probes_per_room = 2) {
  Manifest m;
  m.producer = "probewalk test";
  m.scene_name = "two rooms";
  m.scene_hash = std::string(32, 'a');
  m.options_hash = std::string(32, 'b');
  m.scale_statement = "metres, as the file says";
  m.light_statement = "2 point lights";
  m.credits = "Nobody, CC0";
  m.bounds = {{0.0, 0.0, -4.0}, {10.0, 3.0, 0.0}};
  m.features = {"cuts"};
  m.radiance_scale = 0.5;
  m.exposure_ev = 3.25;
  for (std::uint32_t k = 0; k < levels.size(); ++k) {
    RoomEntry room;
    room.id = k == 0 ? "hall" : "kitchen-" + std::to_string(k);
    room.name = k == 0 ? "Hall" : "Kitchen";
    room.bounds = {{5.0 * k, 0.0, -4.0}, {5.0 * k + 5.0, 3.0, 0.0}};
    room.origin_m = {10.0, 1.5, -3.0};
    room.first_probe = k * probes_per_room;
    room.probe_count = probes_per_room;
    room.levels = levels[k];
    m.rooms.push_back(room);
    for (std::uint32_t p = 0; p < probes_per_room; ++p) m.probe_positions_m.push_back({10.25 + 0.5 * p, 2.0, -3.5});
  }
  for (int k = 0; k + 1 < static_cast<int>(levels.size()); ++k) {
    const double x = 5.0 * (k + 1);
    m.portals.push_back({k, k + 1, {{x, 0.0, -2.5}, {x, 0.0, -1.5}, {x, 2.0, -1.5}, {x, 2.0, -2.5}}});
  }
  m.grid = {{0.5, 1.6, -3.5}, {2.0, 1.0, 2.0}, {2, 1, 2}, {0, 1, 1, 0}};
  m.floor.origin_m = {0.0, -4.0};
  m.floor.columns = {200, 80};
  for (std::int32_t iz = 0; iz < 80; iz += 7) {
    for (std::int32_t ix = 0; ix < 200; ix += 3) m.floor.nodes.push_back({ix, iz, 0.0f, 2.5f, 0});
  }
  m.start = {{1.0, 1.6, -2.0}, 0.5, 0.0};
  m.tour = {m.start, {{2.0, 1.6, -2.0}, 0.25, -0.1}};
  m.warnings = {"the lamp has no light"};
  return m;
}

// Writes the pack of small_manifest with chunks of noise: level 0 of 8^2, level 1 of 16^2.
inline Manifest write_small_pack(const std::filesystem::path& pack, std::size_t rooms) {
  PackWriter writer(pack);
  std::vector<std::vector<LevelEntry>> levels(rooms);
  for (std::size_t room = 0; room < rooms; ++room) {
    for (const int n : {8, 16}) {
      const RoomLevel level = noise_level(2, n, n, true, 100 * room + static_cast<std::size_t>(n));
      std::uint64_t bytes_device = 0;
      for (const ProbeMap& map : level.probes) bytes_device += device_probe_bytes(n, n, count_cut_cells(map.geometry));
      const auto chunk = encode_chunk(level);
      levels[room].push_back({writer.add_chunk(chunk), static_cast<std::uint32_t>(n), static_cast<std::uint32_t>(n),
                              chunk.size(), bytes_device, -1.0});
    }
  }
  Manifest manifest = small_manifest(levels);
  writer.finish(manifest);
  return manifest;
}

}  // namespace probewalk
