#include "render/hidden_tiles.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace probewalk {
namespace {

// Points of the picture at which it is decided what is covered, this far apart. Tiles' corners are among them, and a
// sliver between triangles that is thinner may be overlooked.
constexpr int kStep_px = 2;

struct Points {
  int columns = 0, rows = 0;
  std::vector<std::uint8_t> covered;
};

// Spans by row: inclusive, so that triangles that share an edge leave no gap.
void cover(Points& points, const std::array<glm::dvec2, 3>& corner) {
  double top = 1e300, foot = -1e300;
  for (const glm::dvec2& c : corner) {
    if (!std::isfinite(c.x) || !std::isfinite(c.y)) return;
    top = std::min(top, c.y);
    foot = std::max(foot, c.y);
  }
  constexpr double kSlack = 1e-4;  // of a step: vertices are floats
  const int first = static_cast<int>(std::ceil(std::clamp<double>(top - kSlack, 0.0, points.rows)));
  const int last = static_cast<int>(std::floor(std::clamp<double>(foot + kSlack, -1.0, points.rows - 1.0)));
  for (int row = first; row <= last; ++row) {
    double left = 1e300, right = -1e300;
    for (int k = 0; k < 3; ++k) {
      const glm::dvec2 &a = corner[static_cast<std::size_t>(k)], &b = corner[static_cast<std::size_t>((k + 1) % 3)];
      if (row < std::min(a.y, b.y) - kSlack || row > std::max(a.y, b.y) + kSlack) continue;
      const double y = std::clamp<double>(row, std::min(a.y, b.y), std::max(a.y, b.y));
      if (a.y == b.y) {
        left = std::min({left, a.x, b.x});
        right = std::max({right, a.x, b.x});
        continue;
      }
      const double x = a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y);
      left = std::min(left, x);
      right = std::max(right, x);
    }
    const double from = std::ceil(std::max(left - kSlack, 0.0));
    const double to = std::floor(std::min(right + kSlack, points.columns - 1.0));
    for (double column = from; column <= to; ++column) {
      points.covered[static_cast<std::size_t>(row) * static_cast<std::size_t>(points.columns) +
                     static_cast<std::size_t>(column)] = 1;
    }
  }
}

}  // namespace

std::vector<std::uint8_t> hidden_tiles(const HiddenMesh& mesh, glm::vec4 tan_angles, VkExtent2D extent_px,
                                       int margin_px) {
  const int width = static_cast<int>(extent_px.width), height = static_cast<int>(extent_px.height);
  const int columns = (width + kHiddenTile_px - 1) / kHiddenTile_px;
  const int rows = (height + kHiddenTile_px - 1) / kHiddenTile_px;
  std::vector<std::uint8_t> hidden(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0);
  if (mesh.indices.size() < 3) return hidden;

  Points points{(width + kStep_px - 1) / kStep_px + 1, (height + kStep_px - 1) / kStep_px + 1, {}};
  points.covered.assign(static_cast<std::size_t>(points.columns) * static_cast<std::size_t>(points.rows), 0);
  const glm::dvec2 corner_m(tan_angles.x, tan_angles.z),
      span_m(tan_angles.y - tan_angles.x, tan_angles.w - tan_angles.z);
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    std::array<glm::dvec2, 3> corner;
    bool is_whole = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t index = mesh.indices[i + k];
      is_whole = is_whole && index < mesh.vertices.size();
      if (!is_whole) break;
      corner[k] = (glm::dvec2(mesh.vertices[index]) - corner_m) / span_m * glm::dvec2(width, height) / double(kStep_px);
    }
    if (is_whole) cover(points, corner);
  }

  // Sums over rectangles from the upper left corner, so that a tile asks four of them.
  const auto stride = static_cast<std::size_t>(points.columns) + 1;
  std::vector<std::uint32_t> sum(stride * (static_cast<std::size_t>(points.rows) + 1), 0);
  for (std::size_t y = 0; y < static_cast<std::size_t>(points.rows); ++y) {
    for (std::size_t x = 0; x + 1 < stride; ++x) {
      sum[(y + 1) * stride + x + 1] = sum[y * stride + x + 1] + sum[(y + 1) * stride + x] - sum[y * stride + x] +
                                      points.covered[y * (stride - 1) + x];
    }
  }
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      // Beyond the picture there is nothing that could be seen.
      const auto low = [&](int tile) {
        return static_cast<std::size_t>(std::max(tile * kHiddenTile_px - margin_px, 0) / kStep_px);
      };
      const auto high = [&](int tile, int points_there) {
        const int px = (tile + 1) * kHiddenTile_px + margin_px;
        return static_cast<std::size_t>(std::min((px + kStep_px - 1) / kStep_px + 1, points_there));
      };
      const std::size_t left = low(column), right = high(column, points.columns);
      const std::size_t top = low(row), foot = high(row, points.rows);
      const std::uint32_t covered =
          sum[foot * stride + right] + sum[top * stride + left] - sum[top * stride + right] - sum[foot * stride + left];
      hidden[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column)] =
          covered == (right - left) * (foot - top) ? 1 : 0;
    }
  }
  return hidden;
}

std::vector<std::uint32_t> hidden_tile_words(std::span<const std::vector<std::uint8_t>> views) {
  std::size_t tiles = 0;
  for (const auto& view : views) tiles += view.size();
  std::vector<std::uint32_t> words((tiles + 31) / 32, 0);
  std::size_t at = 0;
  for (const auto& view : views) {
    for (const std::uint8_t hidden : view) {
      words[at / 32] |= static_cast<std::uint32_t>(hidden) << (at % 32);
      ++at;
    }
  }
  return words;
}

}  // namespace probewalk
