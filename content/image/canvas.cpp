#include "content/image/canvas.h"

#include <algorithm>
#include <cmath>

namespace probewalk {

Colour mixed(Colour a, Colour b, double share) {
  const auto mix = [share](std::uint8_t from, std::uint8_t to) {
    return static_cast<std::uint8_t>(std::lround(from + (to - from) * share));
  };
  return {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b)};
}

Canvas::Canvas(int width_px, int height_px, Colour ground) {
  image_.width_px = width_px;
  image_.height_px = height_px;
  image_.rgb.resize(std::size_t{3} * static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px));
  rectangle({0, 0}, {width_px, height_px}, ground);
}

void Canvas::set(glm::ivec2 pixel, Colour colour) {
  if (pixel.x < 0 || pixel.y < 0 || pixel.x >= image_.width_px || pixel.y >= image_.height_px) return;
  std::uint8_t* at = image_.rgb.data() + 3 * (std::ptrdiff_t{pixel.y} * image_.width_px + pixel.x);
  at[0] = colour.r;
  at[1] = colour.g;
  at[2] = colour.b;
}

void Canvas::blend(int x, int y, Colour colour, double share) {
  std::uint8_t* at = image_.rgb.data() + 3 * (std::ptrdiff_t{y} * image_.width_px + x);
  const Colour result = mixed({at[0], at[1], at[2]}, colour, share);
  at[0] = result.r;
  at[1] = result.g;
  at[2] = result.b;
}

template <class Inside>
void Canvas::fill(glm::dvec2 lower, glm::dvec2 upper, Colour colour, double opacity, Inside inside) {
  // Not finite or far outside: clamped before it becomes an integer.
  const auto pixel = [](double value, int size) {
    return value > 0.0 ? static_cast<int>(std::min(std::floor(value), static_cast<double>(size))) : 0;
  };
  const int x0 = pixel(lower.x - 1.0, image_.width_px), x1 = pixel(upper.x + 2.0, image_.width_px);
  const int y0 = pixel(lower.y - 1.0, image_.height_px), y1 = pixel(upper.y + 2.0, image_.height_px);
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      const double share = std::min(1.0, 0.5 + inside(glm::dvec2(x + 0.5, y + 0.5)));
      if (share > 0.0) blend(x, y, colour, share * opacity);
    }
  }
}

void Canvas::rectangle(glm::ivec2 lower, glm::ivec2 upper, Colour colour) {
  for (int y = std::max(0, lower.y); y < std::min(upper.y, image_.height_px); ++y) {
    for (int x = std::max(0, lower.x); x < std::min(upper.x, image_.width_px); ++x) set({x, y}, colour);
  }
}

void Canvas::stroke(glm::dvec2 a, glm::dvec2 b, double width_px, Colour colour, double opacity) {
  const glm::dvec2 along = b - a;
  const double length2 = glm::dot(along, along);
  fill(glm::min(a, b) - 0.5 * width_px, glm::max(a, b) + 0.5 * width_px, colour, opacity, [&](glm::dvec2 p) {
    const double t = length2 > 0.0 ? std::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) : 0.0;
    return 0.5 * width_px - glm::distance(p, a + t * along);
  });
}

void Canvas::dashes(glm::dvec2 a, glm::dvec2 b, double width_px, double dash_px, Colour colour) {
  const double length_px = glm::distance(a, b);
  // An odd number, so that both ends are drawn.
  const int pieces = std::max(1, 2 * static_cast<int>(std::min(length_px / (2.0 * dash_px), 1e4)) + 1);
  for (int k = 0; k < pieces; k += 2) {
    stroke(a + (b - a) * (double(k) / pieces), a + (b - a) * (double(k + 1) / pieces), width_px, colour);
  }
}

void Canvas::disc(glm::dvec2 centre, double radius_px, Colour colour, double opacity) {
  fill(centre - radius_px, centre + radius_px, colour, opacity,
       [&](glm::dvec2 p) { return radius_px - glm::distance(p, centre); });
}

void Canvas::ring(glm::dvec2 centre, double radius_px, double width_px, Colour colour) {
  fill(centre - radius_px - width_px, centre + radius_px + width_px, colour, 1.0,
       [&](glm::dvec2 p) { return 0.5 * width_px - std::abs(radius_px - glm::distance(p, centre)); });
}

void Canvas::polygon(std::span<const glm::dvec2> corners, Colour colour) {
  double area = 0.0;
  glm::dvec2 lower(HUGE_VAL), upper(-HUGE_VAL);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const glm::dvec2 a = corners[k], b = corners[(k + 1) % corners.size()];
    area += a.x * b.y - a.y * b.x;
    lower = glm::min(lower, a);
    upper = glm::max(upper, a);
  }
  if (area == 0.0) return;
  fill(lower, upper, colour, 1.0, [&](glm::dvec2 p) {
    double inside = HUGE_VAL;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const glm::dvec2 a = corners[k], edge = corners[(k + 1) % corners.size()] - a;
      const double length = glm::length(edge);
      if (length == 0.0) continue;
      const double across = (edge.x * (p.y - a.y) - edge.y * (p.x - a.x)) / length;
      inside = std::min(inside, area > 0.0 ? across : -across);
    }
    return inside;
  });
}

}  // namespace probewalk
