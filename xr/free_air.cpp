#include "xr/free_air.h"

#include <algorithm>
#include <cmath>

namespace probewalk {
namespace {

constexpr double kSlack = 1.005;  // rounding of coarse maps; at 4 m it is 2 cm of a wall
// Corners of a cell that see farther than this apart see different things.
constexpr float kSameSurface = 1.25f;

}  // namespace

FreeAir::FreeAir(const ProbeGrid& grid, std::size_t probe_count) : grid_(grid), sights_(probe_count) {}

void FreeAir::add(std::uint32_t probe, const DeviceProbe& words) {
  Sight sight;
  sight.position_m = glm::dvec3(words.record.position_hi_m) + glm::dvec3(words.record.position_lo_m);
  sight.n = 1 << words.record.n_log2;
  sight.w.reserve(static_cast<std::size_t>(sight.n + 1) * static_cast<std::size_t>(sight.n + 1));
  for (int j = 0; j <= sight.n; ++j) {
    for (int i = 0; i <= sight.n; ++i) sight.w.push_back(sample_of(words, i, j));
  }
  const std::lock_guard lock(mutex_);
  sights_.at(probe) = std::move(sight);
}

bool FreeAir::sees(const Sight& sight, const glm::dvec3& point_m) {
  const glm::dvec3 d = point_m - sight.position_m;
  const double distance_l1_m = std::abs(d.x) + std::abs(d.y) + std::abs(d.z);
  if (distance_l1_m < 1e-6) return true;
  const glm::dvec2 at = glm::clamp((octahedral_coordinates(d) + 1.0) * (0.5 * sight.n), 0.0, sight.n - 1e-9);
  const auto i = static_cast<std::size_t>(at.x), j = static_cast<std::size_t>(at.y);
  const auto side = static_cast<std::size_t>(sight.n) + 1;
  const float w00 = sight.w[j * side + i], w10 = sight.w[j * side + i + 1];
  const float w01 = sight.w[(j + 1) * side + i], w11 = sight.w[(j + 1) * side + i + 1];
  const auto [least, most] = std::minmax({w00, w10, w01, w11});
  // On a plane w is affine in the map. Across an edge the farther side counts: it blinds nobody.
  const auto fx = static_cast<float>(at.x - std::floor(at.x)), fy = static_cast<float>(at.y - std::floor(at.y));
  const float w = most > kSameSurface * least ? least : glm::mix(glm::mix(w00, w10, fx), glm::mix(w01, w11, fx), fy);
  return distance_l1_m * static_cast<double>(w) <= kSlack;
}

bool FreeAir::is_free(const glm::dvec3& point_m) const {
  const glm::dvec3 last(glm::max(grid_.dims - 2, glm::ivec3(0)));
  const glm::ivec3 cell(glm::clamp(glm::floor((point_m - grid_.origin_m) / grid_.spacing_m), glm::dvec3(0), last));
  const std::lock_guard lock(mutex_);
  bool any_known = false;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 v = glm::min(cell + glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2), grid_.dims - 1);
    const Sight& sight =
        sights_[grid_.probe[static_cast<std::size_t>((v.z * grid_.dims.y + v.y) * grid_.dims.x + v.x)]];
    if (sight.n == 0) continue;
    any_known = true;
    if (sees(sight, point_m)) return true;
  }
  return !any_known;
}

}  // namespace probewalk
