#include "content/probe/probe_set.h"

#include <algorithm>
#include <cmath>

#include "content/probe/host_address.h"

namespace probewalk {

GridConstants grid_constants(const ProbeGrid& grid, std::size_t probe_count) {
  GridConstants constants{};
  constants.origin_m = glm::vec3(grid.origin_m);
  constants.spacing_m = glm::vec3(grid.spacing_m);
  constants.spacing_mean_m = static_cast<float>(std::cbrt(grid.spacing_m.x * grid.spacing_m.y * grid.spacing_m.z));
  constants.inverse_diagonal = static_cast<float>(1.0 / glm::length(grid.spacing_m));
  constants.dims = grid.dims;
  constants.probe_count = static_cast<std::uint32_t>(probe_count);
  return constants;
}

TraceConstants default_dials(double radiance_scale) {
  return {.distance_weight = 1.0f,
          .start_margin = 0.02f,
          .max_tries = 12,
          .radiance_scale = static_cast<float>(radiance_scale)};
}

ProbeSet::ProbeSet(std::vector<DeviceProbe> probes, const ProbeGrid& grid)
    : probes_(std::move(probes)), table_(grid.probe), grid_(grid_constants(grid, probes_.size())) {
  for (const DeviceProbe& probe : probes_) records_.push_back(record_in_memory(probe));
  grid_.table_address = host_address(table_.data());
  grid_.probes_address = host_address(records_.data());
}

ProbeSet ProbeSet::read(const Pack& pack, std::size_t level, DeviceSamples samples) {
  const Manifest& manifest = pack.manifest();
  std::vector<DeviceProbe> probes;
  for (std::size_t room = 0; room < manifest.rooms.size(); ++room) {
    if (manifest.rooms[room].levels.empty()) continue;  // a room without probes, as with a small --max-probes
    const std::size_t finest = manifest.rooms[room].levels.size() - 1;
    for (const ProbeMap& map : pack.read_level(room, std::min(level, finest)).probes) {
      probes.push_back(build_device_probe(map, PyramidMaker::kHost, samples));
    }
  }
  return ProbeSet(std::move(probes), manifest.grid);
}

}  // namespace probewalk
