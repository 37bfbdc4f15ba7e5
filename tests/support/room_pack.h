// A whole pack of one furnished room in two levels, made in a second: eight probes whose radiance is a smooth pattern
// over the surfaces, the floor, a start and a tour. For tests that walk.
#pragma once

#include <cmath>
#include <filesystem>
#include <glm/glm.hpp>

#include "content/bake/bake_probe.h"
#include "content/pack/pack_io.h"
#include "content/probe/device_probe.h"
#include "content/scene/ray_scene.h"
#include "support/test_scenes.h"

namespace probewalk::test {

inline constexpr double kRoomPackScale = 0.5;  // radiance_scale

// Radiance in cd/m^2 at a point: brighter than a stop under white, darker than white, everywhere.
inline glm::vec3 room_pattern(glm::vec3 p) {
  return glm::vec3(0.55f) + 0.4f * glm::vec3(std::sin(3.0f * p.x), std::sin(3.0f * p.y), std::sin(3.0f * p.z));
}

inline ProbeRadiance room_radiance(const RayScene& rays, glm::dvec3 position_m, int r) {
  ProbeRadiance radiance;
  radiance.r = r;
  for (int mip = r; mip > 0; mip /= 2) {
    for (int j = 0; j < mip; ++j) {
      for (int i = 0; i < mip; ++i) {
        const glm::dvec3 q = octahedral_point((2 * i + 1.0) / mip - 1, (2 * j + 1.0) / mip - 1);
        const SurfaceHit hit = rays.closest(glm::vec3(position_m), glm::vec3(q));
        const glm::vec3 color =
            hit.hit ? room_pattern(glm::vec3(position_m + q * static_cast<double>(hit.t))) : glm::vec3(0.9f);
        radiance.rgb9e5.push_back(encode_rgb9e5(color * static_cast<float>(kRoomPackScale)));
        if (mip == r) radiance.texel_w.push_back(hit.hit ? encode_texel_w(1.0f / hit.t) : std::uint16_t{0});
      }
    }
  }
  return radiance;
}

// The floor of the room's box, but for its pillar; furniture is walked over.
inline FloorMap room_floor() {
  FloorMap floor;
  floor.origin_m = {-3.0, -2.5};
  floor.cell_m = 0.05;
  floor.columns = {120, 100};
  for (int iz = 0; iz < floor.columns.y; ++iz) {
    for (int ix = 0; ix < floor.columns.x; ++ix) {
      const glm::dvec2 at = floor.origin_m + floor.cell_m * glm::dvec2(ix + 0.5, iz + 0.5);
      if (at.x > -2.0 && at.x < -1.6 && at.y > -1.8 && at.y < -1.4) continue;
      FloorNode node;
      node.ix = ix;
      node.iz = iz;
      node.headroom_m = 2.6f;
      floor.nodes.push_back(node);
    }
  }
  return floor;
}

// `fine_n`: geometry of the finer level.
inline void write_room_pack(const std::filesystem::path& folder, int fine_n = 64) {
  const Scene scene = furnished_room();
  const RayScene rays(scene);
  Manifest manifest;
  manifest.producer = "test";
  manifest.scene_name = "furnished room";
  manifest.scene_hash = manifest.options_hash = std::string(32, '0');
  manifest.bounds = scene.bounds;
  manifest.radiance_scale = kRoomPackScale;
  manifest.exposure_ev = -0.26;  // 1 cd/m^2 is white
  manifest.features = {"cuts", "sky"};
  manifest.floor = room_floor();
  manifest.start.position_m = {-1.0, 1.6, 1.2};
  for (int i = 0; i <= 12; ++i) {
    Pose pose;
    pose.position_m = {-1.0 + 0.15 * i, 1.6, 1.2 - 0.05 * i};
    pose.yaw_rad = 0.08 * i;
    manifest.tour.push_back(pose);
  }
  manifest.grid.origin_m = {-1.3, 0.9, -1.0};
  manifest.grid.spacing_m = {2.7, 1.1, 2.2};
  manifest.grid.dims = {2, 2, 2};

  RoomEntry room;
  room.id = "room";
  room.name = "Room";
  room.bounds = scene.bounds;
  room.probe_count = 8;
  for (std::uint32_t k = 0; k < 8; ++k) {
    manifest.grid.probe.push_back(k);
    manifest.probe_positions_m.push_back(manifest.grid.origin_m +
                                         manifest.grid.spacing_m * glm::dvec3(k & 1, k >> 1 & 1, k >> 2));
  }
  PackWriter writer(folder);
  for (const int n : {16, fine_n}) {
    RoomLevel level;
    LevelEntry entry;
    for (const glm::dvec3& position_m : manifest.probe_positions_m) {
      ProbeMap map{bake_geometry(rays, position_m, n), room_radiance(rays, position_m, n / 2)};
      entry.bytes_device += device_probe_bytes(n, n / 2, count_cut_cells(map.geometry));
      level.probes.push_back(std::move(map));
    }
    const std::vector<std::byte> chunk = encode_chunk(level);
    entry.chunk = writer.add_chunk(chunk);
    entry.geometry_size = static_cast<std::uint32_t>(n);
    entry.radiance_size = static_cast<std::uint32_t>(n / 2);
    entry.bytes_disk = chunk.size();
    room.levels.push_back(entry);
  }
  manifest.rooms.push_back(room);
  writer.finish(manifest);
}

}  // namespace probewalk::test
