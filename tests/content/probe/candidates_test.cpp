// The order in which a ray asks its probes: it must not jump as the eye moves from one grid cell into the next.
#include <gtest/gtest.h>

#include "content/bake/bake_probe.h"
#include "content/probe/device_probe.h"
#include "content/probe/probe_set.h"
#include "content/probe/tracer_f32.h"
#include "content/scene/ray_scene.h"
#include "support/low_discrepancy.h"
#include "support/test_scenes.h"

namespace probewalk {
namespace {

// How many probes of the cell are asked when none answers.
int present(f32::CellCandidates cell) {
  int count = 0;
  for (int k = f32::best_candidate(cell); k < 8; k = f32::best_candidate(cell), ++count) {
    f32::strike_candidate(cell, f32::candidate_probe(cell, k));
  }
  return count;
}

TEST(Candidates, TheFirstChoiceStaysAcrossACellsBorder) {
  const Scene scene = test::furnished_room();
  const RayScene rays(scene);
  ProbeGrid grid;
  grid.origin_m = {-2.4, 0.9, -1.1};
  grid.spacing_m = {1.6, 1.1, 2.4};
  grid.dims = {4, 2, 2};
  std::vector<DeviceProbe> probes;
  for (int k = 0; k < 16; ++k) {
    const glm::dvec3 position_m = grid.origin_m + grid.spacing_m * glm::dvec3(k & 3, k >> 2 & 1, k >> 3);
    ProbeMap map{bake_geometry(rays, position_m, 8), {}};
    map.radiance.r = 8;
    map.radiance.rgb9e5.assign(mip_chain_texels(8), encode_rgb9e5({1, 1, 1}));
    map.radiance.texel_w.assign(64, 0);
    probes.push_back(build_device_probe(map));
    grid.probe.push_back(static_cast<std::uint32_t>(k));
  }
  const ProbeSet set(std::move(probes), grid);
  const TraceConstants dials = default_dials(1.0);
  test::Random random(3);
  int swapped = 0;
  for (int k = 0; k < 2000; ++k) {
    const glm::vec3 border(-0.8, random(1.0, 1.9), random(-1.0, 1.2)), d(random.direction());
    const auto before = f32::cell_candidates(set.grid(), dials, default_rules(), border - glm::vec3(1e-5f, 0, 0), d);
    const auto after = f32::cell_candidates(set.grid(), dials, default_rules(), border + glm::vec3(1e-5f, 0, 0), d);
    const int first_before = f32::best_candidate(before), first_after = f32::best_candidate(after);
    ASSERT_EQ(present(before), 8);
    ASSERT_EQ(present(after), 8);
    swapped += f32::candidate_probe(before, first_before) != f32::candidate_probe(after, first_after);
  }
  // Scores of two probes may cross within the step, too.
  EXPECT_LE(swapped, 2);
}

}  // namespace
}  // namespace probewalk
