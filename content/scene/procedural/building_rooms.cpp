#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "content/scene/procedural/building_parts.h"
#include "content/scene/procedural/furniture.h"
#include "content/scene/procedural/plants.h"
#include "content/scene/procedural/texture_canvas.h"

namespace probewalk::procedural::building {
namespace {

// One room being furnished: places along its sides, in its corners and in its middle, none of them before a doorway.
class Furnisher {
 public:
  Furnisher(Parts& parts, const Palette& p, const Room& room) : p_(p), parts_(parts), room_(room) {
    for (int side = kNorth; side <= kWest; ++side)
      if (room.sides[std::size_t(side)].opening == Opening::kNone) bare_.push_back(side);
  }

  double roll(int what) const { return hash01(room_.seed, what, 4711); }
  int pick(int what, int count) const { return std::min(count - 1, int(roll(what) * count)); }
  bool has_bare_side() const { return !bare_.empty(); }

  // At x, z of the room's middle.
  template <class Draw>
  void in_middle(const std::string& variant, Draw draw, glm::dvec3 offset_m = glm::dvec3(0.0), double yaw_deg = 0.0) {
    parts_.place(variant, draw, middle_m() + turned(offset_m, 0.0), yaw_deg);
  }
  template <class Draw>
  void under_ceiling(const std::string& variant, Draw draw) {
    parts_.place(variant, draw, middle_m() + glm::dvec3(0.0, room_.upper_m.y - room_.lower_m.y, 0.0));
  }
  // Back to the middle of the first bare side, `out_m` from it, `along_m` to the right as one faces the room.
  template <class Draw>
  void at_bare_side(const std::string& variant, Draw draw, double out_m, double along_m = 0.0, double up_m = 0.0) {
    at_side(bare_.front(), variant, draw, out_m, along_m, up_m);
  }
  template <class Draw>
  void at_side(int side, const std::string& variant, Draw draw, double out_m, double along_m = 0.0, double up_m = 0.0) {
    const double reach_m = 0.5 * (side % 2 == 0 ? room_.depth_m() : room_.width_m());
    const double yaw_deg = -90.0 * side;  // the north side's furniture faces south: +z
    parts_.place(variant, draw, middle_m() + turned({along_m, up_m, out_m - reach_m}, yaw_deg), yaw_deg);
  }
  // In the corner where side `corner` begins on the left as one faces it, `in_m` from both walls.
  template <class Draw>
  void in_corner(int corner, const std::string& variant, Draw draw, double in_m, double turn_deg = 45.0) {
    const double half_m = 0.5 * room_.length_m(corner),
                 reach_m = 0.5 * (corner % 2 == 0 ? room_.depth_m() : room_.width_m());
    const double yaw_deg = -90.0 * corner;
    parts_.place(variant, draw, middle_m() + turned({in_m - half_m, 0.0, in_m - reach_m}, yaw_deg), yaw_deg + turn_deg);
  }
  // Flat against side `corner`, in the same corner; the piece is `width_m` wide and `depth_m` deep.
  template <class Draw>
  void along_corner(int corner, const std::string& variant, Draw draw, double width_m, double depth_m) {
    at_side(corner, variant, draw, 0.5 * depth_m + 0.02, 0.5 * width_m + 0.04 - 0.5 * room_.length_m(corner));
  }
  void paintings() {
    for (const int side : bare_) {
      const int which = pick(40 + side, kPaintings);
      at_side(
          side, fmt::format("Painting {}", which),
          [&](Brush b) { draw_painting(b, p_.paintings[std::size_t(which)], p_.walnut, 0.9, 0.7); }, 0.002, 0.0, 1.6);
    }
  }
  void plant(int corner) {
    const int which = pick(50 + corner, 3);
    in_corner(
        corner, fmt::format("Plant {}", which),
        [&](Brush b) {
          draw_potted_plant(b, p_, which == 0 ? p_.ceramic : p_.terracotta, 0.9 + 0.2 * which,
                            std::uint32_t(70 + which));
        },
        0.4);
  }
  void bookcase(int corner) {
    const int which = pick(60 + corner, 3);
    along_corner(
        corner, fmt::format("Bookcase {}", which),
        [&](Brush b) {
          draw_bookcase(b, p_, which == 1 ? p_.oak : p_.walnut, 0.95, which == 2 ? 1.3 : 2.1, 80 + which);
        },
        0.95, 0.31);
  }
  void armchair(int corner) {
    const int which = pick(70 + corner, 3);
    const std::array cloths{p_.armchair_cloth, p_.cushion_teal, p_.cushion_rust};
    in_corner(
        corner, fmt::format("Armchair {}", which), [&](Brush b) { draw_armchair(b, p_, cloths[std::size_t(which)]); },
        0.68);
  }
  void floor_lamp(int corner) {
    in_corner(corner, "Floor lamp", [&](Brush b) { draw_floor_lamp(b, p_, 220); }, 0.38, 0.0);
  }
  void rug(double width_m, double depth_m) {
    const int which = pick(5, 3);
    const std::array rugs{p_.rug_living, p_.rug_library, p_.rug_bedroom};
    in_middle(fmt::format("Rug {} {:.1f}", which, width_m),
              [&](Brush b) { draw_rug(b, rugs[std::size_t(which)], p_.linen, width_m, depth_m); }, {0, 0.002, 0});
  }
  void chairs(double from_middle_x, double from_middle_z) {
    const bool oak = roll(6) < 0.5;
    const auto draw = [&](Brush b) { draw_chair(b, p_, oak ? p_.oak : p_.walnut); };
    const std::string variant = oak ? "Chair oak" : "Chair walnut";
    in_middle(variant, draw, {-0.35, 0, -from_middle_z}, 4.0);
    in_middle(variant, draw, {0.35, 0, from_middle_z}, 176.0);
    in_middle(variant, draw, {-from_middle_x, 0, 0.05}, 93.0);
    in_middle(variant, draw, {from_middle_x, 0, -0.05}, -88.0);
  }
  // Lamps differ by kind and strength.
  void lamp(double candela) {
    const int which = pick(7, 3);
    const double strength = candela * (0.8 + 0.2 * pick(8, 3));
    const std::string variant = fmt::format("Lamp {} {:.0f}", which, strength);
    under_ceiling(variant, [&](Brush b) {
      if (which == 0) draw_ceiling_lamp(b, p_, strength);
      if (which == 1) draw_globe_pendant(b, p_, 0.5, 0.14, strength);
      if (which == 2) draw_pendant(b, p_, 0.6, strength);
    });
  }

 private:
  glm::dvec3 middle_m() const {
    return {0.5 * (room_.lower_m.x + room_.upper_m.x), room_.lower_m.y, 0.5 * (room_.lower_m.z + room_.upper_m.z)};
  }
  static glm::dvec3 turned(glm::dvec3 v, double yaw_deg) {
    const double a = glm::radians(yaw_deg);
    return {std::cos(a) * v.x + std::sin(a) * v.z, v.y, std::cos(a) * v.z - std::sin(a) * v.x};
  }

  const Palette& p_;
  Parts& parts_;
  const Room& room_;
  std::vector<int> bare_;
};

void furnish_living(Furnisher& f, const Palette& p) {
  f.rug(2.0, 1.4);
  f.in_middle("Coffee table", [&](Brush b) { draw_coffee_table(b, p); }, {0, 0.012, 0});
  f.at_bare_side("Sofa", [&](Brush b) { draw_sofa(b, p, 2.0); }, 0.5);
  f.armchair(1), f.armchair(3);
  f.floor_lamp(2);
  f.plant(0);
  f.lamp(260);
}

void furnish_library(Furnisher& f, const Palette& p) {
  for (int corner = 0; corner < 4; ++corner) f.bookcase(corner);
  f.rug(2.2, 1.5);
  f.in_middle("Reading table", [&](Brush b) { draw_round_table(b, p.walnut_glossy, p.walnut, 0.55, 0.74); },
              {0, 0.012, 0});
  f.in_middle("Table lamp", [&](Brush b) { draw_table_lamp(b, p, 220); }, {0.1, 0.7535, 0.0});
  f.in_middle("Book pile", [&](Brush b) { draw_book_pile(b, p, 4, 9); }, {-0.22, 0.7535, 0.1}, 30.0);
  f.paintings();
  f.lamp(240);
}

void furnish_dining(Furnisher& f, const Palette& p) {
  f.in_middle("Dining table", [&](Brush b) { draw_table(b, p.oak, p.oak, 1.5, 0.9, 0.75); });
  f.chairs(0.95, 0.65);
  f.in_middle("Fruit bowl", [&](Brush b) { draw_fruit_bowl(b, p); }, {0, 0.7505, 0});
  f.along_corner(0, "Sideboard", [&](Brush b) { draw_sideboard(b, p, p.walnut, 0.95); }, 0.95, 0.44);
  f.plant(2);
  f.paintings();
  f.lamp(280);
}

void furnish_bedroom(Furnisher& f, const Palette& p) {
  f.at_bare_side("Double bed", [&](Brush b) { draw_double_bed(b, p); }, 1.09);
  f.at_bare_side("Nightstand", [&](Brush b) { draw_nightstand(b, p); }, 0.24, 1.16);
  f.at_bare_side("Bedside lamp", [&](Brush b) { draw_table_lamp(b, p, 200); }, 0.24, 1.16, 0.4605);
  f.at_bare_side(
      "Bedroom painting", [&](Brush b) { draw_painting(b, p.paintings[2], p.oak, 0.8, 0.6); }, 0.002, 0.0, 1.65);
  f.lamp(220);
}

void furnish_study(Furnisher& f, const Palette& p) {
  f.at_bare_side("Desk", [&](Brush b) { draw_desk(b, p); }, 0.42);
  f.at_bare_side("Reading spot", [&](Brush b) { draw_reading_spot(b, p, 260); }, 0.35, 0.45, 0.7605);
  f.in_middle("Round rug", [&](Brush b) { draw_rug(b, p.rug_hall, p.linen, 1.4, 1.0); }, {0, 0.002, 0});
  f.bookcase(1), f.bookcase(2);
  f.armchair(3);
  f.plant(0);
  f.lamp(230);
}

void furnish_kitchen(Furnisher& f, const Palette& p) {
  f.at_bare_side("Counter", [&](Brush b) { draw_counter(b, p, 2.4, true, true); }, 0.32);
  f.at_bare_side("Wall cabinet", [&](Brush b) { draw_wall_cabinet(b, p, 2.4); }, 0.19, 0.0, 1.45);
  f.in_middle("Kitchen table", [&](Brush b) { draw_table(b, p.oak, p.trim, 1.1, 0.8, 0.74); });
  f.chairs(0.75, 0.6);
  f.in_middle("Tableware", [&](Brush b) { draw_tableware(b, p); }, {0.25, 0.7405, 0.1});
  f.lamp(280);
}

void furnish_bath(Furnisher& f, const Palette& p) {
  f.at_bare_side("Bathtub", [&](Brush b) { draw_bathtub(b, p); }, 0.42);
  f.in_corner(2, "Washstand", [&](Brush b) { draw_washstand(b, p); }, 0.6);
  f.in_corner(1, "Toilet", [&](Brush b) { draw_toilet(b, p); }, 0.6);
  f.in_middle("Bath mat", [&](Brush b) { draw_rug(b, p.rug_bedroom, p.linen, 1.1, 0.7); }, {0, 0.002, 0});
  f.in_middle("Bath stool", [&](Brush b) { draw_stool(b, p, 0.46); }, {0.2, 0.0, 0.1});
  f.plant(3);
  f.lamp(270);
}

void furnish_gallery(Furnisher& f, const Palette& p) {
  f.paintings();
  f.in_middle("Pedestal", [&](Brush b) { b.box(p.marble, {-0.25, 0, -0.25}, {0.25, 0.95, 0.25}); });
  const int which = f.pick(9, 3);
  const std::array clays{p.ceramic, p.terracotta, p.ceramic_dark};
  f.in_middle(fmt::format("Vase {}", which), [&](Brush b) { draw_vase(b, clays[std::size_t(which)], 0.55); },
              {0, 0.9505, 0});
  for (int corner = 0; corner < 4; corner += 2) f.plant(corner);
  f.along_corner(1, "Bench", [&](Brush b) { draw_bench(b, p, p.oak, 1.0); }, 1.0, 0.5);
  f.lamp(300);
}

void furnish_playroom(Furnisher& f, const Palette& p) {
  f.rug(1.8, 1.3);
  const std::array blocks{p.toy_red, p.toy_yellow, p.toy_blue};
  for (int i = 0; i < 7; ++i) {
    const double x = -0.7 + 0.24 * i, z = 0.4 * f.roll(100 + i) - 0.2;
    f.in_middle(
        fmt::format("Block {}", i % 3),
        [&](Brush b) { b.cushion(blocks[std::size_t(i % 3)], {-0.09, 0, -0.09}, {0.09, 0.18, 0.09}, 0.008, 1); },
        {x, 0.0145, z}, 90.0 * f.roll(110 + i));
  }
  f.in_middle("Ball", [&](Brush b) { b.ball(p.toy_red, {0, 0.2, 0}, 0.2, 18); }, {0.3, 0.0145, 0.5});
  f.along_corner(1, "Toy shelf", [&](Brush b) { draw_bookcase(b, p, p.oak, 0.95, 1.1, 52); }, 0.95, 0.31);
  f.along_corner(3, "Toy chest", [&](Brush b) { draw_sideboard(b, p, p.oak, 0.9); }, 0.9, 0.44);
  f.armchair(0);
  f.lamp(260);
}

void furnish_winter_garden(Furnisher& f, const Palette& p) {
  for (int corner = 0; corner < 4; ++corner) f.plant(corner);
  f.in_middle("Garden table", [&](Brush b) { draw_round_table(b, p.marble, p.black_metal, 0.5, 0.72); });
  f.chairs(0.8, 0.8);
  f.in_middle("Garden pot", [&](Brush b) { draw_potted_plant(b, p, p.ceramic_dark, 0.6, 91); }, {0, 0.7205, 0});
  f.lamp(250);
}

void furnish_stairwell(Parts& parts, const Palette& p, const Room& room) {
  // One lamp for each storey, off the void.
  const double x = room.lower_m.x + 3.4, z = room.lower_m.z + 0.5 * (kVoid_m + room.depth_m());
  for (int storey = 0; storey < kStoreys; ++storey)
    parts.place("Stair lamp", [&](Brush b) { draw_ceiling_lamp(b, p, 320); }, {x, kStorey_m * storey + kCeiling_m, z});
}

void furnish_terrace(Furnisher& f, const Palette& p) {
  for (int corner = 0; corner < 4; ++corner) f.plant(corner);
  f.at_side(kSouth, "Bench", [&](Brush b) { draw_bench(b, p, p.oak, 1.0); }, 0.4);
}

}  // namespace

void furnish(Parts& parts, const Palette& p, const Room& room) {
  Furnisher f(parts, p, room);
  switch (room.kind) {
    case Kind::kLiving:
      return furnish_living(f, p);
    case Kind::kLibrary:
      return furnish_library(f, p);
    case Kind::kDining:
      return furnish_dining(f, p);
    case Kind::kBedroom:
      return furnish_bedroom(f, p);
    case Kind::kStudy:
      return furnish_study(f, p);
    case Kind::kKitchen:
      return furnish_kitchen(f, p);
    case Kind::kBath:
      return furnish_bath(f, p);
    case Kind::kGallery:
      return furnish_gallery(f, p);
    case Kind::kPlayroom:
      return furnish_playroom(f, p);
    case Kind::kWinterGarden:
      return furnish_winter_garden(f, p);
    case Kind::kStairwell:
      return furnish_stairwell(parts, p, room);
    case Kind::kTerrace:
      return furnish_terrace(f, p);
  }
}

}  // namespace probewalk::procedural::building
