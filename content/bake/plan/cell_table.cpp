#include "content/bake/plan/cell_table.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "content/bake/placement/grid_choice.h"

namespace probewalk {
namespace {

constexpr double kCell_m = 1.0, kLayer_m = 1.2;
constexpr double kMostVertices = 30000.0;
constexpr int kPasses = 2;
constexpr double kPriceOfWrong = 0.5;  // a wrong answer ends a ray that another probe might have answered
constexpr int kHandOvers = 4;

// A ray's start in a cell, or where it stopped for the others, and what each probe can do for it there.
struct Visit {
  std::uint32_t cell = 0;
  std::vector<std::uint16_t> helps, harms;  // indices into Coverage::chosen, ascending
};

class Table {
 public:
  Table(ProbeGrid& grid, const Coverage& coverage, const std::vector<EyeRay>& rays, const RayScene& triangles)
      : grid_(grid), coverage_(coverage), triangles_(triangles) {
    std::vector<std::vector<Visit>> by_ray(rays.size());
    tbb::parallel_for(std::size_t(0), rays.size(), [&](std::size_t k) { by_ray[k] = visits_of(rays[k]); });
    by_cell_.resize(grid.probe.size());
    for (std::vector<Visit>& visits : by_ray) {
      for (Visit& visit : visits) by_cell_[visit.cell].push_back(std::move(visit));
    }
  }

  void fill() {
    std::fill(grid_.probe.begin(), grid_.probe.end(), kNobody);
    for (int pass = 0; pass < kPasses; ++pass) {
      for_each_vertex([&](glm::ivec3 vertex) {
        std::uint32_t& probe = grid_.probe[vertex_index(grid_, vertex)];
        probe = kNobody;
        probe = best_for(vertex);
      });
    }
    for_each_vertex([&](glm::ivec3 vertex) {
      std::uint32_t& probe = grid_.probe[vertex_index(grid_, vertex)];
      if (probe == kNobody) probe = nearest_to(vertex_m(grid_, vertex));
    });
  }

 private:
  static constexpr std::uint32_t kNobody = ~0u;

  template <typename Work>
  void for_each_vertex(Work&& work) {
    for (int z = 0; z < grid_.dims.z; ++z) {
      for (int y = 0; y < grid_.dims.y; ++y) {
        for (int x = 0; x < grid_.dims.x; ++x) work(glm::ivec3(x, y, z));
      }
    }
  }

  std::uint32_t cell_of(glm::dvec3 at_m) const {
    return std::uint32_t(vertex_index(grid_, cell_corners(grid_, at_m)[0]));
  }

  std::vector<Visit> visits_of(const EyeRay& ray) const {
    std::vector<Visit> visits;
    float from_m = 0.0f;
    for (int turn = 0; turn < kHandOvers; ++turn) {
      Visit visit;
      visit.cell = cell_of(ray.origin_m + glm::dvec3(ray.direction) * double(from_m));
      bool answered = false;
      float furthest = from_m;
      std::vector<std::pair<float, std::uint16_t>> partial;
      for (std::size_t p = 0; p < coverage_.chosen().size(); ++p) {
        const std::uint32_t candidate = coverage_.chosen()[p];
        if (!coverage_.matters(coverage_.candidates()[candidate], ray)) continue;
        const Walk walk = coverage_.walk(candidate, ray, from_m);
        if (walk.right) visit.helps.push_back(std::uint16_t(p));
        if (walk.wrong) visit.harms.push_back(std::uint16_t(p));
        answered |= walk.right;
        if (!walk.right && walk.free_m > from_m + 1e-3f) partial.emplace_back(walk.free_m, std::uint16_t(p));
        furthest = std::max(furthest, walk.right ? from_m : walk.free_m);
      }
      if (!answered) {
        for (const auto& [free_m, p] : partial) {
          if (free_m > from_m + 0.7f * (furthest - from_m)) visit.helps.push_back(p);
        }
      }
      if (!visit.helps.empty()) visits.push_back(std::move(visit));
      if (answered || furthest <= from_m + 1e-3f) break;
      from_m = furthest;
    }
    return visits;
  }

  // Cells that the vertex is a corner of, as cell_corners gives them.
  template <typename Work>
  void for_each_cell(glm::ivec3 vertex, Work&& work) const {
    const glm::ivec3 last = glm::max(grid_.dims - 2, 0);
    for (int k = 0; k < 8; ++k) {
      const glm::ivec3 cell = vertex - glm::ivec3(k & 1, k >> 1 & 1, k >> 2);
      if (glm::any(glm::lessThan(cell, glm::ivec3(0))) || glm::any(glm::greaterThan(cell, last))) continue;
      work(cell);
    }
  }

  std::uint32_t best_for(glm::ivec3 vertex) const {
    std::vector<double> gain(coverage_.chosen().size(), 0.0);
    bool any = false;
    for_each_cell(vertex, [&](glm::ivec3 cell) {
      std::array<std::uint32_t, 8> beside;  // the probes of the cell's other corners
      for (int k = 0; k < 8; ++k) {
        const glm::ivec3 corner = glm::min(cell + glm::ivec3(k & 1, k >> 1 & 1, k >> 2), grid_.dims - 1);
        beside[k] = grid_.probe[vertex_index(grid_, corner)];
      }
      for (const Visit& visit : by_cell_[vertex_index(grid_, cell)]) {
        any = true;
        const bool served = std::any_of(beside.begin(), beside.end(), [&](std::uint32_t probe) {
          return probe != kNobody && std::binary_search(visit.helps.begin(), visit.helps.end(), std::uint16_t(probe));
        });
        // A second probe that helps is worth something: the tracer asks in an order of its own.
        for (const std::uint16_t p : visit.helps) gain[p] += served ? 0.05 : 1.0;
        for (const std::uint16_t p : visit.harms) gain[p] -= served ? kPriceOfWrong : 0.5 * kPriceOfWrong;
      }
    });
    if (!any) return kNobody;
    const glm::dvec3 at = vertex_m(grid_, vertex);
    std::uint32_t best = kNobody;
    double most = -HUGE_VAL, least_m = HUGE_VAL;
    for (std::uint32_t p = 0; p < gain.size(); ++p) {
      const double away_m = glm::distance(position(p), at);
      if (gain[p] > most || (gain[p] == most && away_m < least_m)) {
        most = gain[p];
        least_m = away_m;
        best = p;
      }
    }
    return most > 0.0 ? best : kNobody;
  }

  glm::dvec3 position(std::uint32_t p) const { return coverage_.candidates()[coverage_.chosen()[p]].position_m; }

  // Of those that see the place, else of all.
  std::uint32_t nearest_to(glm::dvec3 at) const {
    std::uint32_t best = 0;
    double least = HUGE_VAL;
    for (std::uint32_t p = 0; p < coverage_.chosen().size(); ++p) {
      const bool sees = !triangles_.occluded(glm::vec3(position(p)), glm::vec3(at - position(p)), 0.0f, 1.0f);
      const double away = glm::distance(position(p), at) * (sees ? 1.0 : 100.0);
      if (away < least) {
        least = away;
        best = p;
      }
    }
    return best;
  }

  ProbeGrid& grid_;
  const Coverage& coverage_;
  const RayScene& triangles_;
  std::vector<std::vector<Visit>> by_cell_;
};

}  // namespace

ProbeGrid plan_grid(const HeadSpace& heads) {
  const Bounds& box = heads.bounds();
  const glm::dvec3 size = glm::max(box.upper_m - box.lower_m, glm::dvec3(0.0));
  ProbeGrid grid;
  for (double widen = 1.0;; widen *= 1.1) {
    const glm::dvec3 cell = glm::dvec3(kCell_m, kLayer_m, kCell_m) * widen;
    const glm::dvec3 cells = glm::ceil(size / cell);
    if ((cells.x + 1.0) * (cells.y + 1.0) * (cells.z + 1.0) > kMostVertices) continue;
    grid.origin_m = box.lower_m;
    for (int axis = 0; axis < 3; ++axis) {
      grid.dims[axis] = int(cells[axis]) + 1;
      grid.spacing_m[axis] = cells[axis] > 0.0 ? size[axis] / cells[axis] : cell[axis];
    }
    break;
  }
  grid.probe.assign(std::size_t(grid.dims.x) * grid.dims.y * grid.dims.z, 0);
  return grid;
}

void fill_cell_table(ProbeGrid& grid, const Coverage& coverage, const std::vector<EyeRay>& rays,
                     const RayScene& triangles) {
  Table(grid, coverage, rays, triangles).fill();
}

}  // namespace probewalk
