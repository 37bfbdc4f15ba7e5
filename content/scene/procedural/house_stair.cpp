#include <algorithm>

#include "content/scene/procedural/house_shell.h"

namespace probewalk::procedural {
namespace {

constexpr int kTreads = 8;  // per flight; the ninth rise reaches the landing or the floor
constexpr double kRise_m = kUpperFloor_m / 18.0, kTread_m = 0.28;
constexpr double kFoot_z = 3.3, kLanding_z = kFoot_z - kTreads * kTread_m, kLanding_y = 9 * kRise_m;
constexpr double kWest_x = 9.62, kGapWest_x = 10.72, kGapEast_x = 10.86, kEast_x = 12.02;
constexpr double kRail_m = 0.95;  // above the nosings

// A flight between x0 and x1 that starts at (foot_y, foot_z) and climbs towards `heading` (+1 south, -1
// north): oak treads and risers on a sloping plaster slab.
void build_flight(Brush& brush, const Palette& p, double x0, double x1, double foot_y, double foot_z,
                  double heading) {
  const auto span = [&](double a, double b) {
    return std::pair{foot_z + heading * std::min(a, b), foot_z + heading * std::max(a, b)};
  };
  const auto box = [&](MaterialId material, double xa, double xb, double ya, double yb, double a, double b) {
    const auto [first, second] = span(a, b);
    brush.box(material, {xa, ya, std::min(first, second)}, {xb, yb, std::max(first, second)});
  };
  for (int k = 1; k <= kTreads; ++k) {
    const double top = foot_y + k * kRise_m, at = (k - 1) * kTread_m;
    box(p.oak, x0 - 0.004, x1 + 0.004, top - 0.035, top, at - 0.02, at + kTread_m + 0.002);
    box(p.trim, x0 + 0.002, x1 - 0.002, top - kRise_m, top - 0.035, at, at + 0.02);
  }
  box(p.trim, x0 + 0.002, x1 - 0.002, foot_y + kTreads * kRise_m, foot_y + 9 * kRise_m - 0.036,
      kTreads * kTread_m, kTreads * kTread_m + 0.02);
  // The slab: a parallelogram whose upper side touches the inner corners of the steps, with strings 5 cm
  // proud of it.
  const double length = kTreads * kTread_m, climb = kTreads * kRise_m;
  const auto prism = [&](MaterialId material, double xa, double xb, double above, double below, double from,
                         double to) {
    const auto y_at = [&](double along, double off) { return foot_y + climb * along / length + off; };
    const auto corner = [&](double x, double along, double off) {
      return glm::dvec3(x, y_at(along, off), foot_z + heading * along);
    };
    const glm::dvec3 a0 = corner(xa, from, -below), b0 = corner(xa, to, -below), c0 = corner(xa, to, above),
                     d0 = corner(xa, from, above);
    const glm::dvec3 a1 = corner(xb, from, -below), b1 = corner(xb, to, -below), c1 = corner(xb, to, above),
                     d1 = corner(xb, from, above);
    const auto quad = [&](glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::dvec3 d) {
      if (heading > 0)
        brush.quad(material, b, a, d, c);
      else
        brush.quad(material, a, b, c, d);
    };
    quad(b0, a0, d0, c0), quad(a1, b1, c1, d1);  // sides
    quad(a0, b0, b1, a1), quad(d1, c1, c0, d0);  // below, above
    quad(a0, a1, d1, d0), quad(b1, b0, c0, c1);  // ends
  };
  prism(p.plaster_white, x0 + 0.03, x1 - 0.03, -0.002, 0.14, 0.02, length);
  prism(p.trim, x0, x0 + 0.03, 0.03, 0.16, 0.0, length);
  prism(p.trim, x1 - 0.03, x1, 0.03, 0.16, 0.0, length);
}

// Balusters of 2 cm and a round oak rail from one end to the other; the ends are points on the floor.
void build_balustrade(Brush& brush, const Palette& p, glm::dvec3 from, glm::dvec3 to, int balusters,
                      bool posts_at_ends) {
  const glm::dvec3 up{0, kRail_m, 0};
  for (int i = 0; i < balusters; ++i) {
    const glm::dvec3 foot = glm::mix(from, to, (i + 0.5) / balusters);
    brush.rod(p.black_metal, foot - glm::dvec3(0, 0.06, 0), foot + up - glm::dvec3(0, 0.01, 0), 0.010, 6);
  }
  brush.rod(p.oak, from + up, to + up, 0.024, 10);
  if (!posts_at_ends) return;
  for (const glm::dvec3& end : {from, to})
    brush.box(p.oak, end + glm::dvec3(-0.035, -0.05, -0.035), end + glm::dvec3(0.035, kRail_m + 0.08, 0.035));
}

}  // namespace

void build_stair(Model& model, const Palette& p) {
  Brush brush(model, "Stair");
  build_flight(brush, p, kWest_x, kGapWest_x, 0.0, kFoot_z, -1.0);
  build_flight(brush, p, kGapEast_x, kEast_x, kLanding_y, kLanding_z, 1.0);
  brush.box(p.trim, {kWest_x, kLanding_y - 0.20, -0.03}, {kEast_x, kLanding_y - 0.036, kLanding_z - 0.003});
  brush.box(p.oak, {kWest_x - 0.004, kLanding_y - 0.035, -0.03}, {kEast_x, kLanding_y, kLanding_z + 0.02});
  for (const double x : {kWest_x + 0.05, kGapWest_x})
    brush.box(p.trim, {x, -0.02, 0.85}, {x + 0.08, kLanding_y - 0.1, 0.93});

  Brush rails(model, "Balustrades");
  const double run = kTreads * kTread_m, climb = kTreads * kRise_m;
  const auto flight_rail = [&](double x, double y, double z, double heading) {
    build_balustrade(rails, p, {x, y + kRise_m, z}, {x, y + kRise_m + climb, z + heading * run}, 2 * kTreads,
                     false);
  };
  flight_rail(kWest_x + 0.05, 0.0, kFoot_z, -1.0);
  flight_rail(kGapWest_x - 0.05, 0.0, kFoot_z, -1.0);
  flight_rail(kGapEast_x + 0.05, kLanding_y, kLanding_z, 1.0);
  build_balustrade(rails, p, {kWest_x + 0.05, kLanding_y, 0.02}, {kWest_x + 0.05, kLanding_y, kLanding_z}, 8,
                   false);
  for (const double x : {kWest_x + 0.05, kGapWest_x - 0.05}) {
    rails.box(p.oak, {x - 0.035, -0.02, kFoot_z - 0.005}, {x + 0.035, kRail_m + 0.25, kFoot_z + 0.065});
    rails.box(p.oak, {x - 0.035, kLanding_y - 0.02, kLanding_z - 0.035},
              {x + 0.035, kLanding_y + kRail_m + 0.22, kLanding_z + 0.035});
  }
  const double x = kGapEast_x + 0.05;
  rails.box(p.oak, {x - 0.035, kLanding_y - 0.02, kLanding_z - 0.055},
            {x + 0.035, kLanding_y + kRail_m + 0.22, kLanding_z + 0.015});
  // Upstairs, around the void.
  build_balustrade(rails, p, {9.54, kUpperFloor_m, 0.05}, {9.54, kUpperFloor_m, kFoot_z + 0.06}, 28, true);
  build_balustrade(rails, p, {9.54, kUpperFloor_m, kFoot_z + 0.06},
                   {kGapEast_x + 0.05, kUpperFloor_m, kFoot_z + 0.06}, 12, true);
}

}  // namespace probewalk::procedural
