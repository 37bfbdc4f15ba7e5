// Probes in this process's memory with their grid: what the C++ tracers run on.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "content/bake/placement.h"
#include "content/pack/pack_io.h"
#include "content/probe/device_probe.h"

namespace probewalk {

class ProbeSet {
 public:
  // Probes in the order of the grid's indices.
  ProbeSet(std::vector<DeviceProbe> probes, const ProbeGrid& grid);
  // Reads a pack's rooms at their finest level, or at most at `level`.
  static ProbeSet read(const Pack& pack, std::size_t level = ~std::size_t{0},
                       DeviceSamples samples = DeviceSamples::kFloat);

  ProbeSet(ProbeSet&&) = default;
  ProbeSet& operator=(ProbeSet&&) = default;
  ProbeSet(const ProbeSet&) = delete;
  ProbeSet& operator=(const ProbeSet&) = delete;

  // For f32:: and f64::trace_ray; valid as long as this object is.
  const GridConstants& grid() const { return grid_; }
  const std::vector<ProbeRecord>& records() const { return records_; }
  const std::vector<DeviceProbe>& probes() const { return probes_; }

 private:
  std::vector<DeviceProbe> probes_;
  std::vector<ProbeRecord> records_;
  std::vector<std::uint32_t> table_;
  GridConstants grid_{};
};

// Grid constants without addresses.
GridConstants grid_constants(const ProbeGrid& grid, std::size_t probe_count);

// The dials' defaults: nearer probes weigh as in rooms, a start within 2 % behind counts, 12 walks (design: fewer-tries).
TraceConstants default_dials(double radiance_scale);

}  // namespace probewalk
