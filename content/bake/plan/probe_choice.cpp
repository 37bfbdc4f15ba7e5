#include "content/bake/plan/probe_choice.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <queue>

#include "content/bake/placement/grid_choice.h"
#include "content/bake/placement/probe_sites.h"
#include "content/bake/probe_lattice.h"
#include "content/error.h"

namespace probewalk {
namespace {

constexpr double kClearance_m = 0.2;
constexpr double kApart_m = 0.35;  // candidates closer than this are one
constexpr std::size_t kMostCandidates = 900;
constexpr std::size_t kFewestInRoom = 8, kMostInRoom = 40;
constexpr std::size_t kPlacesOfNeed = 10;
constexpr double kLeastGain_rays = 1.0;
constexpr std::size_t kNeighboursTried = 6;

// `count` of the places, each as far from those before as can be; the first is the one nearest to their middle.
std::vector<glm::dvec3> spread_out(const std::vector<glm::dvec3>& places, std::size_t count) {
  std::vector<glm::dvec3> spread;
  if (places.empty()) return spread;
  glm::dvec3 middle(0.0);
  for (const glm::dvec3& place : places) middle += place / double(places.size());
  std::vector<double> away(places.size());
  std::size_t next = 0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    away[k] = HUGE_VAL;
    if (glm::distance(places[k], middle) < glm::distance(places[next], middle)) next = k;
  }
  while (spread.size() < std::min(count, places.size())) {
    spread.push_back(places[next]);
    std::size_t furthest = 0;
    for (std::size_t k = 0; k < places.size(); ++k) {
      away[k] = std::min(away[k], glm::distance(places[k], spread.back()));
      if (away[k] > away[furthest]) furthest = k;
    }
    if (away[furthest] < kApart_m) break;
    next = furthest;
  }
  return spread;
}

}  // namespace

ProbeChoice::ProbeChoice(const Space& space, const HeadSpace& heads, const RayScene& triangles,
                         const std::vector<EyeRay>& rays, const ProbeGrid& grid, int map_side, Progress& progress)
    : space_(space),
      heads_(heads),
      triangles_(triangles),
      rays_(rays),
      grid_(grid),
      progress_(progress),
      coverage_(rays, triangles, space.rooms.size(), map_side),
      room_rays_(space.rooms.size(), 0.0) {
  for (const EyeRay& ray : rays) room_rays_[ray.room] += 1.0;
  gather_candidates();
}

void ProbeChoice::stop_if_asked() const {
  if (progress_.cancelled()) throw Interrupted("interrupted while planning; what is finished is kept");
}

void ProbeChoice::gather_candidates() {
  const std::size_t rooms = space_.rooms.size();
  std::vector<std::vector<glm::dvec3>> off_grid(rooms), on_grid(rooms);
  const auto is_roomy = [&](glm::dvec3 place) { return clearance_m(triangles_, place, kClearance_m) >= kClearance_m; };
  for (const glm::dvec3& eye : heads_.eyes()) {
    if (is_roomy(eye)) off_grid[std::size_t(std::clamp(heads_.room(eye), 0, int(rooms) - 1))].push_back(eye);
  }
  for (std::size_t v = 0; v < grid_.probe.size(); ++v) {
    const int x = int(v) % grid_.dims.x, y = int(v) / grid_.dims.x % grid_.dims.y,
              z = int(v) / (grid_.dims.x * grid_.dims.y);
    const glm::dvec3 place = vertex_m(grid_, {x, y, z});
    if (heads_.holds(place) && is_roomy(place))
      on_grid[std::size_t(std::clamp(heads_.room(place), 0, int(rooms) - 1))].push_back(place);
  }
  for (const Portal& portal : space_.portals) {
    glm::dvec3 middle(0.0);
    double floor_m = HUGE_VAL;
    for (const glm::dvec3& corner : portal.polygon) {
      middle += corner / double(portal.polygon.size());
      floor_m = std::min(floor_m, corner.y);
    }
    middle.y = std::min(middle.y, floor_m + 1.4);
    if (is_roomy(middle)) off_grid[std::size_t(portal.room_a)].push_back(middle);
  }
  const std::size_t in_room = std::clamp(kMostCandidates / std::max<std::size_t>(1, rooms), kFewestInRoom, kMostInRoom);
  progress_.begin("candidates", rooms, "rooms");
  for (std::size_t room = 0; room < rooms; ++room) {
    stop_if_asked();
    std::vector<glm::dvec3> places = spread_out(off_grid[room], in_room / 2);
    const std::vector<glm::dvec3> vertices = spread_out(on_grid[room], in_room - places.size());
    places.insert(places.end(), vertices.begin(), vertices.end());
    add_candidates(places, int(room));
    progress_.advance(1);
  }
  if (coverage_.candidates().empty()) add_candidates({space_.start.position_m}, -1);
}

// Places near ones that there are already are left out. room < 0: the one that the place is in.
void ProbeChoice::add_candidates(const std::vector<glm::dvec3>& places_m, int room) {
  std::vector<glm::dvec3> places;
  std::vector<std::uint32_t> rooms;
  for (const glm::dvec3& wanted : places_m) {
    const glm::dvec3 place = on_lattice(wanted);
    const auto near = [&](glm::dvec3 other) { return glm::distance(other, place) < kApart_m; };
    if (std::any_of(places.begin(), places.end(), near)) continue;
    if (std::any_of(coverage_.candidates().begin(), coverage_.candidates().end(),
                    [&](const Candidate& candidate) { return near(candidate.position_m); }))
      continue;
    places.push_back(place);
    rooms.push_back(std::uint32_t(room >= 0 ? room : std::clamp(heads_.room(place), 0, int(space_.rooms.size()) - 1)));
  }
  coverage_.add_candidates(places, rooms);
}

void ProbeChoice::gather_by_need(std::uint32_t room) {
  std::vector<glm::dvec3> places;
  for (const glm::dvec3& place : coverage_.places_of_need(room, kPlacesOfNeed)) {
    if (clearance_m(triangles_, place, 0.1) >= 0.1) places.push_back(place);
  }
  add_candidates(places, int(room));
}

std::optional<std::uint32_t> ProbeChoice::best_for(const std::vector<double>& room_weight, double least_gain,
                                                   double& gain) const {
  std::vector<double> gains(coverage_.candidates().size(), -1.0);
  tbb::parallel_for(std::size_t(0), gains.size(), [&](std::size_t c) {
    const auto& chosen = coverage_.chosen();
    if (std::find(chosen.begin(), chosen.end(), std::uint32_t(c)) != chosen.end()) return;
    gains[c] = coverage_.gain(std::uint32_t(c), room_weight);
  });
  const auto best = std::max_element(gains.begin(), gains.end());
  gain = *best;
  if (*best < least_gain) return {};
  return std::uint32_t(best - gains.begin());
}

std::size_t ProbeChoice::chosen_in(std::uint32_t room) const {
  const std::vector<std::uint32_t>& chosen = coverage_.chosen();
  return std::size_t(std::count_if(chosen.begin(), chosen.end(),
                                   [&](std::uint32_t c) { return coverage_.candidates()[c].room == room; }));
}

std::size_t ProbeChoice::rooms_without() const {
  std::vector<bool> waits(room_rays_.size(), false);
  for (const Candidate& candidate : coverage_.candidates()) waits[candidate.room] = has_floor(candidate.room);
  for (const std::uint32_t c : coverage_.chosen()) waits[coverage_.candidates()[c].room] = false;
  return std::size_t(std::count(waits.begin(), waits.end(), true));
}

bool ProbeChoice::leaves_enough(std::uint32_t candidate, std::size_t most) const {
  const std::uint32_t room = coverage_.candidates()[candidate].room;
  if (has_floor(room) && chosen_in(room) == 0) return true;
  return coverage_.chosen().size() + rooms_without() < most;
}

void ProbeChoice::choose(double unanswered, std::size_t most) {
  const std::size_t rooms = space_.rooms.size();
  // Gains only fall as probes are added: what was worth less than the best now need not be looked at again.
  using Entry = std::pair<double, std::uint32_t>;
  std::priority_queue<Entry> queue;
  std::vector<double> weight(rooms, 1.0);
  std::vector<double> gains(coverage_.candidates().size());
  progress_.begin("choosing", coverage_.candidates().size(), "candidates");
  tbb::parallel_for(std::size_t(0), gains.size(), [&](std::size_t c) {
    if (progress_.cancelled()) return;
    gains[c] = coverage_.gain(std::uint32_t(c), weight);
    progress_.advance(1);
  });
  stop_if_asked();
  for (std::uint32_t c = 0; c < gains.size(); ++c) queue.emplace(gains[c], c);
  while (!queue.empty() && coverage_.chosen().size() < most) {
    stop_if_asked();
    for (std::size_t room = 0; room < rooms; ++room)
      weight[room] = coverage_.unanswered()[room] > unanswered ? 1.0 : 0.0;
    const std::uint32_t c = queue.top().second;
    queue.pop();
    if (!leaves_enough(c, most)) continue;  // nor will it later: probes only get fewer, and its room has one
    const double gain = coverage_.gain(c, weight);
    if (!queue.empty() && gain < queue.top().first) {
      if (gain >= kLeastGain_rays) queue.emplace(gain, c);
      continue;
    }
    if (gain < kLeastGain_rays) break;
    coverage_.choose(c);
  }
  if (coverage_.chosen().empty()) coverage_.choose(0);
  relocate(unanswered);
  remove_needless(unanswered);
}

// Each probe in turn is taken away and set where it does most for the others, which may be where it stood.
void ProbeChoice::relocate(double unanswered) {
  if (coverage_.chosen().size() < 2) return;
  for (std::size_t k = 0; k < coverage_.chosen().size(); ++k) {
    stop_if_asked();
    std::vector<std::uint32_t> others = coverage_.chosen();
    const std::uint32_t own = others[k];
    others.erase(others.begin() + std::ptrdiff_t(k));
    coverage_.reset(others);
    std::vector<double> weight(space_.rooms.size());
    for (std::size_t room = 0; room < weight.size(); ++room)
      weight[room] = coverage_.unanswered()[room] > 0.5 * unanswered ? 1.0 : 0.0;
    const glm::dvec3 at = coverage_.candidates()[own].position_m;
    const std::uint32_t room = coverage_.candidates()[own].room;
    const bool is_only = has_floor(room) && chosen_in(room) == 0;  // which its room keeps
    std::vector<std::uint32_t> near;
    for (std::uint32_t c = 0; c < coverage_.candidates().size(); ++c) {
      if (is_only && coverage_.candidates()[c].room != room) continue;
      if (std::find(others.begin(), others.end(), c) == others.end() && c != own) near.push_back(c);
    }
    std::stable_sort(near.begin(), near.end(), [&](std::uint32_t a, std::uint32_t b) {
      return glm::distance(coverage_.candidates()[a].position_m, at) <
             glm::distance(coverage_.candidates()[b].position_m, at);
    });
    near.resize(std::min(near.size(), kNeighboursTried));
    near.insert(near.begin(), own);
    std::vector<double> gains(near.size());
    tbb::parallel_for(std::size_t(0), near.size(), [&](std::size_t i) { gains[i] = coverage_.gain(near[i], weight); });
    const std::size_t best = std::size_t(std::max_element(gains.begin(), gains.end()) - gains.begin());
    others.insert(others.begin() + std::ptrdiff_t(k), near[best]);
    coverage_.reset(others);
  }
}

void ProbeChoice::remove_needless(double unanswered) {
  for (std::size_t k = coverage_.chosen().size(); k-- > 0 && coverage_.chosen().size() > 1;) {
    stop_if_asked();
    const std::vector<std::uint32_t> all = coverage_.chosen();
    const std::vector<double> before = coverage_.unanswered();
    std::vector<std::uint32_t> others = all;
    others.erase(others.begin() + std::ptrdiff_t(k));
    coverage_.reset(others);
    bool needed = false;
    for (std::size_t room = 0; room < before.size(); ++room) {
      needed |=
          coverage_.unanswered()[room] > std::max(unanswered, before[room] + 0.5 / std::max(1.0, room_rays_[room]));
    }
    if (needed) coverage_.reset(all);
  }
}

double ProbeChoice::next_gain(std::uint32_t room) {
  gather_by_need(room);
  std::vector<double> weight(space_.rooms.size(), 0.0);
  weight[room] = 1.0;
  double gain = 0.0;
  best_for(weight, 0.0, gain);
  return std::max(0.0, gain) / std::max(1.0, room_rays_[room]);
}

std::optional<std::uint32_t> ProbeChoice::add_for(std::uint32_t room) {
  gather_by_need(room);
  std::vector<double> weight(space_.rooms.size(), 0.0);
  weight[room] = 1.0;
  double gain = 0.0;
  const std::optional<std::uint32_t> best = best_for(weight, kLeastGain_rays, gain);
  if (best) coverage_.choose(*best);
  return best;
}

std::optional<std::uint32_t> ProbeChoice::least_needed(std::uint32_t room) {
  if (coverage_.chosen().size() < 2) return {};
  std::optional<std::uint32_t> least;
  double best = HUGE_VAL;
  const std::vector<std::uint32_t> all = coverage_.chosen();
  for (std::size_t k = 0; k < all.size(); ++k) {
    const std::uint32_t c = all[k];
    if (coverage_.candidates()[c].room != room) continue;
    std::vector<std::uint32_t> others = all;
    others.erase(others.begin() + std::ptrdiff_t(k));
    coverage_.reset(others);
    double sum = 0.0;
    for (const double share : coverage_.unanswered()) sum += share;
    if (sum < best) {
      best = sum;
      least = c;
    }
  }
  coverage_.reset(all);
  return least;
}

}  // namespace probewalk
