#include "xr/free_air.h"

#include <gtest/gtest.h>

#include "content/bake/bake_probe.h"
#include "content/scene/ray_scene.h"
#include "support/test_scenes.h"

namespace probewalk {
namespace {

// Two rooms of 4 x 2.5 x 3 m with a wall of 0.2 m between them at x in [-0.1, 0.1], a table in the first one; a probe
// in each room's middle.
struct TwoRooms {
  TwoRooms() {
    test::SceneBuilder builder;
    builder.box({-4.1f, 0, -1.5f}, {-0.1f, 2.5f, 1.5f}, true).box({0.1f, 0, -1.5f}, {4.1f, 2.5f, 1.5f}, true);
    builder.table(-2.0f, 0.0f, 1.4f, 0.8f, 0.74f, 0.05f);
    const Scene scene = builder.build();
    const RayScene rays(scene);
    grid.origin_m = {-2.1, 1.5, 0.0};
    grid.spacing_m = {4.2, 1.0, 1.0};
    grid.dims = {2, 1, 1};
    grid.probe = {0, 1};
    for (const double x : {-2.1, 2.1}) {
      ProbeMap map;
      map.geometry = bake_geometry(rays, {x, 1.5, 0.0}, 64);
      map.radiance.r = 8;
      map.radiance.rgb9e5.assign(mip_chain_texels(8), 0);
      map.radiance.texel_w.assign(64, 0);
      probes.push_back(build_device_probe(map));
    }
  }
  ProbeGrid grid;
  std::vector<DeviceProbe> probes;
};

TEST(FreeAir, RoomsAreFreeAndWallsAreNot) {
  const TwoRooms rooms;
  FreeAir air(rooms.grid, 2);
  air.add(0, rooms.probes[0]);
  air.add(1, rooms.probes[1]);
  EXPECT_TRUE(air.is_free({-2.1, 1.5, 0.0}));
  EXPECT_TRUE(air.is_free({-0.2, 1.6, 0.5}));   // close to the wall
  EXPECT_FALSE(air.is_free({0.0, 1.6, 0.5}));   // in it
  EXPECT_TRUE(air.is_free({0.2, 1.6, 0.5}));    // behind it: the next room
  EXPECT_TRUE(air.is_free({-2.0, 1.0, 0.1}));   // leaning over the table
  EXPECT_FALSE(air.is_free({-2.0, -0.3, 0.1}));  // in the ground
  EXPECT_FALSE(air.is_free({3.0, 2.9, 0.0}));   // above the ceiling
}

TEST(FreeAir, PointsCountAsFreeUntilSomethingIsKnown) {
  const TwoRooms rooms;
  FreeAir air(rooms.grid, 2);
  EXPECT_TRUE(air.is_free({0.0, 1.6, 0.5}));
  air.add(1, rooms.probes[1]);
  EXPECT_FALSE(air.is_free({0.0, 1.6, 0.5}));
}

}  // namespace
}  // namespace probewalk
