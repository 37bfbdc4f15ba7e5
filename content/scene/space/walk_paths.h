// Ways through one part of the floor: Dijkstra that keeps away from walls, and straight lines on the grid.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "content/scene/space/floor_graph.h"

namespace probewalk {

// The cheapest ways from one place to all others of a part; vectors run parallel to the part's places.
struct WalkTree {
  std::vector<float> cost;              // metres, longer near walls; infinite where no way leads
  std::vector<float> length_m;          // of the cheapest way
  std::vector<std::int32_t> previous;   // towards the root, index into the part's places; -1 at the root
};

// Where a search may end before all places are reached.
struct SearchEnd {
  // Both by place of the part:
  const std::vector<float>* within_m = nullptr;  // no way goes on from where it is this long already
  const std::vector<bool>* goals = nullptr;      // ends when `goal_count` of these are reached
  std::size_t goal_count = SIZE_MAX;
};

class WalkPaths {
 public:
  // `places` ascending, of one connected part; both must outlive this object.
  WalkPaths(const FloorGraph& graph, const std::vector<std::int32_t>& places);

  const FloorGraph& graph() const { return graph_; }
  const std::vector<std::int32_t>& places() const { return places_; }
  // Index into places() of a place of the graph, or -1.
  std::int32_t local(std::int32_t place) const { return local_[place]; }
  WalkTree from(std::int32_t local_root, const SearchEnd& end = {}) const;

 private:
  const FloorGraph& graph_;
  const std::vector<std::int32_t>& places_;
  std::vector<std::int32_t> local_;
};

// A way as places of the graph (neighbours or further), with corners that a straight walk can skip taken out. What is
// left keeps 0.45 m from walls, or as much as the way itself did.
std::vector<std::int32_t> straightened(const FloorGraph& graph, const std::vector<std::int32_t>& way);

// The places that the straight line from one place to another crosses, both included; empty when it cannot be walked
// or comes closer to a wall than `clearance_m`.
std::vector<std::int32_t> straight_walk(const FloorGraph& graph, std::int32_t from, std::int32_t to, float clearance_m);

}  // namespace probewalk
