#include "content/bake/plan/planned_maps.h"

#include "content/pack/pack_io.h"
#include "content/probe/host_address.h"

namespace probewalk {
namespace {

constexpr int kTiny = 8;  // the smallest map that a chunk may hold

ProbeGeometry tiny_geometry(glm::dvec3 position_m) {
  ProbeGeometry map;
  map.position_m = position_m;
  map.n = kTiny;
  map.w.assign(std::size_t(kTiny + 1) * (kTiny + 1), 0.0f);
  map.edges_horizontal.assign(std::size_t(kTiny) * (kTiny + 1), kConnected);
  map.edges_vertical = map.edges_horizontal;
  map.edges_diagonal.assign(std::size_t(kTiny) * kTiny, kConnected);
  map.normals.assign(map.w.size(), 0);
  return map;
}

ProbeRadiance tiny_radiance() {
  ProbeRadiance map;
  map.r = kTiny;
  map.rgb9e5.assign(mip_chain_texels(kTiny), 0);
  map.texel_w.assign(std::size_t(kTiny) * kTiny, 0);
  return map;
}

std::vector<std::byte> chunk_of(const ProbeMap& map, SampleCoding samples) {
  RoomLevel level;
  level.origin_m = map.geometry.position_m;
  level.probes.push_back(map);
  return encode_chunk(level, samples);
}

}  // namespace

const PlannedMaps::Part& PlannedMaps::geometry(std::uint32_t probe, glm::dvec3 position_m, int n) {
  const auto [found, is_new] = geometry_.try_emplace({probe, n});
  Part& part = found->second;
  if (!is_new) return part;
  ProbeMap map{maps_.geometry(position_m, n), tiny_radiance()};
  const std::vector<std::byte> chunk = chunk_of(map, samples_);
  if (samples_ != SampleCoding::kFloat) map.geometry.w = decode_chunk(chunk, "a planned map").probes[0].geometry.w;
  DeviceProbe device = build_device_probe(map);
  part.record = device.record;
  part.words = std::move(device.geometry);
  part.record.geometry_address = host_address(part.words.data());
  part.bytes_disk = chunk.size();
  part.bytes_device = device_block_bytes(part.words);
  return part;
}

const PlannedMaps::Part& PlannedMaps::radiance(std::uint32_t probe, glm::dvec3 position_m, int r) {
  const auto [found, is_new] = radiance_.try_emplace({probe, r});
  Part& part = found->second;
  if (!is_new) return part;
  const ProbeMap map{tiny_geometry(position_m), maps_.radiance(position_m, r)};
  DeviceProbe device = build_device_probe(map);
  part.record.r_log2 = device.record.r_log2;
  part.words = std::move(device.radiance);
  part.record.radiance_address = host_address(part.words.data());
  part.bytes_disk = chunk_of(map, SampleCoding::kFloat).size();
  part.bytes_device = device_block_bytes(part.words);
  return part;
}

ProbeRecord PlannedMaps::record(std::uint32_t probe, glm::dvec3 position_m, int n, int r) {
  ProbeRecord record = geometry(probe, position_m, n).record;
  const ProbeRecord& light = radiance(probe, position_m, r).record;
  record.radiance_address = light.radiance_address;
  record.r_log2 = light.r_log2;
  return record;
}

}  // namespace probewalk
