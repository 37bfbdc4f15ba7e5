#include "content/scene/procedural/furniture.h"
#include "content/scene/procedural/house_rooms.h"
#include "content/scene/procedural/plants.h"

namespace probewalk::procedural {
namespace {

constexpr double kSouth_m = 16.5, kWallTop_m = 2.3, kWall_m = 0.25;

void build_ground_and_walls(Model& model, const Palette& p) {
  Brush ground(model, "Ground");
  ground.box(p.grass, {-2.0, -0.45, -2.0}, {14.0, -0.12, 18.5});
  ground.object("Paving").box(p.paving, {-0.2, -0.25, 9.2}, {12.2, kCourtyard_m, kSouth_m + 0.2});
  Brush walls(model, "Garden walls");
  walls.box(p.brick, {-kWall_m, -0.2, 9.25}, {0, kWallTop_m, kSouth_m});
  walls.box(p.brick, {12, -0.2, 9.25}, {12 + kWall_m, kWallTop_m, kSouth_m});
  walls.box(p.brick, {-kWall_m, -0.2, kSouth_m}, {12 + kWall_m, kWallTop_m, kSouth_m + kWall_m});
  walls.box(p.trim, {-kWall_m - 0.04, kWallTop_m, 9.26}, {0.04, kWallTop_m + 0.06, kSouth_m - 0.04});
  walls.box(p.trim, {12 - 0.04, kWallTop_m, 9.26}, {12 + kWall_m + 0.04, kWallTop_m + 0.06, kSouth_m - 0.04});
  walls.box(p.trim, {-kWall_m - 0.04, kWallTop_m, kSouth_m - 0.04},
            {12 + kWall_m + 0.04, kWallTop_m + 0.06, kSouth_m + kWall_m + 0.04});
}

// A bed with a stone rim, filled to just below it.
void build_bed(Brush brush, MaterialId rim, MaterialId filling, glm::dvec2 lower, glm::dvec2 upper,
               double height, double fill) {
  const double y = kCourtyard_m - 0.05, top = kCourtyard_m + height, w = 0.12;
  brush.box(rim, {lower.x, y, lower.y}, {upper.x, top, lower.y + w});
  brush.box(rim, {lower.x, y, upper.y - w}, {upper.x, top, upper.y});
  brush.box(rim, {lower.x, y, lower.y + w}, {lower.x + w, top, upper.y - w});
  brush.box(rim, {upper.x - w, y, lower.y + w}, {upper.x, top, upper.y - w});
  brush.box(filling, {lower.x + w, y, lower.y + w}, {upper.x - w, kCourtyard_m + fill, upper.y - w});
}

}  // namespace

void build_courtyard(Model& model, const Palette& p) {
  const auto piece = [&](const char* name, glm::dvec3 at, double yaw_deg = 0.0) {
    return Brush(model, name).at(at, yaw_deg);
  };
  build_ground_and_walls(model, p);
  build_bed(Brush(model, "Lawn"), p.marble, p.grass, {0.9, 11.9}, {5.3, 15.6}, 0.07, 0.05);
  TreeShape tree;
  tree.height_m = 5.4, tree.leaves = 3600, tree.seed = 8, tree.trunk_radius_m = 0.14;
  draw_tree(piece("Tree", {3.2, 0.03, 13.9}), p, p.leaf, tree);
  draw_grass_tufts(piece("Tufts", {3.1, 0.03, 13.75}), p, 3.8, 3.1, 26, 71);
  build_bed(Brush(model, "Flower bed south"), p.marble, p.earth, {5.8, 15.55}, {11.95, 16.49}, 0.35, 0.28);
  for (int i = 0; i < 5; ++i) {
    draw_bush(piece("Bush", {6.5 + 1.2 * i, 0.24, 16.0}), p, i % 2 == 0 ? p.leaf_dark : p.leaf_olive,
              {1.05, 0.75 + 0.18 * (i % 3), 0.8}, 230, static_cast<std::uint32_t>(80 + i));
  }
  build_bed(Brush(model, "Basin"), p.marble, p.water, {9.6, 12.9}, {11.6, 14.6}, 0.38, 0.30);
  draw_round_table(piece("Garden table", {7.6, kCourtyard_m, 11.6}), p.marble, p.black_metal, 0.5, 0.73);
  draw_chair(piece("Garden chair", {6.85, kCourtyard_m, 11.55}, 88), p, p.oak);
  draw_chair(piece("Garden chair", {8.35, kCourtyard_m, 11.7}, -84), p, p.oak);
  draw_chair(piece("Garden chair", {7.6, kCourtyard_m, 12.4}, 176), p, p.oak);
  draw_fruit_bowl(piece("Garden fruit", {7.55, kCourtyard_m + 0.7305, 11.55}), p);
  draw_bench(piece("Garden bench", {0.28, kCourtyard_m, 10.6}, 90), p, p.oak, 1.5);
  draw_potted_plant(piece("Pot by the doors", {6.6, kCourtyard_m, 9.75}), p, p.terracotta, 1.3, 91);
  draw_potted_plant(piece("Pot by the kitchen", {9.45, kCourtyard_m, 9.7}), p, p.terracotta, 1.0, 92);
  draw_potted_plant(piece("Pot in the corner", {11.4, kCourtyard_m, 10.0}), p, p.ceramic_dark, 1.6, 93);
}

}  // namespace probewalk::procedural
