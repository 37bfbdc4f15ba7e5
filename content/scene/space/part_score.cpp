// Which parts are places to be: rays from eye points tell rooms from the spaces between walls and outside.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "content/error.h"
#include "content/scene/space.h"
#include "content/scene/space/parts.h"

namespace probewalk {
namespace {

constexpr int kEyePoints = 64;
constexpr int kRays = 64;
constexpr double kFurnishedTriangles = 24.0;

// Evenly strided over the part's places.
std::vector<std::int32_t> strided(const FloorPart& part, int most) {
  const std::size_t count = std::min(part.places.size(), std::size_t(most));
  std::vector<std::int32_t> picked;
  for (std::size_t k = 0; k < count; ++k) picked.push_back(part.places[(2 * k + 1) * part.places.size() / (2 * count)]);
  return picked;
}

glm::vec3 fibonacci_direction(int k, int count) {
  const double y = 1.0 - 2.0 * (k + 0.5) / count;
  const double r = std::sqrt(1.0 - y * y);
  const double phi = k * std::numbers::pi * (3.0 - std::sqrt(5.0));
  return {float(r * std::cos(phi)), float(y), float(r * std::sin(phi))};
}

bool sees(const RayScene& rays, glm::dvec3 a_m, glm::dvec3 b_m) {
  return !rays.occluded(glm::vec3(a_m), glm::vec3(b_m - a_m), 0.0f, 1.0f);
}

void score(const Scene& scene, const RayScene& rays, const FloorGraph& graph, FloorPart& part) {
  const std::vector<std::int32_t> eyes = strided(part, kEyePoints);
  double hits = 0.0, backs = 0.0, triangles = 0.0, worth = 0.0;
  for (const std::int32_t place : eyes) {
    int hit = 0, back = 0;
    std::vector<std::uint32_t> met;
    for (int r = 0; r < kRays; ++r) {
      const glm::vec3 direction = fibonacci_direction(r, kRays);
      const SurfaceHit surface = rays.closest(glm::vec3(graph.eye_m(place)), direction);
      if (!surface.hit) continue;
      ++hit;
      met.push_back(surface.triangle);
      const bool double_sided = scene.materials[scene.triangle_material[surface.triangle]].double_sided;
      if (!double_sided && glm::dot(surface.geometric_normal, direction) > 0.0f) ++back;
    }
    std::sort(met.begin(), met.end());
    const double distinct = double(std::unique(met.begin(), met.end()) - met.begin());
    const double hit_share = double(hit) / kRays;
    const double front_share = hit > 0 ? 1.0 - double(back) / hit : 0.0;
    hits += hit;
    backs += back;
    triangles += distinct;
    worth += std::pow(hit_share, 4) * front_share * front_share * std::min(1.0, distinct / kFurnishedTriangles);
  }
  const double count = double(eyes.size());
  part.hit = hits / (count * kRays);
  part.front = hits > 0.0 ? 1.0 - backs / hits : 0.0;
  part.detail = triangles / count;
  part.score = part.area_m2 * worth / count;
}

// Kept places by column, to find who stands near.
class KeptPlaces {
 public:
  explicit KeptPlaces(const FloorGraph& graph) : graph_(graph), kept_(graph.places.size(), false) {
    first_.assign(std::size_t(graph.columns.x) * graph.columns.y + 1, 0);
    for (const StandingPlace& p : graph.places) ++first_[column(p.ix, p.iz) + 1];
    for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  }
  void keep(const FloorPart& part) {
    for (const std::int32_t i : part.places) kept_[i] = true;
  }
  // Is the place a table, a bed, a shelf of a kept part: within 1.25 m in plan and 1.5 m in height of someone standing
  // there, with nothing between the heads?
  bool beside_kept(const RayScene& rays, std::int32_t place) const {
    constexpr double kReach_m = 1.25;
    constexpr double kRise_m = 1.5;
    const StandingPlace& p = graph_.places[place];
    const int reach = int(kReach_m / graph_.cell_m);
    const int stride = std::max(1, reach / 6);
    for (int dz = -reach; dz <= reach; dz += stride) {
      for (int dx = -reach; dx <= reach; dx += stride) {
        const int x = p.ix + dx;
        const int z = p.iz + dz;
        if (dx * dx + dz * dz > reach * reach || x < 0 || z < 0 || x >= graph_.columns.x || z >= graph_.columns.y)
          continue;
        for (std::uint32_t j = first_[column(x, z)]; j < first_[column(x, z) + 1]; ++j) {
          if (!kept_[j] || std::abs(graph_.places[j].floor_m - p.floor_m) > float(kRise_m)) continue;
          if (sees(rays, graph_.eye_m(place), graph_.eye_m(std::int32_t(j)))) return true;
        }
      }
    }
    return false;
  }

 private:
  std::size_t column(int ix, int iz) const { return std::size_t(iz) * graph_.columns.x + ix; }
  const FloorGraph& graph_;
  std::vector<bool> kept_;
  std::vector<std::uint32_t> first_;
};

double share_seen(const RayScene& rays, const FloorGraph& graph, const FloorPart& part,
                  const std::vector<glm::dvec3>& kept_eyes_m) {
  constexpr double kFar_m = 40.0;
  const std::vector<std::int32_t> eyes = strided(part, 48);
  int seen = 0;
  for (const std::int32_t place : eyes) {
    const glm::dvec3 eye = graph.eye_m(place);
    for (const glm::dvec3& other : kept_eyes_m) {
      if (glm::distance(eye, other) > kFar_m || !sees(rays, eye, other)) continue;
      ++seen;
      break;
    }
  }
  return double(seen) / double(eyes.size());
}

double share_in_authored_rooms(const Scene& scene, const FloorGraph& graph, const FloorPart& part) {
  const std::vector<std::int32_t> sample = strided(part, kEyePoints);
  int inside = 0;
  for (const std::int32_t i : sample) {
    const glm::dvec3 p = graph.foot_m(i) + glm::dvec3(0.0, 1.0, 0.0);
    inside += std::any_of(scene.rooms.begin(), scene.rooms.end(), [&](const AuthoredRoom& room) {
      return glm::all(glm::lessThanEqual(room.lower_m, p)) && glm::all(glm::lessThanEqual(p, room.upper_m));
    });
  }
  return double(inside) / double(sample.size());
}

}  // namespace

void score_parts(const Scene& scene, const RayScene& rays, const FloorGraph& graph, std::vector<FloorPart>& parts,
                 Progress& progress) {
  for (FloorPart& part : parts) {
    if (progress.cancelled()) throw Interrupted("interrupted while looking for the walkable space");
    score(scene, rays, graph, part);
  }
}

std::vector<std::size_t> choose_parts(const Scene& scene, const RayScene& rays, const FloorGraph& graph,
                                      const std::vector<FloorPart>& parts, const std::optional<glm::dvec3>& start_m) {
  if (parts.empty()) return {};
  std::vector<std::size_t> order(parts.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (parts[a].score != parts[b].score) return parts[a].score > parts[b].score;
    return parts[a].area_m2 > parts[b].area_m2;  // scenes in which rays meet nothing
  });
  const std::vector<double> worth_per_m2 = [&] {
    std::vector<double> worth;
    for (const FloorPart& part : parts) worth.push_back(part.score / part.area_m2);
    return worth;
  }();

  if (start_m) {
    std::size_t nearest = order.front();
    double least = HUGE_VAL;
    for (const std::size_t id : order) {
      const std::int32_t place = nearest_place(graph, parts[id].places, *start_m);
      const double rise =
          std::min(std::abs(start_m->y - graph.foot_m(place).y), std::abs(start_m->y - graph.eye_m(place).y));
      const glm::dvec3 away = *start_m - graph.foot_m(place);
      const double distance = std::hypot(away.x, rise, away.z);
      if (distance < least) {
        least = distance;
        nearest = id;
      }
    }
    order.erase(std::find(order.begin(), order.end(), nearest));
    order.insert(order.begin(), nearest);
  }

  KeptPlaces kept_places(graph);
  std::vector<glm::dvec3> kept_eyes_m;
  std::vector<std::size_t> kept;
  const double best = worth_per_m2[order.front()];
  for (const std::size_t id : order) {
    const FloorPart& part = parts[id];
    const bool first = kept.empty();
    const bool authored = !scene.rooms.empty() && share_in_authored_rooms(scene, graph, part) >= 0.5;
    if (!first) {
      const bool worthy =
          part.area_m2 >= 3.0 && part.widest_m >= 1.2 && worth_per_m2[id] >= 0.5 * best && part.hit >= 0.6;
      if (!worthy && !authored) continue;
      const std::vector<std::int32_t> sample = strided(part, 32);
      const auto beside = std::count_if(sample.begin(), sample.end(),
                                        [&](std::int32_t i) { return kept_places.beside_kept(rays, i); });
      if (2 * beside > std::ptrdiff_t(sample.size())) continue;
      const bool furnished = part.detail >= 20.0 && part.hit >= 0.8 && part.front >= 0.7;
      const bool room_sized = authored && part.area_m2 >= 3.0;  // else the inside of a wardrobe
      if (!room_sized && !furnished && share_seen(rays, graph, part, kept_eyes_m) < 0.05) continue;
    }
    kept.push_back(id);
    kept_places.keep(part);
    for (const std::int32_t i : strided(part, 96)) kept_eyes_m.push_back(graph.eye_m(i));
  }
  return kept;
}

}  // namespace probewalk
