#include "content/scene/procedural/furniture.h"
#include "content/scene/procedural/house_rooms.h"
#include "content/scene/procedural/plants.h"

namespace probewalk::procedural {
namespace {

void furnish_living_room(Model& model, const Palette& p) {
  const auto piece = [&](const char* name, glm::dvec3 at, double yaw_deg = 0.0) {
    return Brush(model, name).at(at, yaw_deg);
  };
  draw_rug(piece("Rug living", {4.2, 0.002, 6.75}), p.rug_living, p.linen, 2.9, 2.0);
  draw_sofa(piece("Sofa", {4.22, 0, 5.14}), p, 2.3);
  draw_coffee_table(piece("Coffee table", {4.2, 0.014, 6.55}), p);
  draw_book_pile(piece("Books on coffee table", {3.85, 0.41, 6.5}, 20), p, 3, 5);
  draw_vase(piece("Vase on coffee table", {4.5, 0.4095, 6.65}), p.terracotta, 0.24);
  draw_armchair(piece("Armchair west", {2.25, 0, 6.35}, 80), p, p.armchair_cloth);
  draw_armchair(piece("Armchair south", {2.75, 0, 7.75}, 142), p, p.armchair_cloth);
  draw_sideboard(piece("Sideboard", {0.235, 0, 6.7}, 90), p, p.walnut, 1.9);
  draw_table_lamp(piece("Sideboard lamp", {0.25, 0.746, 7.35}), p, 345);
  draw_vase(piece("Sideboard vase", {0.25, 0.746, 6.1}), p.ceramic_dark, 0.32);
  draw_book_pile(piece("Sideboard books", {0.25, 0.746, 6.55}, 80), p, 4, 9);
  draw_floor_lamp(piece("Floor lamp", {2.86, 0, 5.0}), p, 825);
  draw_painting(piece("Painting hills", {4.22, 1.62, 4.6}), p.paintings[0], p.walnut, 1.3, 0.95);
  draw_painting(piece("Painting plant", {6.9, 1.6, 8.2}, -90), p.paintings[2], p.oak, 0.55, 0.75);
  draw_curtain_rod(piece("Curtain rod living", {3.4, 2.52, 8.86}), p, 5.9);
  draw_curtain(piece("Curtain living west", {1.15, 2.545, 8.86}), p, 1.15, 2.51, 8);
  draw_curtain(piece("Curtain living east", {5.95, 2.545, 8.86}), p, 0.8, 2.51, 7);
  draw_potted_plant(piece("Plant living", {0.5, 0, 5.1}), p, p.ceramic, 1.5, 3);
  draw_potted_plant(piece("Plant living east", {6.45, 0, 8.15}), p, p.terracotta, 1.1, 4);
  draw_round_table(piece("Side table", {1.7, 0, 7.25}), p.marble, p.black_metal, 0.24, 0.48);
  draw_candle(piece("Candle", {1.7, 0.4805, 7.25}), p, 0.2);
}

void furnish_kitchen(Model& model, const Palette& p) {
  const auto piece = [&](const char* name, glm::dvec3 at, double yaw_deg = 0.0) {
    return Brush(model, name).at(at, yaw_deg);
  };
  draw_fridge(piece("Fridge", {9.35, 0, 4.906}), p);
  draw_counter(piece("Counter north", {10.53, 0, 4.905}), p, 1.72, false, true);
  draw_counter(piece("Counter corner", {11.694, 0, 4.905}), p, 0.60, false, false);
  draw_counter(piece("Counter east", {11.694, 0, 6.615}, -90), p, 2.80, true, false);
  draw_wall_cabinet(piece("Wall cabinets", {10.53, 1.48, 4.775}), p, 1.72);
  Brush(model, "Kitchen tiles").box(p.kitchen_wall, {9.67, 0.915, 4.59}, {11.99, 1.478, 4.612});
  Brush(model, "Kitchen tiles east").box(p.kitchen_wall, {11.988, 0.915, 4.613}, {12.01, 1.06, 8.01});
  draw_fruit_bowl(piece("Fruit bowl", {9.75, 0.7505, 7.2}), p);
  const double table_x = 9.35, table_z = 7.2;
  draw_table(piece("Dining table", {table_x, 0, table_z}), p.walnut_glossy, p.walnut, 1.9, 0.95, 0.75);
  for (const double x : {-0.45, 0.45}) {
    draw_chair(piece("Chair", {table_x + x, 0, table_z - 0.62}, 2), p, p.oak);
    draw_chair(piece("Chair", {table_x + x, 0, table_z + 0.64}, 180 + 12 * x), p, p.oak);
    draw_tableware(piece("Tableware", {table_x + x - 0.05, 0.7505, table_z - 0.27}), p);
    draw_tableware(piece("Tableware", {table_x + x + 0.05, 0.7505, table_z + 0.27}, 180), p);
    draw_pendant(piece("Dining pendant", {table_x + x, kGroundCeiling_m, table_z}), p, 1.02, 640);
  }
  draw_chair(piece("Chair", {table_x - 1.16, 0, table_z}, 84), p, p.oak);
  draw_ceiling_lamp(piece("Kitchen lamp", {10.9, kGroundCeiling_m, 5.75}), p, 480);
  draw_vase(piece("Jug", {11.70, 0.9205, 5.0}), p.ceramic, 0.28);
  draw_vase(piece("Jar", {11.76, 0.9205, 7.75}), p.terracotta, 0.20);
  draw_wall_shelf(piece("Kitchen shelf", {7.10, 1.55, 5.15}, 90), p, 0.85, 12);
  draw_potted_plant(piece("Herbs", {11.72, 0.9205, 5.45}), p, p.terracotta, 0.32, 6);
  draw_painting(piece("Painting sea", {7.10, 1.6, 8.25}, 90), p.paintings[3], p.oak, 0.8, 0.6);
  draw_potted_plant(piece("Plant kitchen", {11.55, 0, 8.5}), p, p.ceramic, 1.25, 7);
}

void furnish_hall(Model& model, const Palette& p) {
  const auto piece = [&](const char* name, glm::dvec3 at, double yaw_deg = 0.0) {
    return Brush(model, name).at(at, yaw_deg);
  };
  // The front door stays shut.
  Brush door = piece("Front door", {6.9, 0, -0.14});
  door.box(p.counter_front, {-0.469, 0.004, -0.025}, {0.469, 2.118, 0.025});
  for (const double y : {0.20, 1.15}) door.box(p.counter_front, {-0.36, y, -0.035}, {0.36, y + 0.75, 0.035});
  door.box(p.brass, {0.37, 1.0, 0.025}, {0.43, 1.03, 0.075});
  draw_rug(piece("Rug hall", {7.2, 0.002, 2.1}), p.rug_hall, p.linen, 2.4, 1.5);
  draw_table(piece("Console", {7.25, 0, 4.19}), p.walnut, p.walnut, 1.0, 0.36, 0.82);
  draw_table_lamp(piece("Console lamp", {6.95, 0.821, 4.2}), p, 345);
  draw_vase(piece("Console vase", {7.55, 0.821, 4.2}), p.terracotta, 0.3);
  draw_painting(piece("Painting blocks", {7.25, 1.65, 4.4}, 180), p.paintings[1], p.black_metal, 0.66, 0.9);
  draw_bench(piece("Hall bench", {8.45, 0, 0.27}), p, p.oak, 1.2);
  draw_potted_plant(piece("Plant hall", {5.6, 0, 0.45}), p, p.ceramic, 1.6, 9);
  draw_globe_pendant(piece("Hall pendant", {7.2, kGroundCeiling_m, 2.1}), p, 0.52, 0.13, 225);
  draw_globe_pendant(piece("Stair pendant", {10.79, kUpperCeiling_m, 1.7}), p, 2.3, 0.16, 290);
  draw_sideboard(piece("Chest", {5.435, 0, 3.55}, 90), p, p.oak, 1.1);
  draw_candle(piece("Chest candle", {5.42, 0.746, 3.3}), p, 0.24);
  draw_vase(piece("Chest bowl", {5.43, 0.746, 3.8}), p.ceramic_dark, 0.2);
}

void furnish_library(Model& model, const Palette& p) {
  const auto piece = [&](const char* name, glm::dvec3 at, double yaw_deg = 0.0) {
    return Brush(model, name).at(at, yaw_deg);
  };
  draw_bookcase(piece("Bookcase west", {0.915, 0, 4.245}, 180), p, p.walnut, 1.78, 2.4, 21);
  draw_bookcase(piece("Bookcase east", {3.96, 0, 4.245}, 180), p, p.walnut, 1.9, 2.4, 22);
  draw_bookcase(piece("Bookcase door", {4.845, 0, 0.88}, -90), p, p.walnut, 1.3, 2.4, 23);
  draw_fireplace(piece("Fireplace", {0.002, 0, 2.2}, 90), p);
  draw_painting(piece("Painting over fire", {0.0, 1.85, 2.2}, 90), p.paintings[3], p.brass, 1.0, 0.75);
  draw_candle(piece("Mantel candle", {0.22, 1.2005, 1.62}), p, 0.28);
  draw_candle(piece("Mantel candle", {0.22, 1.2005, 1.75}), p, 0.22);
  draw_vase(piece("Mantel vase", {0.22, 1.2005, 2.75}), p.ceramic_dark, 0.22);
  draw_rug(piece("Rug library", {2.15, 0.002, 2.2}), p.rug_library, p.leather, 2.4, 1.7);
  draw_armchair(piece("Reading chair", {2.3, 0, 1.65}, -68), p, p.leather);
  draw_armchair(piece("Reading chair", {2.3, 0, 2.85}, -112), p, p.leather);
  draw_round_table(piece("Reading table", {2.62, 0.014, 2.25}), p.walnut_glossy, p.brass, 0.2, 0.52);
  draw_book_pile(piece("Reading books", {2.62, 0.5345, 2.25}, 50), p, 2, 15);
  draw_desk(piece("Desk", {3.45, 0, 0.40}), p);
  draw_chair(piece("Desk chair", {3.30, 0, 1.0}, 172), p, p.oak);
  draw_reading_spot(piece("Desk lamp", {2.95, 0.7405, 0.3}), p, 420);
  draw_book_pile(piece("Desk books", {3.98, 0.7405, 0.36}, -15), p, 5, 16);
  Brush(model, "Papers").at({3.35, 0.7405, 0.48}, 8).box(p.paper, {-0.105, 0, -0.15}, {0.105, 0.006, 0.15});
  draw_floor_lamp(piece("Library lamp", {0.45, 0, 0.45}), p, 960);
  draw_globe_pendant(piece("Library pendant", {2.6, kGroundCeiling_m, 2.4}), p, 0.5, 0.13, 195);
}

}  // namespace

void furnish_ground_floor(Model& model, const Palette& p) {
  furnish_living_room(model, p);
  furnish_kitchen(model, p);
  furnish_hall(model, p);
  furnish_library(model, p);
}

}  // namespace probewalk::procedural
