// The probe ordering problem (Donow 2016, chapter 6): which probe of a cell a ray asks first, and which after it, as a
// function of where in the cell it starts and where it goes. In the plane by formula, in space as the tracer does it.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "content/probe/probe_set.h"
#include "shaders/shared/selection_rules.h"

namespace probewalk {

// Corners of the square [-1, 1]^2 in the numbering of figure 6.1: clockwise from the lower left.
inline constexpr std::array<glm::ivec2, 4> kSquareCorners{glm::ivec2{-1, -1}, {-1, 1}, {1, 1}, {1, -1}};

// The corners by falling score of a ray from `origin` inside the square. `first` is one of kFirst...; the scores are those
// of tracer.h in two dimensions.
std::array<int, 4> square_order(int first, glm::dvec2 origin, glm::dvec2 unit_direction);

// Directions from_rad .. to_rad (counter-clockwise from +x) that share an order.
struct OrderSector {
  double from_rad, to_rad;
  std::array<int, 4> order;
};
// All directions in [0, 2 pi), borders to 1e-9 rad; neighbours differ in their order.
std::vector<OrderSector> square_sectors(int first, glm::dvec2 origin);

// The eight probes of a cube of 1 m, corner k at (k & 1, k >> 1 & 1, k >> 2).
class CubeOrdering {
 public:
  CubeOrdering();
  // The corners as the tracer asks them, for a ray from `origin` in [0, 1]^3.
  std::array<int, 8> order(const SelectionRules& rules, glm::dvec3 origin, glm::dvec3 unit_direction) const;

 private:
  ProbeSet probes_;
};

// Over all directions alike from one origin.
struct OrderStatistics {
  std::array<double, 8> first_share{};  // of the directions in which the corner is first
  int distinct_orders = 0;
  double first_cosine = 0.0;      // mean cosine between the ray and the displacement from its first probe
  double second_turn_rad = 0.0;   // mean angle at the origin between its first and its second probe
  double corners_moved = 0.0;     // mean number of coordinates in which probes asked one after the other differ
};
OrderStatistics order_statistics(const CubeOrdering& cube, const SelectionRules& rules, glm::dvec3 origin, int directions);

// Direction k of n spread evenly over the sphere (a spherical Fibonacci lattice), unit length.
glm::dvec3 spread_direction(int k, int n);

}  // namespace probewalk
