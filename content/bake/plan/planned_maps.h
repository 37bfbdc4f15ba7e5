// The maps of a plan's probes as the tracer reads them, each made once, with what it will take on disk and on the
// device.
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "content/bake/map_store.h"
#include "content/pack/pack_io.h"
#include "content/probe/device_probe.h"

namespace probewalk {

class PlannedMaps {
 public:
  PlannedMaps(MapStore& maps, SampleCoding samples) : maps_(maps), samples_(samples) {}

  // By the probe's number and the map's side..
  struct Part {
    ProbeRecord record{};  // of a geometry: all but the radiance; of a radiance: r_log2 and its address alone
    std::vector<std::uint32_t> words;
    std::uint64_t bytes_disk = 0, bytes_device = 0;
  };
  bool has_geometry(std::uint32_t probe, int n) const { return geometry_.contains({probe, n}); }
  bool has_radiance(std::uint32_t probe, int r) const { return radiance_.contains({probe, r}); }
  const Part& geometry(std::uint32_t probe, glm::dvec3 position_m, int n);
  const Part& radiance(std::uint32_t probe, glm::dvec3 position_m, int r);
  ProbeRecord record(std::uint32_t probe, glm::dvec3 position_m, int n, int r);

 private:
  using Key = std::pair<std::uint32_t, int>;
  MapStore& maps_;
  const SampleCoding samples_;
  std::map<Key, Part> geometry_, radiance_;
};

}  // namespace probewalk
