#include "content/scene/procedural/furniture.h"
#include "content/scene/procedural/house_rooms.h"
#include "content/scene/procedural/plants.h"

namespace probewalk::procedural {
namespace {

constexpr double kY = kUpperFloor_m;

void furnish_landing(Model& model, const Palette& p) {
  const auto piece = [&](const char* name, glm::dvec3 at, double yaw_deg = 0.0) {
    return Brush(model, name).at(at, yaw_deg);
  };
  draw_rug(piece("Rug landing", {7.3, kY + 0.002, 2.2}), p.rug_library, p.leather, 2.2, 1.5);
  draw_bench(piece("Window seat", {7.4, kY, 0.27}), p, p.oak, 1.6);
  draw_armchair(piece("Landing chair", {5.85, kY, 0.85}, 40), p, p.armchair_cloth);
  draw_painting(piece("Painting landing", {7.4, kY + 1.6, 4.4}, 180), p.paintings[0], p.walnut, 1.1, 0.8);
  draw_sideboard(piece("Landing chest", {7.4, kY, 4.17}, 180), p, p.oak, 1.2);
  draw_table_lamp(piece("Landing lamp", {7.85, kY + 0.746, 4.2}), p, 345);
  draw_vase(piece("Landing vase", {7.0, kY + 0.746, 4.2}), p.ceramic, 0.28);
  draw_potted_plant(piece("Plant landing", {9.05, kY, 0.5}), p, p.terracotta, 1.3, 31);
  draw_bookcase(piece("Landing bookcase", {5.355, kY, 3.78}, 90), p, p.oak, 0.9, 1.5, 33);
  draw_globe_pendant(piece("Landing pendant", {7.3, kUpperCeiling_m, 2.2}), p, 0.6, 0.13, 225);
}

void furnish_bedroom(Model& model, const Palette& p) {
  const auto piece = [&](const char* name, glm::dvec3 at, double yaw_deg = 0.0) {
    return Brush(model, name).at(at, yaw_deg);
  };
  const double x = 3.65;
  draw_rug(piece("Rug bedroom", {x, kY + 0.002, 6.9}), p.rug_bedroom, p.linen, 3.0, 1.7);
  draw_double_bed(piece("Double bed", {x, kY, 5.685}), p);
  for (const double side : {-1.0, 1.0}) {
    draw_nightstand(piece("Nightstand", {x + 1.16 * side, kY, 4.81}), p);
    draw_table_lamp(piece("Bedside lamp", {x + 1.16 * side, kY + 0.4605, 4.78}), p, 315);
    draw_painting(piece("Painting over bed", {x + 0.42 * side, kY + 1.65, 4.6}),
                  p.paintings[side < 0 ? 2 : 1], p.oak, 0.5, 0.68);
  }
  draw_book_pile(piece("Bedside books", {x + 1.3, kY + 0.4605, 4.9}, 30), p, 2, 41);
  draw_wardrobe(piece("Wardrobe", {6.605, kY, 7.55}, -90), p, 2.5);
  draw_armchair(piece("Bedroom chair", {0.75, kY, 8.2}, 130), p, p.sofa_cloth);
  draw_curtain_rod(piece("Curtain rod bedroom", {2.7, kY + 2.46, 8.87}), p, 4.4);
  draw_curtain(piece("Curtain bedroom west", {1.35, kY + 2.485, 8.87}), p, 1.5, 2.46, 10);
  draw_curtain(piece("Curtain bedroom east", {4.45, kY + 2.485, 8.87}), p, 0.8, 2.46, 8);
  draw_potted_plant(piece("Plant bedroom", {0.45, kY, 5.2}), p, p.ceramic, 1.4, 42);
  draw_globe_pendant(piece("Bedroom pendant", {x, kUpperCeiling_m, 7.0}), p, 0.5, 0.15, 195);
}

void furnish_childrens_room(Model& model, const Palette& p) {
  const auto piece = [&](const char* name, glm::dvec3 at, double yaw_deg = 0.0) {
    return Brush(model, name).at(at, yaw_deg);
  };
  draw_rug(piece("Rug children", {9.3, kY + 0.002, 6.7}), p.rug_living, p.linen, 2.2, 1.6);
  draw_single_bed(piece("Single bed", {11.48, kY, 5.69}), p);
  draw_table(piece("Children's desk", {9.5, kY, 8.62}), p.oak, p.oak, 1.5, 0.65, 0.72);
  draw_chair(piece("Children's chair", {9.4, kY, 8.0}, 8), p, p.walnut);
  draw_reading_spot(piece("Children's lamp", {9.0, kY + 0.7205, 8.72}, 20), p, 300);
  draw_book_pile(piece("School books", {10.0, kY + 0.7205, 8.65}, 20), p, 4, 51);
  draw_bookcase(piece("Children's bookcase", {7.255, kY, 7.4}, 90), p, p.oak, 1.7, 1.15, 52);
  draw_wall_shelf(piece("Children's shelf", {10.4, kY + 1.5, 4.60}), p, 1.0, 53);
  draw_painting(piece("Children's painting", {7.10, kY + 1.75, 7.4}, 90), p.paintings[1], p.trim, 0.6, 0.8);
  draw_wardrobe(piece("Children's wardrobe", {7.62, kY, 4.91}), p, 1.0);
  const MaterialId blocks[] = {p.toy_red, p.toy_yellow, p.toy_blue};
  for (int i = 0; i < 6; ++i) {
    const double x = 9.0 + 0.16 * (i % 3), z = 6.55 + 0.17 * (i / 3);
    piece("Toy block", {x, kY + 0.0145, z}, 25.0 * i)
        .cushion(blocks[i % 3], {-0.05, 0, -0.05}, {0.05, 0.1, 0.05}, 0.006, 1);
  }
  piece("Toy block", {9.08, kY + 0.115, 6.56}, 40)
      .cushion(p.toy_yellow, {-0.05, 0, -0.05}, {0.05, 0.1, 0.05}, 0.006, 1);
  piece("Toy ball", {9.85, kY + 0.135, 6.95}).ball(p.toy_red, {0, 0, 0}, 0.12, 18);
  draw_globe_pendant(piece("Children's pendant", {9.3, kUpperCeiling_m, 6.7}), p, 0.5, 0.15, 225);
  draw_potted_plant(piece("Plant children", {11.5, kY, 8.5}), p, p.terracotta, 1.0, 54);
}

void furnish_bathroom(Model& model, const Palette& p) {
  const auto piece = [&](const char* name, glm::dvec3 at, double yaw_deg = 0.0) {
    return Brush(model, name).at(at, yaw_deg);
  };
  draw_bathtub(piece("Bathtub", {2.90, kY, 1.65}, 90), p);
  draw_washstand(piece("Washstand", {3.65, kY, 4.145}, 180), p);
  draw_toilet(piece("Toilet", {4.55, kY, 0.43}), p);
  draw_stool(piece("Bath stool", {3.65, kY, 0.55}), p, 0.46);
  draw_rug(piece("Bath mat", {3.75, kY + 0.002, 1.9}, 90), p.rug_bedroom, p.linen, 1.1, 0.7);
  draw_painting(piece("Bath painting", {3.65, kY + 1.75, 4.4}, 180), p.paintings[2], p.oak, 0.5, 0.65);
  draw_potted_plant(piece("Plant bath", {2.65, kY, 3.5}), p, p.ceramic, 0.9, 61);
  draw_ceiling_lamp(piece("Bath lamp", {3.65, kUpperCeiling_m, 2.3}), p, 610);
}

void furnish_dressing_room(Model& model, const Palette& p) {
  const auto piece = [&](const char* name, glm::dvec3 at, double yaw_deg = 0.0) {
    return Brush(model, name).at(at, yaw_deg);
  };
  draw_clothes_rail(piece("Clothes rail", {0.42, kY, 2.0}, 90), p, 2.4);
  draw_sideboard(piece("Dressing chest", {1.865, kY, 1.6}, -90), p, p.walnut, 1.4);
  draw_stool(piece("Dressing stool", {1.3, kY, 3.3}), p, 0.46);
  draw_rug(piece("Rug dressing", {1.15, kY + 0.002, 2.1}, 90), p.rug_bedroom, p.linen, 1.8, 0.8);
  draw_painting(piece("Dressing painting", {2.1, kY + 1.6, 1.6}, -90), p.paintings[3], p.brass, 0.7, 0.52);
  draw_ceiling_lamp(piece("Dressing lamp", {1.1, kUpperCeiling_m, 2.1}), p, 480);
}

}  // namespace

void furnish_upper_floor(Model& model, const Palette& p) {
  furnish_landing(model, p);
  furnish_bedroom(model, p);
  furnish_childrens_room(model, p);
  furnish_bathroom(model, p);
  furnish_dressing_room(model, p);
}

}  // namespace probewalk::procedural
