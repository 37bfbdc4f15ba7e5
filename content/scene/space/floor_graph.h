// Steps 4 and 5: where feet can stand, how floors join, how far each place is from the nearest wall or edge.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "content/scene/space/column_spans.h"

namespace probewalk {

inline constexpr double kStep_m = 0.45;  // the highest step a walker takes; never 0.40, which grid-built maps use

// A walkable top of a span with kHeadroom_m free above it.
struct StandingPlace {
  std::int32_t ix = 0, iz = 0;
  float floor_m = 0.0f;
  float ceiling_m = 0.0f;
  // Neighbours towards +x, +z, -x, -z; -1 where one cannot walk. Links are symmetric.
  std::array<std::int32_t, 4> link{-1, -1, -1, -1};
  float wall_m = 0.0f;  // Euclidean distance from the middle to the nearest missing link, in plan
};

inline constexpr std::array<std::int32_t, 4> kLinkX{1, 0, -1, 0};
inline constexpr std::array<std::int32_t, 4> kLinkZ{0, 1, 0, -1};

struct FloorGraph {
  glm::dvec2 origin_m{0.0};
  double cell_m = 0.05;
  glm::ivec2 columns{0};
  std::vector<StandingPlace> places;  // sorted by (iz, ix, floor)

  double area_m2(std::size_t count) const { return double(count) * cell_m * cell_m; }
  glm::dvec3 foot_m(std::int32_t place) const;
  // Where the eyes of someone standing there are: 1.6 m up, less where the ceiling is low.
  glm::dvec3 eye_m(std::int32_t place) const;
  // Diagonal neighbour between links k and k + 1 (mod 4), reached over both; -1 without one.
  std::int32_t diagonal(std::int32_t place, int k) const;
};

// What links places of neighbouring columns: heights that differ by at most this, and this much free above both.
struct LinkRule {
  float step_m, headroom_m;
};

// Fill the links (each place's nearest in height, where the choice is mutual) and the distances to walls.
void link_places(FloorGraph& graph, const LinkRule& rule);
void measure_walls(FloorGraph& graph);

FloorGraph build_floor_graph(const ColumnSpans& spans);

}  // namespace probewalk
