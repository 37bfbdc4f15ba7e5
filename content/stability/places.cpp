#include "content/stability/places.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "content/bake/bake_probe.h"
#include "content/pack/pack_format.h"
#include "content/pack/sample_tiles.h"
#include "content/scene/ray_scene.h"
#include "content/stability/low_discrepancy.h"
#include "content/stability/small_scenes.h"

namespace probewalk::stability {

namespace {

constexpr double kRoomWidth_m = 6.0;

ProbeGeometry baked(const Scene& scene, glm::dvec3 position_m, int n) {
  const RayScene rays(scene);
  ProbeGeometry geometry = bake_geometry(rays, position_m, n);
  geometry.position_m = glm::dvec3(0.0);
  return geometry;
}

ProbeGeometry room(int n) {
  return baked(furnished_room(), {0.31, 1.23, 0.47}, n);
}
ProbeGeometry grille(int n) {
  return baked(grille_room(), {0.31, 1.23, 0.47}, n);
}

// The same shape, `scale` times as large. Not baked anew: the baker lets nothing be nearer than 0.1 mm.
ProbeGeometry scaled(ProbeGeometry geometry, double scale) {
  for (float& w : geometry.w) w = static_cast<float>(w / scale);
  return geometry;
}

// A map that nobody baked: w by vertex, edges connected, no normals.
ProbeGeometry made(int n, const std::function<float(int, int)>& w) {
  ProbeGeometry geometry;
  geometry.n = n;
  const std::size_t side = static_cast<std::size_t>(n);
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) geometry.w.push_back(w(i, j));
  }
  geometry.edges_horizontal.assign(side * (side + 1), kConnected);
  geometry.edges_vertical.assign(side * (side + 1), kConnected);
  geometry.edges_diagonal.assign(side * side, kConnected);
  geometry.normals.assign(geometry.w.size(), 0);
  // The square's border is one line of directions seen twice, and its corners are one direction.
  const auto at = [&](int i, int j) -> float& { return geometry.w[static_cast<std::size_t>(j) * (side + 1) + i]; };
  for (int k = 0; k <= n / 2; ++k) {
    at(n - k, 0) = at(k, 0);
    at(n - k, n) = at(k, n);
    at(0, n - k) = at(0, k);
    at(n, n - k) = at(n, k);
  }
  at(n, n) = at(n, 0) = at(0, n) = at(0, 0);
  return geometry;
}

ProbeGeometry at_limits() {
  Random random(31);
  return made(32, [&](int, int) {
    const double pick = random();
    if (pick < 0.2) return 0.0f;
    if (pick < 0.4) return PackLimits::kLeastW_per_m;
    if (pick < 0.5) return PackLimits::kGreatestW_per_m;
    return static_cast<float>(std::exp2(random(-3, 3)));
  });
}

ProbeGeometry in_steps(ProbeGeometry geometry) {
  const float step = *std::max_element(geometry.w.begin(), geometry.w.end()) / 65535.0f;
  for (float& w : geometry.w) {
    if (w > 0.0f) w = std::max(1.0f, std::round(w / step)) * step;  // far surfaces never turn into sky
  }
  return geometry;
}

ProbeGeometry quantised(ProbeGeometry geometry) {
  geometry.w = encode_tiled_samples(geometry.w, static_cast<std::size_t>(geometry.n)).w;
  return geometry;
}

// Four by four tiles, each at a limit of its own.
ProbeGeometry quantised_limits() {
  constexpr float kLeast = PackLimits::kLeastW_per_m, kGreatest = PackLimits::kGreatestW_per_m;
  Random random(41);
  return quantised(made(64, [&](int i, int j) {
    const int tile = std::min(i / 16, 3) + 4 * std::min(j / 16, 3);
    const float x = static_cast<float>(i % 16), y = static_cast<float>(j % 16);
    const bool odd = ((i ^ j) & 1) != 0;
    switch (tile) {
      case 0: return 0.5f;                                                      // one value
      case 1: return odd ? 0.5f : std::nextafter(0.5f, 1.0f);                   // one step of a float
      case 2: return odd ? kLeast : 0.0f;                                       // least beside the sky
      case 3: return odd ? kGreatest : 0.0f;                                    // greatest beside the sky
      case 4: return odd ? kLeast : kGreatest;                                  // no step spans it
      case 5: return odd ? 0.25f : 120.0f;                                      // the largest codes of 24 bits
      case 6: return odd ? 0.25f : 160.0f;                                      // ... and one beyond
      case 7: return kLeast * (1.0f + x + 2.0f * y);                            // a plane down to the least
      case 8: return kGreatest * (1.0f - 0.02f * x - 0.03f * y);                // ... and up to the greatest
      case 9: return 0.5f + 0.004f * x - 0.002f * y;                            // a plane that goes on ...
      case 10: return 0.5f + 0.004f * (x + 16.0f) - 0.002f * y;                 // ... here
      case 11: return std::max(0.5f + 0.01f * x, 0.6f - 0.01f * y);             // two that meet
      case 12: return x == 7.0f && y == 7.0f ? 1.0f : 0.0f;                     // one sample in the sky
      case 13: return x < 8.0f ? 0.0f : 0.5f;                                   // a wall's end before the sky
      case 14: return static_cast<float>(std::exp2(random(-29.8, 19.9)));       // all there is
      default: return static_cast<float>(0.5 + 0.1 * std::sin(0.3 * i) * std::cos(0.2 * j));  // no plane anywhere
    }
  }));
}

ProbeGeometry torn() {
  Random random(37);
  ProbeGeometry geometry = made(64, [&](int, int) { return static_cast<float>(std::exp2(random(-3, 2))); });
  const auto cut = [&](std::vector<std::uint8_t>& edges) {
    for (std::uint8_t& edge : edges) {
      const double pick = random();
      edge = pick < 0.1    ? kConnected
             : pick < 0.45 ? 1
             : pick < 0.8  ? kCutSteps
                           : static_cast<std::uint8_t>(random(1, 65));
    }
  };
  cut(geometry.edges_horizontal);
  cut(geometry.edges_vertical);
  cut(geometry.edges_diagonal);
  for (std::uint16_t& normal : geometry.normals) normal = encode_normal(glm::vec3(random.direction()));
  return geometry;
}

struct Recipe {
  PlaceId id;
  const char* name;
  int n;
  double scale_m;
  std::function<ProbeGeometry()> make;
  DeviceSamples samples = kDefaultSamples;
};

const std::vector<Recipe>& recipes() {
  static const std::vector<Recipe> all{
      {PlaceId::kRoom, "furnished room", 128, 1.0, [] { return room(128); }},
      {PlaceId::kGrille, "grille", 128, 1.0, [] { return grille(128); }},
      {PlaceId::kLeaves, "foliage", 128, 1.0, [] { return baked(leafy_room(), {0.0, 1.25, 0.0}, 128); }},
      {PlaceId::kRoomFine, "furnished room", 512, 1.0, [] { return room(512); }},
      {PlaceId::kGrilleFine, "grille", 512, 1.0, [] { return grille(512); }},
      {PlaceId::kTiny, "room of 1 mm", 64, 1e-3 / kRoomWidth_m, [] { return scaled(room(64), 1e-3 / kRoomWidth_m); }},
      {PlaceId::kVast, "room of 10 km", 64, 1e4 / kRoomWidth_m, [] { return scaled(room(64), 1e4 / kRoomWidth_m); }},
      {PlaceId::kFarOut, "room 1e5 m out", 64, 1.0,
       [] {
         ProbeGeometry geometry = room(64);
         geometry.position_m = {1e5 + 0.1, -3e4 - 0.7, 7e4 + 1.0 / 3.0};
         return geometry;
       }},
      {PlaceId::kPlain, "plain to 1e4 m", 128, 1.0, [] { return baked(wide_plain(), {0.0, 1.5, 0.0}, 128); }},
      {PlaceId::kSky, "sky", 64, 1.0, [] { return made(64, [](int, int) { return 0.0f; }); }},
      {PlaceId::kSolid, "inside a pillar", 64, 1.0, [] { return baked(furnished_room(), {-1.83, 1.2, -1.57}, 64); }},
      {PlaceId::kLeast, "samples at limits", 32, 1.0, [] { return at_limits(); }, DeviceSamples::kTiledAlways},
      {PlaceId::kSteps, "samples of 16 bits", 64, 1.0, [] { return in_steps(room(64)); }, DeviceSamples::kTiledAlways},
      {PlaceId::kQuantised, "quantised room", 128, 1.0, [] { return quantised(room(128)); },
       DeviceSamples::kTiledAlways},
      {PlaceId::kQuantisedGrille, "quantised grille", 128, 1.0, [] { return quantised(grille(128)); },
       DeviceSamples::kTiledAlways},
      {PlaceId::kQuantisedLimits, "quantised tiles at limits", 64, 1.0, [] { return quantised_limits(); },
       DeviceSamples::kTiledAlways},
      {PlaceId::kTorn, "cuts at limits", 64, 1.0, [] { return torn(); }, DeviceSamples::kTiledAlways},
  };
  return all;
}

const Recipe& recipe(PlaceId id) {
  return *std::find_if(recipes().begin(), recipes().end(), [&](const Recipe& r) { return r.id == id; });
}

}  // namespace

std::string place_name(PlaceId id) {
  return recipe(id).name;
}
int place_cells(PlaceId id) {
  return recipe(id).n;
}

std::unique_ptr<Place> make_place(PlaceId id) {
  const Recipe& r = recipe(id);
  ProbeGeometry geometry = r.make();
  DeviceProbe device = build_device_probe(ProbeMap{geometry, {}}, PyramidMaker::kHost, r.samples);
  BruteForceProbe brute(geometry);
  auto place =
      std::make_unique<Place>(Place{r.name, r.scale_m, std::move(geometry), std::move(device), {}, std::move(brute)});
  place->record = record_in_memory(place->device);
  return place;
}

}  // namespace probewalk::stability
