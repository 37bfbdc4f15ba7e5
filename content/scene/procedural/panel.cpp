#include "content/scene/procedural/panel.h"

#include <algorithm>

namespace probewalk::procedural {
namespace {

constexpr double kProbe_m = 0.12;  // how far in front of a face its room is looked up

std::vector<double> grid_lines(double length, std::vector<double> lines) {
  std::erase_if(lines, [&](double line) { return line <= 1e-6 || line >= length - 1e-6; });
  lines.push_back(0.0), lines.push_back(length);
  std::sort(lines.begin(), lines.end());
  lines.erase(std::unique(lines.begin(), lines.end(), [](double a, double b) { return b - a < 1e-6; }),
              lines.end());
  return lines;
}

}  // namespace

void draw_panel(Brush brush, const Panel& panel) {
  std::vector<double> xs = panel.cuts_x_m, ys = panel.cuts_y_m;
  for (const Opening& o : panel.openings) {
    xs.push_back(o.left_m), xs.push_back(o.right_m);
    ys.push_back(o.bottom_m), ys.push_back(o.top_m);
  }
  xs = grid_lines(panel.width_m, xs), ys = grid_lines(panel.height_m, ys);
  const int columns = static_cast<int>(xs.size()) - 1, rows = static_cast<int>(ys.size()) - 1;
  const auto solid = [&](int i, int j) {
    if (i < 0 || j < 0 || i >= columns || j >= rows) return false;
    const double x = 0.5 * (xs[i] + xs[i + 1]), y = 0.5 * (ys[j] + ys[j + 1]);
    return std::none_of(panel.openings.begin(), panel.openings.end(), [&](const Opening& o) {
      return x > o.left_m && x < o.right_m && y > o.bottom_m && y < o.top_m;
    });
  };
  const double back = -panel.thickness_m;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      if (!solid(i, j)) continue;
      const double x0 = xs[i], x1 = xs[i + 1], y0 = ys[j], y1 = ys[j + 1];
      const glm::dvec3 middle{0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.0};
      brush.quad(panel.material(brush.world(middle + glm::dvec3(0, 0, kProbe_m))), {x0, y0, 0}, {x1, y0, 0},
                 {x1, y1, 0}, {x0, y1, 0});
      brush.quad(panel.material(brush.world(middle + glm::dvec3(0, 0, back - kProbe_m))), {x1, y0, back},
                 {x0, y0, back}, {x0, y1, back}, {x1, y1, back});
      if (!solid(i - 1, j)) brush.quad(panel.edge, {x0, y0, back}, {x0, y0, 0}, {x0, y1, 0}, {x0, y1, back});
      if (!solid(i + 1, j)) brush.quad(panel.edge, {x1, y0, 0}, {x1, y0, back}, {x1, y1, back}, {x1, y1, 0});
      if (!solid(i, j - 1)) brush.quad(panel.edge, {x0, y0, back}, {x1, y0, back}, {x1, y0, 0}, {x0, y0, 0});
      if (!solid(i, j + 1)) brush.quad(panel.edge, {x0, y1, 0}, {x1, y1, 0}, {x1, y1, back}, {x0, y1, back});
    }
  }
}

}  // namespace probewalk::procedural
