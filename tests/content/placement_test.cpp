#include "content/bake/placement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "content/box_scene.h"
#include "content/error.h"
#include "content/visibility_share.h"

namespace probewalk {
namespace {

using ::testing::HasSubstr;

struct Placed {
  Space space;
  Placement placement;
};

Placed place(const Scene& scene, const PlacementOptions& options = {}) {
  const RayScene rays(scene);
  SilentProgress progress;
  Placed placed{find_space(scene, rays, {}, progress), {}};
  placed.placement = place_probes(scene, rays, placed.space, options);
  return placed;
}

double distance_to_surfaces_m(const RayScene& rays, glm::dvec3 point) {
  double least = 10.0;
  for (int k = 0; k < 200; ++k) {
    const double y = 1.0 - 2.0 * (k + 0.5) / 200;
    const double r = std::sqrt(1.0 - y * y);
    const SurfaceHit hit = rays.closest(glm::vec3(point), glm::vec3(r * std::cos(2.4 * k), y, r * std::sin(2.4 * k)));
    if (hit.hit) least = std::min(least, double(hit.t));
  }
  return least;
}

void expect_sound(const Scene& scene, const Placed& placed, int max_probes) {
  const RayScene rays(scene);
  const Placement& p = placed.placement;
  ASSERT_FALSE(p.sites.empty());
  EXPECT_LE(p.sites.size(), std::size_t(max_probes));
  ASSERT_EQ(p.grid.probe.size(), std::size_t(p.grid.dims.x) * p.grid.dims.y * p.grid.dims.z);
  for (const std::uint32_t site : p.grid.probe) ASSERT_LT(site, p.sites.size());
  for (std::size_t i = 0; i < p.sites.size(); ++i) {
    EXPECT_GE(distance_to_surfaces_m(rays, p.sites[i].position_m), 0.1) << "probe " << i;
    ASSERT_LT(std::size_t(p.sites[i].room), placed.space.rooms.size());
    if (i > 0) {
      EXPECT_LE(p.sites[i - 1].room, p.sites[i].room) << "sorted by room";
    }
  }
}

BoxScene flat() {
  BoxScene boxes;
  boxes.room({0, 0, 0}, {6, 2.5f, 9}).wall_with_door(0, 6, 4, 2.5f, 2.0f, 2.9f);
  boxes.solid({0, 0, 6}, {2, 0.5f, 8}).solid({3, 0.7f, 6}, {5, 0.75f, 7}).solid({5, 0, 0}, {6, 2.2f, 1.5f});
  boxes.authored_room("south", {0, 0, 0}, {6, 2.5, 4}).authored_room("north", {0, 0, 4}, {6, 2.5, 9});
  return boxes;
}

TEST(Placement, ASmallRoomGetsEightToTwentyProbes) {
  BoxScene boxes;
  boxes.room({0, 0, 0}, {5, 2.5f, 4});
  const Placed placed = place(boxes.scene);
  EXPECT_GE(placed.placement.sites.size(), 8u);
  EXPECT_LE(placed.placement.sites.size(), 20u);
  expect_sound(boxes.scene, placed, 200);
  EXPECT_THAT(placed.placement.statement, HasSubstr("probes on a grid"));
}

TEST(Placement, NoProbeStandsInFurnitureOrWalls) {
  const Scene scene = flat().scene;
  const Placed placed = place(scene);
  expect_sound(scene, placed, 200);
  for (const ProbeSite& site : placed.placement.sites) {
    const glm::dvec3& p = site.position_m;
    EXPECT_FALSE(p.x > 5 && p.z < 1.5 && p.y < 2.2) << "in the wardrobe";
    EXPECT_FALSE(p.x < 2 && p.z > 6 && p.z < 8 && p.y < 0.5) << "in the bed";
    EXPECT_TRUE(p.x > 0 && p.x < 6 && p.z > 0 && p.z < 9 && p.y > 0 && p.y < 2.5) << "outside";
    EXPECT_EQ(site.room, p.z < 4 ? 0 : 1) << p.z;
  }
}

TEST(Placement, WhatHeadsSeeSomeProbeOfTheirCellSees) {
  const Scene scene = flat().scene;
  const Placed placed = place(scene);
  const RayScene rays(scene);
  const VisibilityShare share = measure_visibility(rays, placed.space, placed.placement, 400);
  EXPECT_GE(share.covered, 0.97);
  EXPECT_GE(share.mean_views, 4.0);
  EXPECT_LE(share.few_views, 0.03);
}

TEST(Placement, NothingStandsBehindAPane) {
  BoxScene boxes;
  boxes.room({0, 0, 0}, {4, 2.5f, 4});
  // Take out the wall at x = 4 (the third and fourth triangle pairs are across x) and put a pane that rays pass
  // through.
  boxes.scene.triangles.erase(boxes.scene.triangles.begin() + 2, boxes.scene.triangles.begin() + 4);
  boxes.scene.triangle_material.resize(boxes.scene.triangles.size());
  boxes.scene.triangle_object.resize(boxes.scene.triangles.size());
  boxes.scene.materials.resize(2);
  boxes.scene.materials[1].alpha_mode = AlphaMode::kBlend;
  boxes.scene.materials[1].base_color_factor.a = 0.1f;
  const std::size_t before = boxes.scene.triangles.size();
  boxes.solid({4, 0, 0}, {4.02f, 2.5f, 4});
  for (std::size_t t = before; t < boxes.scene.triangles.size(); ++t) boxes.scene.triangle_material[t] = 1;
  boxes.floor({4, -4}, {12, 8}, -0.1f);
  const RayScene rays(boxes.scene);
  ASSERT_FALSE(rays.occluded({2, 1, 2}, {4, 0, 0}, 0.0f, 1.0f)) << "the pane is clear";
  SilentProgress progress;
  SpaceOptions inside;
  inside.start_m = glm::dvec3(2, 0, 2);
  Space space = find_space(boxes.scene, rays, inside, progress);
  std::erase_if(space.floor.nodes, [&](const FloorNode& node) {
    return space.floor.origin_m.x + node.ix * space.floor.cell_m > 4.0;  // as if the garden had been left out
  });
  const Placement placement = place_probes(boxes.scene, rays, space, {});
  for (const ProbeSite& site : placement.sites) EXPECT_LT(site.position_m.x, 4.0);
}

TEST(Placement, IsWidenedUntilTheNumberFits) {
  const Scene scene = flat().scene;
  for (const int most : {1, 2, 5, 12, 30}) {
    PlacementOptions options;
    options.max_probes = most;
    options.spacing_m = 1.0;
    expect_sound(scene, place(scene, options), most);
  }
}

// A hall and four closets behind doors along its side, which coarse lines miss.
BoxScene hall_with_closets() {
  BoxScene boxes;
  boxes.room({0, 0, 0}, {8, 2.5f, 5.2f});
  boxes.wall_with_door(0, 8, 4, 2.5f, 0.6f, 1.5f);
  boxes.authored_room("hall", {0, 0, 0}, {8, 2.5, 4});
  boxes.authored_room("closet-0", {0, 0, 4}, {2, 2.5, 5.2});
  boxes.authored_room("closet-1", {2, 0, 4}, {4, 2.5, 5.2});
  boxes.authored_room("closet-2", {4, 0, 4}, {6, 2.5, 5.2});
  boxes.authored_room("closet-3", {6, 0, 4}, {8, 2.5, 5.2});
  return boxes;
}

TEST(Placement, EveryRoomHasAProbeBeforeAnyHasTwoToSpare) {
  const BoxScene boxes = hall_with_closets();
  for (const int most : {4, 5, 6, 8, 12}) {
    PlacementOptions options;
    options.max_probes = most;
    const Placed placed = place(boxes.scene, options);
    expect_sound(boxes.scene, placed, most);
    std::vector<int> probes(placed.space.rooms.size(), 0);
    ASSERT_EQ(probes.size(), 5u);
    for (const ProbeSite& site : placed.placement.sites) ++probes[std::size_t(site.room)];
    // A probe stands for a vertex, so that the widest grids have too few.
    const auto with = std::size_t(std::count_if(probes.begin(), probes.end(), [](int count) { return count > 0; }));
    EXPECT_EQ(with, std::min(probes.size(), placed.placement.grid.probe.size())) << "with at most " << most;
    if (most >= 8) {
      EXPECT_EQ(with, probes.size()) << "with at most " << most;
    }
    // And the grid's vertices know all of them.
    std::vector<bool> known(placed.placement.sites.size(), false);
    for (const std::uint32_t site : placed.placement.grid.probe) known[site] = true;
    EXPECT_EQ(std::count(known.begin(), known.end(), false), 0) << "at most " << most;
  }
}

TEST(Placement, WithoutFloorThereIsAtLeastOneProbe) {
  BoxScene boxes;
  boxes.solid({-0.3f, 0, -0.3f}, {0.3f, 0.5f, 0.3f});
  expect_sound(boxes.scene, place(boxes.scene), 200);
  const Placed empty = place(Scene{});
  EXPECT_EQ(empty.placement.sites.size(), 1u);
}

TEST(Placement, IsTheSameEveryTime) {
  const Scene scene = flat().scene;
  const Placed a = place(scene);
  const Placed b = place(scene);
  ASSERT_EQ(a.placement.sites.size(), b.placement.sites.size());
  for (std::size_t i = 0; i < a.placement.sites.size(); ++i) {
    EXPECT_EQ(a.placement.sites[i].position_m, b.placement.sites[i].position_m);
  }
  EXPECT_EQ(a.placement.grid.probe, b.placement.grid.probe);
}

TEST(Placement, RefusesSpacingsThatCannotBe) {
  BoxScene boxes;
  boxes.room({0, 0, 0}, {4, 2.5f, 4});
  PlacementOptions options;
  options.spacing_m = -1.0;
  EXPECT_THROW(place(boxes.scene, options), BadUsage);
  options.spacing_m = std::nan("");
  EXPECT_THROW(place(boxes.scene, options), BadUsage);
  options.spacing_m = 0.0;
  options.max_probes = 0;
  EXPECT_THROW(place(boxes.scene, options), BadUsage);
}

}  // namespace
}  // namespace probewalk
