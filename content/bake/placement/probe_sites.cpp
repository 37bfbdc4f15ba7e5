#include "content/bake/placement/probe_sites.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "content/bake/placement/grid_choice.h"

namespace probewalk {
namespace {

constexpr double kClearance_m = 0.15;      // a probe nearer to a surface sees little else
constexpr double kRoomy_m = 0.4;           // more clearance than this is worth nothing
constexpr double kApart = 0.3;             // of the spacing: two probes closer than this are one
constexpr std::size_t kEyesPerVertex = 32;
constexpr int kWantedViews = 4;            // distinct probes that should see each head
constexpr std::uint32_t kNobody = ~0u;

bool sees(const RayScene& rays, glm::dvec3 a_m, glm::dvec3 b_m) {
  return !rays.occluded(glm::vec3(a_m), glm::vec3(b_m - a_m), 0.0f, 1.0f);
}

// Offsets within half a spacing, in units of it, nearest first; the vertex itself is the first.
std::vector<glm::dvec3> offsets() {
  std::vector<glm::dvec3> list;
  for (int code = 0; code < 125; ++code) list.push_back(glm::dvec3(code % 5 - 2, code / 5 % 5 - 2, code / 25 - 2) * (0.5 * kReach));
  std::stable_sort(list.begin(), list.end(), [](glm::dvec3 a, glm::dvec3 b) { return glm::dot(a, a) < glm::dot(b, b); });
  return list;
}

class SiteChooser {
 public:
  SiteChooser(ProbeGrid& grid, const RayScene& rays, const Space& space, const HeadSpace& heads, std::size_t max_probes)
      : grid_(grid), rays_(rays), space_(space), heads_(heads), max_probes_(std::max<std::size_t>(1, max_probes)) {
    grid_.probe.assign(grid_.probe.size(), kNobody);
    for (int z = 0; z < grid.dims.z; ++z) {
      for (int y = 0; y < grid.dims.y; ++y) {
        for (int x = 0; x < grid.dims.x; ++x) vertices_.push_back({x, y, z});
      }
    }
  }

  std::vector<ProbeSite> run(SiteCounts& counts) {
    for (const glm::ivec3& vertex : vertices_) stand(vertex);
    for (const glm::ivec3& vertex : vertices_) stand_better(vertex);
    stand_in_doorways();
    give_every_room_one();
    if (sites_.empty()) add_site(space_.start.position_m, vertices_.size());
    share(counts);
    add_where_few_see(counts);
    serve_the_rest();
    for (const glm::ivec3& vertex : vertices_) {
      const std::uint32_t site = grid_.probe[vertex_index(grid_, vertex)];
      if (owner_[site] == vertex_index(grid_, vertex) && sites_[site].position_m != vertex_m(grid_, vertex)) ++counts.moved;
    }
    return sorted_by_room();
  }

 private:
  int room_of(glm::dvec3 point_m) const { return std::clamp(heads_.room(point_m), 0, int(space_.rooms.size()) - 1); }

  std::vector<std::uint32_t> eyes_around(glm::ivec3 vertex, std::size_t most) const {
    const glm::dvec3 at = vertex_m(grid_, vertex);
    return heads_.eyes_in(reach_lower(vertex, at), reach_upper(vertex, at), most);
  }
  // Heads outside the grid are clamped to its edge, so the outermost vertices serve all that is beyond them.
  glm::dvec3 reach_lower(glm::ivec3 vertex, glm::dvec3 at) const {
    glm::dvec3 lower = at - grid_.spacing_m;
    for (int k = 0; k < 3; ++k) lower[k] -= vertex[k] <= 1 ? grid_.spacing_m[k] : 0.0;
    return lower;
  }
  glm::dvec3 reach_upper(glm::ivec3 vertex, glm::dvec3 at) const {
    glm::dvec3 upper = at + grid_.spacing_m;
    for (int k = 0; k < 3; ++k) upper[k] += vertex[k] >= grid_.dims[k] - 2 ? grid_.spacing_m[k] : 0.0;
    return upper;
  }

  bool fits(glm::dvec3 point_m) const {
    if (!heads_.holds(point_m) || clearance_m(rays_, point_m, kRoomy_m) < kClearance_m) return false;
    return std::none_of(sites_.begin(), sites_.end(), [&](const ProbeSite& site) {
      return glm::length((site.position_m - point_m) / grid_.spacing_m) < kApart;
    });
  }

  // Heads around a vertex, and how much each needs another probe that sees it (together 1).
  struct Audience {
    std::vector<std::uint32_t> eyes;
    std::vector<double> need;
  };
  Audience audience_of(glm::ivec3 vertex) const {
    Audience audience{eyes_around(vertex, kEyesPerVertex), {}};
    double sum = 0.0;
    for (const std::uint32_t eye : audience.eyes) {
      audience.need.push_back(std::pow(1.0 + views(eye), -2.0));
      sum += audience.need.back();
    }
    for (double& need : audience.need) need /= sum;
    return audience;
  }
  double need_met(glm::dvec3 point_m, const Audience& audience) const {
    double met = 0.0;
    for (std::size_t i = 0; i < audience.eyes.size(); ++i) {
      if (sees(rays_, point_m, heads_.eyes()[audience.eyes[i]])) met += audience.need[i];
    }
    return met;
  }

  std::uint32_t add_site(glm::dvec3 point_m, std::size_t vertex) {
    sites_.push_back({point_m, room_of(point_m)});
    owner_.push_back(vertex);
    seen_by_.push_back(eyes_that_see(point_m));
    return std::uint32_t(sites_.size() - 1);
  }
  void move_site(std::uint32_t site, glm::dvec3 point_m) {
    sites_[site] = {point_m, room_of(point_m)};
    seen_by_[site] = eyes_that_see(point_m);
  }
  void remove_last_site() {
    sites_.pop_back();
    owner_.pop_back();
    seen_by_.pop_back();
  }

  // The vertex's own place when it is good, else the best within half a spacing: seen by the heads around it that need
  // it most (those on the side of a wall that its neighbours left out), away from surfaces, not far off.
  std::optional<glm::dvec3> best_place(glm::ivec3 vertex) const {
    constexpr double kWorthAProbe = 0.1;
    const Audience audience = audience_of(vertex);
    static const std::vector<glm::dvec3> kOffsets = offsets();
    double most = -1.0;
    std::optional<glm::dvec3> best;
    for (const glm::dvec3& offset : kOffsets) {
      const glm::dvec3 point = vertex_m(grid_, vertex) + offset * grid_.spacing_m;
      if (!fits(point)) continue;
      const double met = need_met(point, audience);
      const double roomy = clearance_m(rays_, point, kRoomy_m) / kRoomy_m;
      const double worth = met + 0.3 * roomy - 0.5 * glm::length(offset);
      if (met < kWorthAProbe || worth <= most) continue;
      most = worth;
      best = point;
      if (offset == glm::dvec3(0.0) && met >= 0.7 && roomy >= 0.6) break;
    }
    return best;
  }
  void stand(glm::ivec3 vertex) {
    if (sites_.size() >= max_probes_ || !is_useful(grid_, heads_, vertex)) return;
    const std::size_t v = vertex_index(grid_, vertex);
    if (const auto place = best_place(vertex)) grid_.probe[v] = add_site(*place, v);
  }
  // Once all stand, each is moved to where it is needed most beside the others.
  void stand_better(glm::ivec3 vertex) {
    const std::uint32_t site = grid_.probe[vertex_index(grid_, vertex)];
    if (site == kNobody) return;
    const ProbeSite before = sites_[site];
    const std::vector<bool> seen_before = seen_by_[site];
    sites_[site].position_m = glm::dvec3(HUGE_VAL);  // does not count while its place is looked for
    std::fill(seen_by_[site].begin(), seen_by_[site].end(), false);
    if (const auto place = best_place(vertex)) {
      move_site(site, *place);
    } else {
      sites_[site] = before;
      seen_by_[site] = seen_before;
    }
  }

  // A probe in a doorway sees both rooms: better than one that had to be moved anyway.
  void stand_in_doorways() {
    for (const Portal& portal : space_.portals) {
      glm::dvec3 middle = std::accumulate(portal.polygon.begin(), portal.polygon.end(), glm::dvec3(0.0)) / double(portal.polygon.size());
      double floor = HUGE_VAL;
      for (const glm::dvec3& corner : portal.polygon) floor = std::min(floor, corner.y);
      middle.y = std::min(middle.y, floor + 1.3);
      std::size_t nearest = vertices_.size();
      double least = 1.0;
      for (std::size_t v = 0; v < vertices_.size(); ++v) {
        const std::uint32_t site = grid_.probe[v];
        const glm::dvec3 at = vertex_m(grid_, vertices_[v]);
        if (site == kNobody || sites_[site].position_m == at) continue;
        const double away = glm::length((at - middle) / grid_.spacing_m);
        if (away < least) {
          least = away;
          nearest = v;
        }
      }
      if (nearest == vertices_.size()) continue;
      const std::uint32_t site = grid_.probe[nearest];
      const glm::dvec3 before = sites_[site].position_m;
      move_site(site, glm::dvec3(HUGE_VAL));  // does not count while its new place is looked at
      const Audience audience = audience_of(vertices_[nearest]);
      const bool better = fits(middle) && need_met(middle, audience) >= 0.8 * need_met(before, audience);
      move_site(site, better ? middle : before);
    }
  }

  // Few lines of a grid may miss whole rooms. One with floor gets the probe of a vertex around its heads from a room that
  // has several, or another, before any room has two that it does without.
  void give_every_room_one() {
    std::vector<bool> has_floor(space_.rooms.size(), false);
    for (const FloorNode& node : space_.floor.nodes) has_floor[node.room] = true;
    for (std::size_t room = 0; room < has_floor.size(); ++room) {
      if (!has_floor[room] || sites_in(int(room)) > 0) continue;
      if (const auto place = best_place_in(int(room))) give_one(*place);
    }
  }
  std::size_t sites_in(int room) const {
    return std::size_t(
        std::count_if(sites_.begin(), sites_.end(), [&](const ProbeSite& site) { return site.room == room; }));
  }
  // Where most of the room's heads are seen from.
  std::optional<glm::dvec3> best_place_in(int room) const {
    constexpr std::size_t kPlaces = 24;
    std::vector<glm::dvec3> heads;
    for (const glm::dvec3& eye : heads_.eyes()) {
      if (room_of(eye) == room) heads.push_back(eye);
    }
    double most = -1.0;
    std::optional<glm::dvec3> best;
    const std::size_t stride = heads.size() / kPlaces + 1;
    for (std::size_t k = 0; k < heads.size(); k += stride) {
      // Next to one behind a wall is as good as anywhere.
      if (!heads_.holds(heads[k]) || clearance_m(rays_, heads[k], kRoomy_m) < kClearance_m) continue;
      double seen = 0.0;
      for (std::size_t i = 0; i < heads.size(); i += stride) seen += sees(rays_, heads[k], heads[i]);
      const double worth = seen / double(heads.size()) + 0.1 * clearance_m(rays_, heads[k], kRoomy_m);
      if (worth <= most) continue;
      most = worth;
      best = heads[k];
    }
    return best;
  }
  std::optional<std::size_t> nearest_open_vertex(glm::dvec3 place) const {
    std::optional<std::size_t> nearest;
    double least = HUGE_VAL;
    for (const glm::ivec3& vertex : vertices_) {
      const double away = glm::distance(vertex_m(grid_, vertex), place);
      if (grid_.probe[vertex_index(grid_, vertex)] != kNobody || away >= least) continue;
      least = away;
      nearest = vertex_index(grid_, vertex);
    }
    return nearest;
  }
  // The nearest vertex around the place that nobody serves, or the one whose probe's room has the most others.
  void give_one(glm::dvec3 place) {
    std::optional<std::size_t> open;
    std::uint32_t spare = kNobody;
    double least = HUGE_VAL;
    std::size_t most = 1;
    for (const glm::ivec3& corner : cell_corners(grid_, place)) {
      const std::size_t v = vertex_index(grid_, corner);
      const std::uint32_t site = grid_.probe[v];
      if (site == kNobody) {
        const double away = glm::distance(vertex_m(grid_, corner), place);
        if (away < least) open = v;
        least = std::min(least, away);
      } else if (sites_in(sites_[site].room) > most) {
        most = sites_in(sites_[site].room);
        spare = site;
      }
    }
    if (sites_.size() < max_probes_ && !open) open = nearest_open_vertex(place);
    if (sites_.size() < max_probes_ && open) {
      grid_.probe[*open] = add_site(place, *open);
      return;
    }
    if (spare == kNobody) {  // from the room that has the most
      for (std::uint32_t site = 0; site < sites_.size(); ++site) {
        if (sites_in(sites_[site].room) <= most) continue;
        most = sites_in(sites_[site].room);
        spare = site;
      }
      if (spare != kNobody && open) {
        grid_.probe[owner_[spare]] = kNobody;
        grid_.probe[*open] = spare;
        owner_[spare] = *open;
      }
    }
    if (spare != kNobody) move_site(spare, place);
  }

  int views(std::uint32_t eye) const {
    std::array<std::uint32_t, 8> seen;
    int count = 0;
    for (const glm::ivec3& corner : cell_corners(grid_, heads_.eyes()[eye])) {
      const std::uint32_t site = grid_.probe[vertex_index(grid_, corner)];
      if (site == kNobody || !visible(eye, site)) continue;
      if (std::find(seen.begin(), seen.begin() + count, site) == seen.begin() + count) seen[count++] = site;
    }
    return count;
  }
  bool visible(std::uint32_t eye, std::uint32_t site) const { return seen_by_[site][eye]; }

  std::vector<bool> eyes_that_see(glm::dvec3 point_m) const {
    const double far = 3.0 * glm::length(grid_.spacing_m);  // no head in a cell around the vertex is farther
    std::vector<bool> seen(heads_.eyes().size(), false);
    for (std::size_t e = 0; e < seen.size(); ++e) {
      seen[e] = glm::distance(heads_.eyes()[e], point_m) < far && sees(rays_, point_m, heads_.eyes()[e]);
    }
    return seen;
  }

  // A vertex without a probe of its own takes the one that adds most to what the heads around it see.
  void share(SiteCounts& counts) {
    for (const glm::ivec3& vertex : vertices_) {
      std::uint32_t& served_by = grid_.probe[vertex_index(grid_, vertex)];
      if (served_by != kNobody) continue;
      const std::vector<std::uint32_t> eyes = heads_in_cells_of(vertex);
      if (eyes.empty()) continue;
      ++counts.shared;
      served_by = best_for(vertex, eyes);
    }
  }
  std::vector<std::uint32_t> heads_in_cells_of(glm::ivec3 vertex) const {
    std::vector<std::uint32_t> eyes = eyes_around(vertex, heads_.eyes().size());
    std::erase_if(eyes, [&](std::uint32_t e) {
      const auto around = cell_corners(grid_, heads_.eyes()[e]);
      return std::find(around.begin(), around.end(), vertex) == around.end();
    });
    return eyes;
  }
  std::uint32_t best_for(glm::ivec3 vertex, const std::vector<std::uint32_t>& eyes) const {
    std::vector<double> need(eyes.size());
    for (std::size_t i = 0; i < eyes.size(); ++i) need[i] = 1.0 / (1.0 + std::pow(double(views(eyes[i])), 2.0));
    std::uint32_t best = kNobody;
    double most = 0.0;
    for (std::uint32_t site = 0; site < sites_.size(); ++site) {
      double gain = 0.0;
      for (std::size_t i = 0; i < eyes.size(); ++i) {
        if (!visible(eyes[i], site)) continue;
        bool fresh = true;
        for (const glm::ivec3& corner : cell_corners(grid_, heads_.eyes()[eyes[i]])) {
          fresh = fresh && grid_.probe[vertex_index(grid_, corner)] != site;
        }
        gain += fresh ? need[i] : 0.05 * need[i];
      }
      gain /= 1.0 + glm::length((sites_[site].position_m - vertex_m(grid_, vertex)) / grid_.spacing_m);
      if (gain > most) {
        most = gain;
        best = site;
      }
    }
    return best;
  }

  // Heads that too few probes see get another, at a vertex around them that has none of its own.
  void add_where_few_see(SiteCounts& counts) {
    static const std::vector<glm::dvec3> kOffsets = offsets();
    for (std::uint32_t eye = 0; eye < heads_.eyes().size() && sites_.size() < max_probes_; ++eye) {
      if (views(eye) >= kWantedViews) continue;
      for (const glm::ivec3& vertex : cell_corners(grid_, heads_.eyes()[eye])) {
        const std::size_t v = vertex_index(grid_, vertex);
        const std::uint32_t site = grid_.probe[v];
        if (site != kNobody && owner_[site] == v) continue;
        const std::vector<std::uint32_t> eyes = heads_in_cells_of(vertex);
        const Audience audience = audience_of(vertex);
        double most = 0.0;
        glm::dvec3 best(0.0);
        for (const glm::dvec3& offset : kOffsets) {
          // Anywhere in the cells around the head's side of the vertex.
          const glm::dvec3 point = 0.5 * (heads_.eyes()[eye] + vertex_m(grid_, vertex)) + offset * grid_.spacing_m;
          if (!fits(point) || !sees(rays_, point, heads_.eyes()[eye])) continue;
          const double worth = need_met(point, audience) + 0.3 * clearance_m(rays_, point, kRoomy_m) / kRoomy_m;
          if (worth > most) {
            most = worth;
            best = point;
          }
        }
        if (most <= 0.0) continue;
        const int before = least_views(eyes);
        const std::uint32_t old = grid_.probe[v];
        grid_.probe[v] = add_site(best, v);
        if (least_views(eyes) < before) {  // another head lost the probe that it needed more
          remove_last_site();
          grid_.probe[v] = old;
          continue;
        }
        ++counts.added;
        if (views(eye) >= kWantedViews) break;
      }
    }
  }
  int least_views(const std::vector<std::uint32_t>& eyes) const {
    int least = 8;
    for (const std::uint32_t e : eyes) least = std::min(least, views(e));
    return least;
  }

  // Vertices far from heads, where rays pass: the nearest probe that sees them, else the nearest.
  void serve_the_rest() {
    constexpr std::size_t kTried = 12;
    for (const glm::ivec3& vertex : vertices_) {
      std::uint32_t& served_by = grid_.probe[vertex_index(grid_, vertex)];
      if (served_by != kNobody) continue;
      const glm::dvec3 at = vertex_m(grid_, vertex);
      std::vector<std::uint32_t> order(sites_.size());
      std::iota(order.begin(), order.end(), 0u);
      std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return glm::distance(sites_[a].position_m, at) < glm::distance(sites_[b].position_m, at);
      });
      served_by = order.front();
      for (std::size_t i = 0; i < std::min(kTried, order.size()); ++i) {
        if (!sees(rays_, sites_[order[i]].position_m, at)) continue;
        served_by = order[i];
        break;
      }
    }
  }

  std::vector<ProbeSite> sorted_by_room() {
    std::vector<std::uint32_t> order(sites_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return sites_[a].room != sites_[b].room ? sites_[a].room < sites_[b].room : owner_[a] < owner_[b];
    });
    std::vector<std::uint32_t> place(sites_.size());
    std::vector<ProbeSite> sorted;
    for (const std::uint32_t old : order) {
      place[old] = std::uint32_t(sorted.size());
      sorted.push_back(sites_[old]);
    }
    for (std::uint32_t& probe : grid_.probe) probe = place[probe];
    return sorted;
  }

  ProbeGrid& grid_;
  const RayScene& rays_;
  const Space& space_;
  const HeadSpace& heads_;
  std::size_t max_probes_;
  std::vector<glm::ivec3> vertices_;
  std::vector<ProbeSite> sites_;
  std::vector<std::size_t> owner_;           // vertex of each site
  std::vector<std::vector<bool>> seen_by_;   // by site: which eyes see it
};

}  // namespace

double clearance_m(const RayScene& rays, glm::dvec3 point_m, double far_m) {
  double least = far_m;
  for (int code = 0; code < 27; ++code) {
    if (code == 13) continue;
    const glm::vec3 direction = glm::normalize(glm::vec3(code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1));
    const SurfaceHit hit = rays.closest(glm::vec3(point_m), direction, 0.0f, float(least));
    if (hit.hit) least = std::min(least, double(hit.t));
  }
  return least;
}

std::vector<ProbeSite> choose_sites(ProbeGrid& grid, const RayScene& rays, const Space& space, const HeadSpace& heads,
                                    std::size_t max_probes, SiteCounts& counts) {
  return SiteChooser(grid, rays, space, heads, max_probes).run(counts);
}

}  // namespace probewalk
