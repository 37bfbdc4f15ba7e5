// Whether a point lies in the open or inside something solid, as the probes around it see it: a point that no probe
// near it sees is in a wall, or where no picture could be drawn anyway.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <mutex>
#include <vector>

#include "content/bake/placement.h"
#include "content/probe/device_probe.h"

namespace probewalk {

class FreeAir {
 public:
  // `grid` outlives this. Nothing is known yet: every point counts as free.
  FreeAir(const ProbeGrid& grid, std::size_t probe_count);

  // Takes what a probe sees, from the words of its coarsest level. Any thread.
  void add(std::uint32_t probe, const DeviceProbe& words);
  // Any thread. Of the probes that serve the grid cell around the point, one that is known must see as far as the
  // point.
  bool is_free(const glm::dvec3& point_m) const;

 private:
  struct Sight {
    glm::dvec3 position_m{0.0};
    int n = 0;             // cells a side; 0 = not known
    std::vector<float> w;  // (n+1)^2, as ProbeGeometry::w
  };
  static bool sees(const Sight& sight, const glm::dvec3& point_m);

  const ProbeGrid& grid_;
  mutable std::mutex mutex_;
  std::vector<Sight> sights_;
};

}  // namespace probewalk
