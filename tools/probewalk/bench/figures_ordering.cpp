// Chapter 6 of the thesis: which probe a ray asks first, and which then.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <span>

#include "content/baseline/probe_ordering.h"
#include "tools/probewalk/bench/figures.h"
#include "tools/probewalk/bench/svg_plot.h"

namespace probewalk::bench {
namespace {

struct NamedRule {
  int first;
  const char* name;
};
constexpr std::array<NamedRule, 4> kRules{{{kFirstUnsigned, "unsigned cosine"},
                                           {kFirstSigned, "signed cosine"},
                                           {kFirstNearest, "nearest"},
                                           {kFirstSignedLessDistance, "signed less distance"}}};

// Figure 6.1: red, green, blue, white.
constexpr std::array<const char*, 4> kSquareColours{"#d62f2f", "#2f9e44", "#2f62d6", "#ffffff"};
constexpr std::array<const char*, 8> kCubeColours{"#d62f2f", "#e69f00", "#2f9e44", "#b5c900",
                                                  "#2f62d6", "#8e4ec6", "#27b3c4", "#f4a6c8"};

std::string open_picture(double width, double height, std::string_view label) {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" font-family=\"sans-serif\" font-size=\"13\" "
      "role=\"img\" aria-label=\"{}\"><rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>",
      width, height, escaped(label));
}

void write(std::string& svg, double x, double y, const char* anchor, std::string_view text, bool bold = false) {
  fmt::format_to(std::back_inserter(svg), "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>", x, y,
                 anchor, bold ? " font-weight=\"bold\"" : "", escaped(text));
}

// The part of the square [-1, 1]^2 scaled by `size` that directions of the sector point at, as a path around (cx, cy).
std::string sector_path(const OrderSector& sector, double cx, double cy, double size) {
  std::string path = fmt::format("M{:.2f} {:.2f}", cx, cy);
  const auto to_border = [&](double angle) {
    const double c = std::cos(angle), s = std::sin(angle), reach = size / std::max(std::abs(c), std::abs(s));
    fmt::format_to(std::back_inserter(path), "L{:.2f} {:.2f}", cx + reach * c, cy - reach * s);
  };
  to_border(sector.from_rad);
  const double quarter = 0.5 * std::numbers::pi;
  for (double k = std::floor(sector.from_rad / quarter) - 1; (k + 0.5) * quarter < sector.to_rad; k += 1) {
    if ((k + 0.5) * quarter > sector.from_rad) to_border((k + 0.5) * quarter);
  }
  to_border(sector.to_rad);
  return path + "Z";
}

// bands: 1 = the first probe over the whole square; 4 = first to last from inside out.
void draw_square(std::string& svg, int first, glm::dvec2 origin, double cx, double cy, double size, int bands) {
  const std::vector<OrderSector> sectors = square_sectors(first, origin);
  for (int band = bands; band > 0; --band) {
    const auto place = static_cast<std::size_t>(band - 1);
    for (std::size_t k = 0; k < sectors.size(); ++k) {
      OrderSector joined = sectors[k];
      while (k + 1 < sectors.size() && sectors[k + 1].order[place] == joined.order[place])
        joined.to_rad = sectors[++k].to_rad;
      const char* colour = kSquareColours[static_cast<std::size_t>(joined.order[place])];
      // The outline closes the seams that smoothing leaves between neighbours.
      fmt::format_to(std::back_inserter(svg), "<path d=\"{0}\" fill=\"{1}\" stroke=\"{1}\" stroke-width=\"0.5\"/>",
                     sector_path(joined, cx, cy, size * band / bands), colour);
    }
  }
  fmt::format_to(std::back_inserter(svg),
                 "<rect x=\"{0}\" y=\"{1}\" width=\"{2}\" height=\"{2}\" fill=\"none\" stroke=\"#444444\"/>", cx - size,
                 cy - size, 2 * size);
  for (std::size_t k = 0; k < 4; ++k) {
    fmt::format_to(std::back_inserter(svg),
                   "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"6\" fill=\"{}\" stroke=\"#222222\"/>",
                   cx + size * kSquareCorners[k].x, cy - size * kSquareCorners[k].y, kSquareColours[k]);
  }
  fmt::format_to(
      std::back_inserter(svg),
      "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"#222222\" stroke=\"#ffffff\" stroke-width=\"1.5\"/>",
      cx + size * origin.x, cy - size * origin.y);
}

Figure square_figure() {
  constexpr std::array<glm::dvec2, 5> kOrigins{{{0, 0}, {0.25, 0}, {0.5, 0.5}, {0.9, 0.3}, {-0.6, 0.95}}};
  constexpr double kSize = 70, kCell = 180, kLeft = 170, kTop = 50;
  struct Row {
    NamedRule rule;
    int bands;
  };
  const std::array<Row, 6> rows{
      {{kRules[0], 1}, {kRules[1], 1}, {kRules[2], 1}, {kRules[3], 1}, {kRules[0], 4}, {kRules[1], 4}}};
  std::string svg =
      open_picture(kLeft + kCell * kOrigins.size(), kTop + kCell * rows.size(), "probe ordering in the square");
  for (std::size_t column = 0; column < kOrigins.size(); ++column) {
    write(svg, kLeft + kCell * (static_cast<double>(column) + 0.5) - 5, 30, "middle",
          fmt::format("ray from ({:g}, {:g})", kOrigins[column].x, kOrigins[column].y), true);
  }
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const double cy = kTop + kCell * (static_cast<double>(row) + 0.5) - 15;
    write(svg, 10, cy - 6, "start", rows[row].rule.name, true);
    write(svg, 10, cy + 12, "start", rows[row].bands == 1 ? "first probe" : "all four, first inside");
    for (std::size_t column = 0; column < kOrigins.size(); ++column) {
      draw_square(svg, rows[row].rule.first, kOrigins[column], kLeft + kCell * (static_cast<double>(column) + 0.5) - 5,
                  cy, kSize, rows[row].bands);
    }
  }
  return {
      "ordering-square",
      "Which probe first: the square (figure 6.1)",
      {"Four probes stand at the corners of a square of 2 by 2; a ray starts at the black dot. The colour at a place "
       "of the square is that of the probe which a ray in the direction from the square's centre to that place asks "
       "first (so it depends on the angle alone). First row: the thesis's figure 6.1, by the unsigned cosine between "
       "ray and displacement. The lower two rows show the whole order: the inmost square is the first probe, the "
       "outer frame the last.",
       "By the unsigned cosine opposite directions share their probe: half of the rays run towards it. By the signed "
       "one they run away from it, and each probe serves one sector. The nearest does not care for the direction at "
       "all (from the middle all are as near; any may be first). Signed less distance is what the tracer uses: the "
       "cosine less the distance over the cell's diagonal, with corners beyond the cell's middle faded out, so that "
       "walking into the next cell swaps no probe."},
      {svg + "</svg>"},
      ""};
}

// Mollweide's equal-area map of the sphere: y up, longitude from +z over +x. False outside of the ellipse; x and y in
// [-1, 1].
bool mollweide(double x, double y, glm::dvec3& d) {
  if (x * x + y * y > 1) return false;
  const double theta = std::asin(y), latitude = std::asin((2 * theta + std::sin(2 * theta)) / std::numbers::pi);
  const double longitude = std::numbers::pi * x / std::max(std::cos(theta), 1e-9);
  if (std::abs(longitude) > std::numbers::pi) return false;
  d = {std::cos(latitude) * std::sin(longitude), std::sin(latitude), std::cos(latitude) * std::cos(longitude)};
  return true;
}

// A map of the directions, coloured by what `colour_of` says of each; runs of a colour are one rectangle.
template <class ColourOf>
void draw_sphere(std::string& svg, double left, double top, const ColourOf& colour_of) {
  constexpr int kColumns = 220, kRows = 110;
  std::map<std::string, std::string> paths;
  for (int row = 0; row < kRows; ++row) {
    std::string running;
    int from = 0;
    for (int column = 0; column <= kColumns; ++column) {
      glm::dvec3 d;
      std::string colour;
      if (column < kColumns && mollweide(2 * (column + 0.5) / kColumns - 1, 1 - 2 * (row + 0.5) / kRows, d))
        colour = colour_of(d);
      if (colour == running) continue;
      if (!running.empty()) {
        fmt::format_to(std::back_inserter(paths[running]), "M{} {}h{}v1h-{}z", from, row, column - from, column - from);
      }
      running = colour;
      from = column;
    }
  }
  fmt::format_to(std::back_inserter(svg), "<g transform=\"translate({} {})\" shape-rendering=\"crispEdges\">", left,
                 top);
  for (const auto& [colour, path] : paths)
    fmt::format_to(std::back_inserter(svg), "<path fill=\"{}\" d=\"{}\"/>", colour, path);
  svg += "</g>";
}

constexpr double kMapWidth = 220, kMapHeight = 110, kLegendWidth = 150;

// The cube seen from above the corner, each corner in its colour.
void draw_cube_legend(std::string& svg, double left, double top) {
  const auto place = [&](int corner) {
    const double x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
    return glm::dvec2(left + 60 * x - 34 * z + 40, top + 70 - 60 * y + 26 * z);
  };
  for (int a = 0; a < 8; ++a) {
    for (const int bit : {1, 2, 4}) {
      if ((a & bit) != 0) continue;
      fmt::format_to(std::back_inserter(svg), "<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"#999999\"/>",
                     place(a).x, place(a).y, place(a | bit).x, place(a | bit).y);
    }
  }
  for (int k = 0; k < 8; ++k) {
    fmt::format_to(std::back_inserter(svg),
                   "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"9\" fill=\"{}\" stroke=\"#222222\"/>", place(k).x,
                   place(k).y, kCubeColours[static_cast<std::size_t>(k)]);
    write(svg, place(k).x, place(k).y + 4.5, "middle", fmt::format("{}", k));
  }
}

constexpr std::array<glm::dvec3, 4> kCubeOrigins{
    {{0.5, 0.5, 0.5}, {0.5, 0.5, 0.1}, {0.8, 0.7, 0.25}, {0.97, 0.6, 0.45}}};

SelectionRules rules_with(int first, int order) {
  SelectionRules rules = default_rules();
  rules.first = first;
  rules.order = order;
  return rules;
}

Figure cube_first_figure(const CubeOrdering& cube) {
  constexpr double kLeft = 150, kTop = 50, kColumn = 240, kRow = 135;
  std::string svg = open_picture(kLeft + kColumn * kRules.size() + kLegendWidth, kTop + kRow * kCubeOrigins.size(),
                                 "first probe of the cube");
  for (std::size_t column = 0; column < kRules.size(); ++column) {
    write(svg, kLeft + kColumn * static_cast<double>(column) + 0.5 * kMapWidth, 28, "middle", kRules[column].name,
          true);
  }
  draw_cube_legend(svg, kLeft + kColumn * kRules.size() + 10, kTop);
  std::string table =
      "<table><tr><th>ray from</th><th>rule</th><th>mean cosine to the first probe</th><th>largest share of "
      "directions of one probe</th></tr>";
  for (std::size_t row = 0; row < kCubeOrigins.size(); ++row) {
    const glm::dvec3 origin = kCubeOrigins[row];
    const double top = kTop + kRow * static_cast<double>(row);
    write(svg, 10, top + 20, "start", "ray from", true);
    write(svg, 10, top + 38, "start", fmt::format("({:g}, {:g}, {:g})", origin.x, origin.y, origin.z));
    for (std::size_t column = 0; column < kRules.size(); ++column) {
      const SelectionRules rules = rules_with(kRules[column].first, kOrderSorted);
      draw_sphere(svg, kLeft + kColumn * static_cast<double>(column), top, [&](glm::dvec3 d) {
        return std::string(kCubeColours[static_cast<std::size_t>(cube.order(rules, origin, d)[0])]);
      });
      const OrderStatistics statistics = order_statistics(cube, rules, origin, 4000);
      fmt::format_to(std::back_inserter(table),
                     "<tr><td>({:g}, {:g}, {:g})</td><td>{}</td><td>{:.3f}</td><td>{:.0f} %</td></tr>", origin.x,
                     origin.y, origin.z, kRules[column].name, statistics.first_cosine,
                     100 * *std::max_element(statistics.first_share.begin(), statistics.first_share.end()));
    }
  }
  return {
      "ordering-cube-first",
      "Which probe first: the cube",
      {"Eight probes stand at the corners of a cube of 1 m (right: their numbers and colours, x to the right, y up, "
       "z towards the reader). Each oval is the whole sphere of directions in equal areas (Mollweide; the middle is "
       "+z, up is +y, the right half +x), coloured by the probe that a ray in that direction asks first.",
       "By either cosine the border between two probes is a plane through the ray's origin, as the thesis supposes: "
       "the directions that make the same angle with both displacements (unsigned: two planes). By the signed cosine "
       "each probe has one region, around the direction straight away from it; by the unsigned one also the "
       "opposite. From the middle, opposite corners tie there, and rounding decides."},
      {svg + "</svg>"},
      table + "</table>"};
}

// A colour for each of many orders, neighbours in number far apart in hue.
std::string order_colour(std::size_t number) {
  const double hue = std::fmod(static_cast<double>(number) * 137.508, 360.0);
  return fmt::format("hsl({:.0f},{}%,{}%)", hue, 55 + 15 * (number % 3), 42 + 12 * (number / 3 % 4));
}

Figure cube_next_figure(const CubeOrdering& cube) {
  struct Column {
    const char* name;
    int order;
    bool whole;
  };
  constexpr std::array<Column, 4> kColumns{{{"second: corner + 3 mod 8", kOrderPlusThree, false},
                                            {"second: greatest xor", kOrderMaximalXor, false},
                                            {"second: sorted", kOrderSorted, false},
                                            {"whole order: sorted", kOrderSorted, true}}};
  constexpr double kLeft = 150, kTop = 50, kColumn = 240, kRow = 150;
  std::string svg = open_picture(kLeft + kColumn * kColumns.size() + kLegendWidth, kTop + kRow * kCubeOrigins.size(),
                                 "next probes of the cube");
  for (std::size_t column = 0; column < kColumns.size(); ++column) {
    write(svg, kLeft + kColumn * static_cast<double>(column) + 0.5 * kMapWidth, 28, "middle", kColumns[column].name,
          true);
  }
  draw_cube_legend(svg, kLeft + kColumn * kColumns.size() + 10, kTop);
  std::string table =
      "<table><tr><th>ray from</th><th>order</th><th>different orders</th><th>mean angle between first and second "
      "probe, degrees</th><th>mean number of coordinates changed by a step</th></tr>";
  for (std::size_t row = 0; row < kCubeOrigins.size(); ++row) {
    const glm::dvec3 origin = kCubeOrigins[row];
    const double top = kTop + kRow * static_cast<double>(row);
    write(svg, 10, top + 20, "start", "ray from", true);
    write(svg, 10, top + 38, "start", fmt::format("({:g}, {:g}, {:g})", origin.x, origin.y, origin.z));
    for (std::size_t column = 0; column < kColumns.size(); ++column) {
      const SelectionRules rules = rules_with(kFirstSigned, kColumns[column].order);
      const double left = kLeft + kColumn * static_cast<double>(column);
      std::map<std::array<int, 8>, std::size_t> numbers;
      draw_sphere(svg, left, top, [&](glm::dvec3 d) {
        const std::array<int, 8> order = cube.order(rules, origin, d);
        if (!kColumns[column].whole) return std::string(kCubeColours[static_cast<std::size_t>(order[1])]);
        return order_colour(numbers.emplace(order, numbers.size()).first->second);
      });
      if (kColumns[column].whole) {
        write(svg, left + 0.5 * kMapWidth, top + kMapHeight + 16, "middle",
              fmt::format("{} orders in view", numbers.size()));
        continue;
      }
      const OrderStatistics statistics = order_statistics(cube, rules, origin, 8000);
      fmt::format_to(std::back_inserter(table),
                     "<tr><td>({:g}, {:g}, {:g})</td><td>{}</td><td>{}</td><td>{:.0f}</td><td>{:.2f}</td></tr>",
                     origin.x, origin.y, origin.z, kColumns[column].name + 8, statistics.distinct_orders,
                     statistics.second_turn_rad * 180 / std::numbers::pi, statistics.corners_moved);
    }
  }
  return {"ordering-cube-next",
          "Which probe next: the cube",
          {"The same directions when the first probe (by the signed cosine) has failed, coloured by the second one: "
           "corner + 3 mod 8 (5.5), the order with the greatest sum of exclusive ors, and the one with the next best "
           "cosine. Last column: a colour for every whole order that the sort gives. For the two fixed orders the "
           "first probe decides everything, so there are as many orders as there are first probes.",
           "Sorted, the second probe looks from nearly where the first did: the angle between them, seen from the "
           "ray's origin, is the smallest of the three (table). That is the thesis's reason for an order that mixes. "
           "Corner + 3 mod 8 is not the one that mixes most, though it is said to be: its exclusive ors sum to 40 "
           "around the circle; the order used for the second column reaches 50."},
          {svg + "</svg>"},
          table + "</table>"};
}

}  // namespace

std::vector<Figure> ordering_figures() {
  const CubeOrdering cube;
  return {square_figure(), cube_first_figure(cube), cube_next_figure(cube)};
}

}  // namespace probewalk::bench
