// The words that probes take in memory.
#include "content/probe/device_probe.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/rough_maps.h"

namespace probewalk {
namespace {

TEST(DeviceProbe, TakesWhatIsStated) {
  for (const int n : {8, 16, 128}) {
    for (const test::RoughMap& rough : test::rough_maps(n)) {
      const DeviceProbe probe = build_device_probe(rough.map);
      const CutCells cut = count_cut_cells(rough.map.geometry);
      const std::uint64_t taken = 4 * (probe.geometry.size() + probe.radiance.size());
      const std::uint64_t stated = device_probe_bytes(n, rough.map.radiance.r, cut);
      EXPECT_EQ(taken, stated) << rough.name;
      EXPECT_LE(cut.on_fold, std::min(cut.all, 2 * static_cast<std::size_t>(n))) << rough.name;
    }
  }
}

}  // namespace
}  // namespace probewalk
