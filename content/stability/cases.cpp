#include "content/stability/cases.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "content/probe/probe_map.h"

namespace probewalk::stability {

namespace {

// Relative to the probe, in metres of the place.
struct Local {
  glm::vec3 x;
  glm::vec3 d;
  float t_start = 0.0f;
};
using MakeLocal = Local (*)(Random&, const Place&);

float number(Random& r, double low, double high) {
  return static_cast<float>(r(low, high));
}
int axis(Random& r) {
  return static_cast<int>(r(0, 3));
}
float sign(Random& r) {
  return r() < 0.5 ? -1.0f : 1.0f;
}
glm::vec3 inside(Random& r) {
  return {number(r, -2.5, 2.5), number(r, -1.2, 1.2), number(r, -2, 2)};
}
glm::vec3 direction(Random& r) {
  return glm::vec3(r.direction());
}
glm::vec3 along_axis(Random& r) {
  glm::vec3 d(0.0f);
  d[axis(r)] = sign(r);
  return d;
}

// Of a vertex of the map; |x| + |y| + |z| = 1.
glm::vec3 vertex(Random& r, const Place& place) {
  const int n = place.geometry.n, i = static_cast<int>(r(0, n + 1)), j = static_cast<int>(r(0, n + 1));
  return glm::vec3(octahedral_point(2.0 * i / n - 1, 2.0 * j / n - 1));
}

// A point of the surface itself as a float knows it, and away from it along the direction to the probe by `above`
// times its L1 distance. A place of nothing but sky has none: a point at 1 m then.
glm::vec3 on_surface(Random& r, const Place& place, double above) {
  const glm::dvec3 towards = r.direction();
  const BruteAnswer seen = place.brute.trace(glm::dvec3(0.0), towards);
  const double t = seen.cls == BruteAnswer::Class::kHit ? seen.t : 1.0;
  return glm::vec3(towards * (t * (1.0 - above)));
}

Local random_ray(Random& r, const Place&) {
  return {inside(r), direction(r)};
}
Local from_centre(Random& r, const Place&) {
  return {glm::vec3(0.0f), direction(r)};
}
Local through_centre(Random& r, const Place&) {
  const glm::vec3 d = direction(r);
  return {-d * number(r, 0.1, 1), d};
}
Local past_centre(Random& r, const Place&) {
  const glm::vec3 d = direction(r);
  return {-d + 1e-6f * direction(r), d};
}
Local away_from_centre(Random& r, const Place&) {
  const glm::vec3 d = direction(r);
  return {d * number(r, 0.05, 0.5), d};
}
// The displacement is the direction times a power of two, so that not a bit is lost; out of the near octahedron, where
// nothing is looked up and the first point that is would be a rounded one.
Local exactly_radial(Random& r, const Place& place) {
  const glm::vec3 d = direction(r);
  glm::vec3 x = d * std::exp2(static_cast<float>(static_cast<int>(r(-4, 0))));
  while (std::abs(x.x) + std::abs(x.y) + std::abs(x.z) < place.record.l_min_m * 1.01f) x *= 2.0f;
  return {x, d};
}
Local handed_on(Random& r, const Place& place) {
  const glm::vec3 x = inside(r), d = direction(r);
  if (r() < 0.5) return {x, d, number(r, 0, 2)};
  // As from where another probe's knowledge ended: at the surface.
  const glm::vec3 end = on_surface(r, place, 0.0);
  const float t = glm::length(end - x);
  return t > 1e-3f ? Local{x, (end - x) / t, t} : Local{x, d, 1.0f};
}
Local starting_late(Random& r, const Place&) {
  const glm::vec3 d = direction(r);
  return {-d * (r() < 0.5 ? 64.0f : 1000.0f), d, r() < 0.5 ? 64.0f : 1000.0f};
}
Local of_equal_components(Random& r, const Place&) {
  const float s = number(r, -1.2, 1.2);
  return {glm::vec3(s), r() < 0.3 ? glm::vec3(sign(r)) * std::sqrt(1.0f / 3.0f) : direction(r)};
}
Local axis_parallel(Random& r, const Place&) {
  return {inside(r), along_axis(r)};
}
Local on_plane(Random& r, const Place&) {
  glm::vec3 x = inside(r);
  x[axis(r)] = r() < 0.5 ? 0.0f : -0.0f;
  return {x, direction(r)};
}
Local within_plane(Random& r, const Place&) {
  glm::vec3 x = inside(r), d = direction(r);
  const int a = axis(r);
  x[a] = 0.0f;
  d[a] = r() < 0.5 ? 0.0f : -0.0f;
  return {x, glm::normalize(d)};
}
Local along_edge(Random& r, const Place&) {
  const int a = axis(r);
  glm::vec3 x(0.0f), d(0.0f);
  x[a] = number(r, -1, 1);
  d[a] = sign(r);
  return {x, d};
}
Local small_component(Random& r, float small) {
  glm::vec3 x = inside(r), d = direction(r);
  d[axis(r)] = small * sign(r);
  if (r() < 0.5) x[axis(r)] = small * sign(r);
  return {x, glm::normalize(d)};
}
Local of_1e_30(Random& r, const Place&) {
  return small_component(r, 1e-30f);
}
Local denormal(Random& r, const Place&) {
  return small_component(r, 1e-42f);
}
Local two_zeros(Random& r, const Place&) {
  Local ray{inside(r), along_axis(r)};
  ray.x[axis(r)] = 0.0f;
  return ray;
}
// Through the direction (0, 0, -1), which all four corners of the map are.
Local through_corner(Random& r, const Place&) {
  const glm::vec3 corner(0.0f, 0.0f, -number(r, 0.2, 1.5)), x = inside(r) * 0.5f;
  if (r() < 0.3) return {glm::vec3(x.x, 0.0f, x.z), glm::normalize(glm::vec3(-x.x, 0.0f, corner.z - x.z))};
  return {x, glm::normalize(corner - x)};
}
// Over the fold |u| + |v| = 1, where z = 0: at right angles, at a vertex, or along it.
Local over_fold(Random& r, const Place& place) {
  const int n = place.geometry.n;
  const double along = static_cast<double>(static_cast<int>(r(0, n / 2 + 1))) / (n / 2);
  const glm::vec3 fold(glm::dvec3(sign(r) * along, sign(r) * (1.0 - along), 0.0));
  glm::vec3 x = inside(r) * 0.4f;
  if (r() < 0.3) x.z = 0.0f;
  if (r() < 0.3) x = glm::vec3(fold.x, fold.y, number(r, -0.5, 0.5));
  return {x, glm::normalize(fold * 1.5f - x + glm::vec3(0.0f, 0.0f, 1e-9f))};
}
Local at_vertices(Random& r, const Place& place) {
  const glm::vec3 x = inside(r) * 0.3f;
  return {x, glm::normalize(vertex(r, place) * 2.0f - x)};
}
Local along_cell_edges(Random& r, const Place& place) {
  const glm::vec3 a = vertex(r, place);
  if (r() < 0.5) return {a * 0.3f, glm::normalize(a * 1.4f + 0.2f * direction(r))};
  const int n = place.geometry.n;
  const int i = static_cast<int>(r(0, n + 1)), j = static_cast<int>(r(0, n)), step = 1 + static_cast<int>(r(0, 3));
  // From above one vertex to above another of the same row, column or diagonal.
  const bool row = r() < 0.5;
  const auto point = [&](int p, int q) { return glm::vec3(octahedral_point(2.0 * p / n - 1, 2.0 * q / n - 1)); };
  const glm::vec3 from = 0.3f * (row ? point(j, i) : point(i, j));
  const int k = std::min(j + step, n);
  const glm::vec3 to = 2.5f * (row ? point(k, i) : point(i, k));
  return {from, glm::normalize(to - from)};
}
Local grazing_floor(Random& r, const Place&) {
  glm::vec3 x = inside(r), d = direction(r);
  x.y = -1.23f + number(r, 0.0001, 0.001);
  d.y = number(r, -1e-4, 1e-4);
  return {x, glm::normalize(d)};
}
Local from_surface(Random& r, const Place& place) {
  return {on_surface(r, place, 0.0), direction(r)};
}
Local from_above_surface(Random& r, const Place& place) {
  return {on_surface(r, place, 1e-5), direction(r)};
}
// Within the empty octahedron, from its rim to its middle.
Local in_near_octahedron(Random& r, const Place& place) {
  return {glm::vec3(r.direction() * (r() * 0.57 * static_cast<double>(place.record.l_min_m))), direction(r)};
}
Local of_any_length(Random& r, const Place&) {
  return {inside(r), direction(r) * std::exp2(number(r, -16, 16))};
}
Local anywhere(Random& r, const Place&) {
  return {glm::vec3(r.direction()) * std::exp2(number(r, -20, 20)), direction(r)};
}
// Inside and outside of the pillar around the probe.
Local around_pillar(Random& r, const Place&) {
  return {direction(r) * (r() < 0.5 ? number(r, 0, 0.2) : number(r, 0.3, 1.5)), direction(r)};
}
Local hostile(Random& r, const Place&) {
  static const float kBad[] = {std::numeric_limits<float>::quiet_NaN(),
                               std::numeric_limits<float>::infinity(),
                               -std::numeric_limits<float>::infinity(),
                               3e38f,
                               -3e38f,
                               1e30f};
  Local ray{inside(r), direction(r), r() < 0.5 ? 0.0f : 1.0f};
  const auto spoil = [&](glm::vec3& v) { v[axis(r)] = kBad[static_cast<int>(r(0, 6))]; };
  const double pick = r();
  if (pick < 0.4)
    spoil(ray.x);
  else if (pick < 0.8)
    spoil(ray.d);
  else if (pick < 0.9)
    ray.t_start = kBad[static_cast<int>(r(0, 6))];
  else
    ray.d = glm::vec3(r() < 0.5 ? 0.0f : 1e-42f);
  return ray;
}

// A local ray in the world, at the place's size.
Ray placed(const Local& local, const Place& place) {
  Ray ray;
  split_position(place.geometry.position_m + glm::dvec3(local.x) * place.scale_m, ray.origin_hi_m, ray.origin_lo_m);
  ray.direction = local.d;
  ray.t_start = static_cast<float>(static_cast<double>(local.t_start) * place.scale_m);
  return ray;
}

struct Kind {
  const char* name;
  const char* says;
  MakeLocal make;
};

// Wherever there is a probe.
const std::vector<Kind>& everywhere() {
  static const std::vector<Kind> kinds{
      {"from the centre", "The origin is the probe: the ray is one point of the map.", from_centre},
      {"through the centre", "The ray turns by 180 degrees between one point of the map and its opposite.",
       through_centre},
      {"1e-6 past the centre", "All of the map's half circle is swept within a millionth of a metre.", past_centre},
      {"away from the centre", "Parallel to the displacement but for rounding: no distance on the map.",
       away_from_centre},
      {"exactly radial", "Parallel to the displacement to the last bit: one look-up, the exact distance (thesis 4.3).",
       exactly_radial},
      {"handed on", "A start within the ray, anywhere or on a surface: a texel behind is still a hit.", handed_on},
      {"starting at t = 64 or 1000", "Crossings before the start, aimed at the probe: signs from times, not points.",
       starting_late},
      {"equal components", "x = y = z: three planes are crossed at once.", of_equal_components},
      {"along an axis", "Two components of the direction are zero.", axis_parallel},
      {"two zeros and a plane", "Two components are zero and the origin lies on an octant's plane, too.", two_zeros},
      {"on an octant's plane", "The origin lies on the border of two octants; the zero has either sign.", on_plane},
      {"within an octant's plane", "The whole ray lies on the border of two octants.", within_plane},
      {"along an octant's edge", "The whole ray lies on the border of four octants, through the probe.", along_edge},
      {"component of 1e-30", "A crossing further away than any distance.", of_1e_30},
      {"denormal component", "Reciprocals of it are infinite.", denormal},
      {"through the map's corners", "Four corners of the map are one direction.", through_corner},
      {"over the fold", "At, along and across the octahedron's equator, through vertices.", over_fold},
      {"aimed at vertices", "Six triangles meet where the ray meets the surface.", at_vertices},
      {"along cell edges", "The ray runs on the lines of the grid: neither side is the right one.", along_cell_edges},
      {"grazing the floor", "0.1 to 1 mm above it, nearly parallel: where they meet is all but undetermined.",
       grazing_floor},
      {"origin on a surface", "Whether the start is before or behind is rounding's choice.", from_surface},
      {"origin 1e-5 above a surface", "As callers start a secondary ray.", from_above_surface},
      {"inside the near octahedron", "The origin is nearer to the probe than any surface.", in_near_octahedron},
      {"direction of any length", "From 2^-16 to 2^16.", of_any_length},
      {"numbers that are none",
       "NaN, infinities, 1e30 and more, directions of no length: the walk knows nothing, and says so.", hostile},
  };
  return kinds;
}

}  // namespace

std::vector<HardCase> hard_cases() {
  std::vector<HardCase> cases;
  const auto add = [&](PlaceId place, const Kind& kind, double weight) {
    HardCase added{kind.name, place, kind.says, weight, kind.make == hostile, kind.make == exactly_radial, {}};
    const MakeLocal make = kind.make;
    added.ray = [make](Random& random, const Place& at) { return placed(make(random, at), at); };
    cases.push_back(std::move(added));
  };
  const Kind any{"random", "Origins and directions all over the place.", random_ray};
  for (const PlaceId place : {PlaceId::kRoom, PlaceId::kGrille}) {
    add(place, any, 30);
    for (const Kind& kind : everywhere()) add(place, kind, 2);
  }
  for (const PlaceId place : {PlaceId::kRoomFine, PlaceId::kGrilleFine}) {
    add(place, any, 4);
    for (const Kind& kind : everywhere()) add(place, kind, 0.2);
  }
  add(PlaceId::kLeaves, {"random", "Foliage all around: three surfaces a cell.", random_ray}, 10);
  add(PlaceId::kLeaves,
      {"inside the near octahedron", "The camera within the few centimetres before the first leaf.",
       in_near_octahedron},
      4);
  add(PlaceId::kTiny, {"random", "The scene is one millimetre wide.", random_ray}, 4);
  add(PlaceId::kVast, {"random", "The scene is ten kilometres wide.", random_ray}, 4);
  add(PlaceId::kFarOut, {"random", "The scene lies 1e5 m from the origin: a float there knows 8 mm.", random_ray}, 4);
  add(PlaceId::kFarOut, {"from the centre", "The same, from where the probe is.", from_centre}, 1);
  add(PlaceId::kPlain, {"random", "Hits as far as 1e4 m, with things a metre away.", random_ray}, 4);
  add(PlaceId::kPlain,
      {"from the centre", "Hits as far as 1e4 m along rays that cross nothing of the map.", from_centre}, 1);
  add(PlaceId::kPlain, {"anywhere", "Origins from a micrometre to a thousand kilometres away.", anywhere}, 2);
  add(PlaceId::kSky, {"random", "Sky everywhere: a probe that sees nothing proves any ray free.", random_ray}, 2);
  add(PlaceId::kSky, {"anywhere", "The same from a micrometre to a thousand kilometres away.", anywhere}, 1);
  add(PlaceId::kSolid,
      {"around the pillar", "The probe is inside a solid: it must not speak of what is outside.", around_pillar}, 2);
  add(PlaceId::kLeast, {"random", "Packs' least and greatest w and sky, side by side, in one map.", random_ray}, 4);
  add(PlaceId::kLeast, {"anywhere", "The same, from a micrometre to a thousand kilometres away.", anywhere}, 2);
  add(PlaceId::kQuantised, {"random", "Samples as quantised packs hold them: walls off by a millionth, from tile to tile.", random_ray}, 4);
  add(PlaceId::kQuantised, {"along cell edges", "The same, along the seams between tiles among others.", along_cell_edges}, 2);
  add(PlaceId::kQuantised, {"handed on", "The same, from where another probe's knowledge ended.", handed_on}, 2);
  add(PlaceId::kQuantisedGrille, {"random", "The same with cuts everywhere: most samples on no plane, off by up to 3e-5.", random_ray}, 4);
  add(PlaceId::kQuantisedLimits, {"random", "Tiles at the limits of what they hold: one value, a float's last bit, least and greatest w, sky, codes without end.", random_ray}, 4);
  add(PlaceId::kQuantisedLimits, {"anywhere", "The same, from a micrometre to a thousand kilometres away.", anywhere}, 2);
  add(PlaceId::kQuantisedLimits, {"aimed at vertices", "The same, where the pieces meet.", at_vertices}, 2);
  add(PlaceId::kSteps, {"random", "Samples rounded to 16 bits a probe: every plane is a staircase.", random_ray}, 4);
  add(PlaceId::kTorn,
      {"random", "Nine edges in ten are cut, at first and last fractions, with slopes of all kinds.", random_ray}, 4);
  add(PlaceId::kTorn, {"aimed at vertices", "The same, where the pieces meet.", at_vertices}, 1);
  return cases;
}

}  // namespace probewalk::stability
