#include "content/scene/space/room_search.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <queue>
#include <set>
#include <tuple>

namespace probewalk {
namespace {

// A passage parts two basins when it is a door's width and clearly narrower than both, or much narrower than both.
constexpr float kLeastRise_m = 0.15f;
constexpr float kDoor_m = 1.4f;
constexpr float kDoorShare = 0.85f;
constexpr float kMuchShare = 0.6f;
constexpr float kNarrowest_m = 0.7f;  // a room's widest place is no narrower
constexpr double kLeastFloor = 0.5;   // share of the smallest room that is floor, and not furniture to lean over
// Rooms over the limit are searched again for passages of these shares, with pieces no smaller than this.
constexpr float kLargeShares[]{0.8f, 0.93f};
constexpr double kLeastPiece_m2 = 12.0;
constexpr std::int32_t kMostRooms = 4096;

using Parts = std::function<bool(float saddle_m, float peak_m)>;  // distances to walls: of the passage, the lower peak

bool parts_rooms(float saddle_m, float peak_m) {
  return peak_m - saddle_m >= kLeastRise_m &&
         ((2.0f * saddle_m < kDoor_m && saddle_m < kDoorShare * peak_m) || saddle_m < kMuchShare * peak_m);
}

class Basins {
 public:
  std::int32_t add(float peak_m) {
    parent_.push_back(std::int32_t(parent_.size()));
    peak_m_.push_back(peak_m);
    return parent_.back();
  }
  std::int32_t root(std::int32_t b) {
    while (parent_[b] != b) b = parent_[b] = parent_[parent_[b]];
    return b;
  }
  float peak_m(std::int32_t root) const { return peak_m_[root]; }
  void join(std::int32_t a, std::int32_t b) {  // roots
    if (peak_m_[a] < peak_m_[b]) std::swap(a, b);
    parent_[b] = a;
  }

 private:
  std::vector<std::int32_t> parent_;
  std::vector<float> peak_m_;
};

class RoomSearch {
 public:
  RoomSearch(const HeadMap& heads, const RoomLimits& limits)
      : heads_(heads), graph_(heads.graph), limits_(limits), label_(graph_.places.size(), -1) {}

  FoundRooms run() {
    std::vector<std::int32_t> all(graph_.places.size());
    std::iota(all.begin(), all.end(), 0);
    flood(all, parts_rooms);
    // What is too large for a building is cut into larger pieces: no number of them would do on a plain of kilometres.
    const double all_m2 = graph_.area_m2(all.size());
    double largest_m2 = std::max(limits_.largest_m2, 2.0 * all_m2 / kMostRooms);
    for (double smallest_m2 = limits_.smallest_m2;; smallest_m2 *= 2.0, largest_m2 *= 2.0) {
      join_small(all, smallest_m2, kNarrowest_m);
      cut_large(largest_m2);
      if (count_rooms() <= kMostRooms || smallest_m2 > all_m2) break;
    }
    return numbered();
  }

 private:
  float wall_m(std::int32_t place) const { return graph_.places[place].wall_m; }

  // Watershed over the places given (ascending), which all get new labels. Each belongs to the basin of its highest
  // neighbour: creeping along walls from the first basin that touches would make crooked borders.
  void flood(const std::vector<std::int32_t>& places, const Parts& parts) {
    std::vector<std::int32_t> order = places;
    std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) { return wall_m(a) > wall_m(b); });
    Basins basins;
    std::vector<std::int32_t>& basin = scratch_;
    basin.resize(graph_.places.size(), -1);
    for (const std::int32_t i : order) {
      std::int32_t highest = -1;
      for (const std::int32_t j : graph_.places[i].link) {
        if (j >= 0 && basin[j] >= 0 && (highest < 0 || wall_m(j) > wall_m(highest))) highest = j;
      }
      if (highest < 0) {
        basin[i] = basins.add(wall_m(i));
        continue;
      }
      basin[i] = basin[highest];
      for (const std::int32_t j : graph_.places[i].link) {
        if (j < 0 || basin[j] < 0) continue;
        const std::int32_t a = basins.root(basin[i]), b = basins.root(basin[j]);
        if (a != b && !parts(wall_m(i), std::min(basins.peak_m(a), basins.peak_m(b)))) basins.join(a, b);
      }
    }
    std::map<std::int32_t, std::int32_t> fresh;
    for (const std::int32_t i : places) {
      const auto [entry, is_new] = fresh.try_emplace(basins.root(basin[i]), next_label_);
      next_label_ += is_new;
      label_[i] = entry->second;
    }
    for (const std::int32_t i : places) basin[i] = -1;
  }

  struct Piece {
    std::size_t places = 0, floor_places = 0;
    float widest_m = 0.0f;
    std::map<std::int32_t, float> saddle_m;  // to neighbours: half the width of the widest passage
  };

  // Among the places given (whole rooms): what is too small or narrow, or has no floor, joins where it opens widest.
  void join_small(const std::vector<std::int32_t>& places, double smallest_m2, float narrowest_m) {
    std::map<std::int32_t, Piece> pieces;
    for (const std::int32_t i : places) {
      Piece& piece = pieces[label_[i]];
      ++piece.places;
      piece.floor_places += heads_.floor_place[i] >= 0;
      piece.widest_m = std::max(piece.widest_m, 2.0f * wall_m(i));
    }
    for (const std::int32_t i : places) {
      for (const std::int32_t j : graph_.places[i].link) {
        if (j < 0 || label_[j] == label_[i] || !pieces.contains(label_[j])) continue;
        float& saddle_m = pieces[label_[i]].saddle_m[label_[j]];
        saddle_m = std::max(saddle_m, std::min(wall_m(i), wall_m(j)));
      }
    }
    std::map<std::int32_t, std::int32_t> into;
    std::set<std::pair<std::size_t, std::int32_t>> queue;
    for (const auto& [label, piece] : pieces) queue.emplace(piece.places, label);
    while (!queue.empty()) {
      const std::int32_t label = queue.begin()->second;
      queue.erase(queue.begin());
      Piece& small = pieces[label];
      const bool stays = graph_.area_m2(small.places) >= smallest_m2 && small.widest_m >= narrowest_m &&
                         graph_.area_m2(small.floor_places) >= kLeastFloor * smallest_m2;
      if (stays || small.saddle_m.empty()) continue;
      const std::int32_t to =
          std::max_element(small.saddle_m.begin(), small.saddle_m.end(), [](const auto& a, const auto& b) {
            return a.second < b.second;
          })->first;
      Piece& large = pieces[to];
      queue.erase({large.places, to});
      large.places += small.places;
      large.floor_places += small.floor_places;
      large.widest_m = std::max(large.widest_m, small.widest_m);
      for (const auto& [other, saddle_m] : small.saddle_m) {
        pieces[other].saddle_m.erase(label);
        if (other == to) continue;
        for (Piece* piece : {&large, &pieces[other]}) {
          float& widest = piece->saddle_m[piece == &large ? other : to];
          widest = std::max(widest, saddle_m);
        }
      }
      pieces.erase(label);
      into[label] = to;
      queue.emplace(pieces[to].places, to);
    }
    for (const std::int32_t i : places) {
      for (auto next = into.find(label_[i]); next != into.end(); next = into.find(label_[i])) label_[i] = next->second;
    }
  }

  std::map<std::int32_t, std::vector<std::int32_t>> by_label() const {
    std::map<std::int32_t, std::vector<std::int32_t>> rooms;
    for (std::size_t i = 0; i < label_.size(); ++i) rooms[label_[i]].push_back(std::int32_t(i));
    return rooms;
  }
  std::int32_t count_rooms() const { return std::int32_t(std::set(label_.begin(), label_.end()).size()); }

  void cut_large(double largest_m2) {
    for (const float share : kLargeShares) {
      for (const auto& [label, places] : by_label()) {
        if (graph_.area_m2(places.size()) <= largest_m2) continue;
        flood(places, [share](float saddle_m, float peak_m) {
          return peak_m - saddle_m >= kLeastRise_m && saddle_m < share * peak_m;
        });
        join_small(places, kLeastPiece_m2, kNarrowest_m);
      }
    }
    for (const auto& [label, places] : by_label()) halve(places, largest_m2);
  }

  // At the middle between the two places that are farthest apart, walking; again until it is small enough.
  void halve(const std::vector<std::int32_t>& places, double largest_m2) {
    if (graph_.area_m2(places.size()) <= largest_m2) return;
    const std::vector<float> from_any = ways_from(places.front(), places);
    const std::int32_t a = places[std::size_t(std::max_element(from_any.begin(), from_any.end()) - from_any.begin())];
    const std::vector<float> from_a = ways_from(a, places);
    const std::int32_t b = places[std::size_t(std::max_element(from_a.begin(), from_a.end()) - from_a.begin())];
    const std::vector<float> from_b = ways_from(b, places);
    std::vector<std::int32_t> near_a, near_b;
    for (std::size_t k = 0; k < places.size(); ++k) (from_a[k] <= from_b[k] ? near_a : near_b).push_back(places[k]);
    if (near_a.empty() || near_b.empty()) return;
    const std::int32_t label = next_label_++;
    for (const std::int32_t i : near_b) label_[i] = label;
    halve(near_a, largest_m2);
    halve(near_b, largest_m2);
  }

  // Lengths in cells within one room, by index into `places`, over straight and diagonal steps.
  std::vector<float> ways_from(std::int32_t root, const std::vector<std::int32_t>& places) {
    std::vector<std::int32_t>& local = scratch_;
    local.resize(graph_.places.size(), -1);
    for (std::size_t k = 0; k < places.size(); ++k) local[places[k]] = std::int32_t(k);
    std::vector<float> length(places.size(), HUGE_VALF);
    std::priority_queue<std::pair<float, std::int32_t>, std::vector<std::pair<float, std::int32_t>>, std::greater<>>
        queue;
    length[local[root]] = 0.0f;
    queue.emplace(0.0f, root);
    while (!queue.empty()) {
      const auto [at, i] = queue.top();
      queue.pop();
      if (at > length[local[i]]) continue;
      for (int k = 0; k < 8; ++k) {
        const std::int32_t j = k < 4 ? graph_.places[i].link[k] : graph_.diagonal(i, k - 4);
        if (j < 0 || local[j] < 0) continue;
        const float there = at + (k < 4 ? 1.0f : 1.41421356f);
        if (there >= length[local[j]]) continue;
        length[local[j]] = there;
        queue.emplace(there, j);
      }
    }
    for (const std::int32_t i : places) local[i] = -1;
    for (float& way : length) way = way == HUGE_VALF ? 0.0f : way;
    return length;
  }

  FoundRooms numbered() const {
    std::vector<std::tuple<std::size_t, std::int32_t, std::int32_t>> rooms;  // size, first place, label
    for (const auto& [label, places] : by_label()) rooms.emplace_back(places.size(), places.front(), label);
    std::sort(rooms.begin(), rooms.end());
    std::map<std::int32_t, std::int32_t> number;
    for (const auto& [size, first, label] : rooms) number.emplace(label, std::int32_t(number.size()));
    FoundRooms found{{}, std::int32_t(rooms.size())};
    for (const std::int32_t label : label_) found.room.push_back(number.at(label));
    return found;
  }

  const HeadMap& heads_;
  const FloorGraph& graph_;
  const RoomLimits limits_;
  std::vector<std::int32_t> label_;
  std::int32_t next_label_ = 0;
  std::vector<std::int32_t> scratch_;  // by place; -1 between uses
};

}  // namespace

FoundRooms search_rooms(const HeadMap& heads, const RoomLimits& limits) {
  return RoomSearch(heads, limits).run();
}

}  // namespace probewalk
