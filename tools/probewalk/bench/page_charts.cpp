#include "tools/probewalk/bench/page_charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>

#include "tools/probewalk/bench/settings.h"
#include "tools/probewalk/bench/statistics.h"
#include "xr/latency/report_svg.h"
#include "xr/latency/report_text.h"

namespace probewalk::bench {
namespace {

struct Point {
  const BenchRow* row = nullptr;
  double cost = 0.0, error = 0.0;
  bool is_variant = false;  // a setting other than the method's own
  double x = 0.0, y = 0.0;  // in the picture
};

double cost_of(const BenchRow& row, Cost cost) { return cost == Cost::kTime ? row.ns_per_ray_median : row.lookups_mean; }

std::optional<double> error_of(const BenchRow& row, ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kMedian: return row.hit_error_p50;
    case ErrorKind::kFailed: return failed_fraction(row);
    case ErrorKind::kFlip: return row.flip_mean;
  }
  return std::nullopt;
}

const char* error_name(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kMedian: return "median distance error";
    case ErrorKind::kFailed: return "wrong + hole";
    case ErrorKind::kFlip: return "FLIP";
  }
  return "";
}

// Whether the row is the method as it is, at some size: settings begin with that size and say nothing more.
bool is_own_settings(const BenchRow& row) {
  return row.settings == kDefaultSettings || row.settings == fmt::format("resolution {}", row.resolution) ||
         row.settings == fmt::format("maps {}", row.resolution);
}

// Decades of a logarithmic axis that hold all values.
struct LogAxis {
  double low = 1.0, high = 10.0;
  double from = 0.0, to = 1.0;  // in the picture
  bool has_zero = false;        // room for zeros before `low`
  double zero_at = 0.0;

  double at(double value) const {
    if (!(value > 0.0)) return zero_at;
    const double share = (std::log10(value) - std::log10(low)) / (std::log10(high) - std::log10(low));
    return from + std::clamp(share, 0.0, 1.0) * (to - from);
  }
};

// Ends at `most` at the latest.
LogAxis log_axis(const std::vector<double>& values, double from, double to, bool round_to_decades,
                 double most = std::numeric_limits<double>::max()) {
  LogAxis axis;
  double low = std::numeric_limits<double>::max(), high = 0.0;
  for (const double value : values) {
    if (value > 0.0) {
      low = std::min(low, value);
      high = std::max(high, value);
    } else {
      axis.has_zero = true;
    }
  }
  if (!(high > 0.0)) low = high = 1.0;
  const double step = round_to_decades ? 1.0 : 1.0 / 3.0;  // else to 1, 2, 5 or nearly so
  axis.low = std::pow(10.0, std::floor((std::log10(low) - 0.04) / step) * step);
  axis.high = std::pow(10.0, std::ceil((std::log10(high) + 0.04) / step) * step);
  if (high <= most) axis.high = std::min(axis.high, std::max(most, 2.0 * axis.low));
  axis.zero_at = from;
  axis.from = axis.has_zero ? from + 0.09 * (to - from) : from;
  axis.to = to;
  return axis;
}

std::string tick_text(double value) {
  if (value >= 0.01 && value < 1e5) return fmt::format("{:g}", value);
  return fmt::format("1e{}", static_cast<int>(std::lround(std::log10(value))));
}

// A circle for the product, triangles for marches, diamonds for the rest.
std::string mark(const std::string& method, double x, double y, double r) {
  if (method == "oat") return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\"/>", x, y, r);
  if (method == "oat-flat") {
    return fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>", x - r, y - r, 2 * r, 2 * r);
  }
  const double s = 1.25 * r;
  if (is_march(method)) {
    return fmt::format("<polygon points=\"{:.1f},{:.1f} {:.1f},{:.1f} {:.1f},{:.1f}\"/>", x, y - s, x + s, y + 0.8 * s, x - s,
                       y + 0.8 * s);
  }
  return fmt::format("<polygon points=\"{:.1f},{:.1f} {:.1f},{:.1f} {:.1f},{:.1f} {:.1f},{:.1f}\"/>", x, y - s, x + s, y, x,
                     y + s, x - s, y);
}

void draw_ticks(std::string& svg, const SvgPlot& plot, const LogAxis& x, const LogAxis& y) {
  const int x_decades = static_cast<int>(std::lround(std::log10(x.high / x.low)));
  for (int d = static_cast<int>(std::floor(std::log10(x.low) + 1e-9)); std::pow(10.0, d) <= x.high * 1.001; ++d) {
    const double value = std::pow(10.0, d);
    if (value < x.low * 0.999) continue;
    svg_line(svg, "grid", x.at(value), plot.y0(), x.at(value), plot.y1());
    if (x_decades <= 5 || d % 2 == 0) svg_text(svg, "xlabel", x.at(value), plot.y0() + 14, tick_text(value));
  }
  if (x.has_zero) {
    svg_line(svg, "grid", x.zero_at, plot.y0(), x.zero_at, plot.y1());
    svg_text(svg, "xlabel", x.zero_at, plot.y0() + 14, "0");
  }
  const bool fine = y.high / y.low < 200.0;
  for (int d = static_cast<int>(std::floor(std::log10(y.low) - 1e-9)); std::pow(10.0, d) <= y.high * 1.001; ++d) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double value = factor * std::pow(10.0, d);
      if (value < y.low * 0.999 || value > y.high * 1.001 || (factor > 1.0 && !fine)) continue;
      svg_line(svg, "grid", plot.x0(), y.at(value), plot.x1(), y.at(value));
      svg_text(svg, "ylabel", plot.x0() - 5, y.at(value) + 4, tick_text(value));
    }
  }
}

// Names beside a method's first point of its own settings, moved out of each other's way.
void draw_names(std::string& svg, const SvgPlot& plot, const std::vector<Point>& points) {
  struct Box {
    double x0, y0, x1, y1;
  };
  std::vector<Box> taken;
  std::map<std::string, bool> named;
  for (const Point& point : points) {
    if (point.is_variant || named[point.row->method]) continue;
    named[point.row->method] = true;
    const std::string& name = point.row->method;
    const double width = 5.6 * static_cast<double>(name.size());
    for (int attempt = 0; attempt < 10; ++attempt) {
      const bool left = (attempt % 2 == 1) != (point.x + 9 + width > plot.x1());
      const double y = point.y + 4 + 11.0 * ((attempt / 2 + 1) / 2) * ((attempt / 2) % 2 == 0 ? 1 : -1);
      const double x = left ? point.x - 9 - width : point.x + 9;
      const Box box{x, y - 9, x + width, y + 2};
      if (box.x0 < plot.x0() || box.x1 > plot.x1() + 6 || box.y0 < plot.y1() - 4 || box.y1 > plot.y0()) continue;
      const bool free = std::none_of(taken.begin(), taken.end(), [&](const Box& b) {
        return box.x0 < b.x1 && b.x0 < box.x1 && box.y0 < b.y1 && b.y0 < box.y1;
      });
      if (!free) continue;
      taken.push_back(box);
      svg_text(svg, "pointname", x, y, name);
      break;
    }
  }
}

std::string method_class(const std::string& method) { return "m-" + method; }

}  // namespace

std::string pareto_svg(const std::vector<BenchRow>& rows, Cost cost, ErrorKind kind) {
  std::vector<Point> points;
  std::vector<double> costs, errors;
  for (const BenchRow& row : rows) {
    const auto error = error_of(row, kind);
    const double value = cost_of(row, cost);
    if (!error || !(value > 0.0)) continue;
    points.push_back({&row, value, *error, !is_own_settings(row)});
    costs.push_back(value);
    errors.push_back(*error);
  }
  if (points.empty()) return {};
  const SvgPlot plot{380, 300, 44, 14, 32, 40};
  const char* cost_name = cost == Cost::kTime ? "ns a ray" : "look-ups a ray";
  std::string svg = open_svg(plot, fmt::format("{} against {}", cost_name, error_name(kind)));
  svg_text(svg, "title", 10, 17, fmt::format("{} against {}", cost_name, error_name(kind)));
  const LogAxis x = log_axis(errors, plot.x0(), plot.x1(), true, 1.0), y = log_axis(costs, plot.y0(), plot.y1(), false);
  draw_ticks(svg, plot, x, y);
  svg_text(svg, "xlabel", (plot.x0() + plot.x1()) / 2, plot.height - 8, "smaller error to the left, cheaper further down");

  std::vector<CostError> pairs;
  for (Point& point : points) {
    point.x = x.at(point.error);
    point.y = y.at(point.cost);
    pairs.push_back({point.cost, point.error});
  }
  // The front as steps: from the cheapest, each point holds until a more exact one takes over.
  std::string path;
  for (const std::size_t k : pareto_front(pairs)) {
    path += path.empty() ? fmt::format("M{:.1f} {:.1f}", points[k].x, points[k].y)
                         : fmt::format("H{:.1f}V{:.1f}", points[k].x, points[k].y);
  }
  fmt::format_to(std::back_inserter(svg), "<path class=\"front\" d=\"{}\"/>", path);

  std::map<std::string, std::vector<const Point*>> sizes;
  for (const Point& point : points) {
    if (!point.is_variant) sizes[point.row->method].push_back(&point);
  }
  for (auto& [method, own] : sizes) {
    std::sort(own.begin(), own.end(), [](const Point* a, const Point* b) { return a->row->resolution < b->row->resolution; });
    std::string joined;
    for (const Point* point : own) {
      fmt::format_to(std::back_inserter(joined), "{}{:.1f} {:.1f}", joined.empty() ? "M" : "L", point->x, point->y);
    }
    if (own.size() > 1) fmt::format_to(std::back_inserter(svg), "<path class=\"sizes {}\" d=\"{}\"/>", method_class(method), joined);
  }
  for (const bool variants : {true, false}) {
    for (const Point& point : points) {
      if (point.is_variant != variants) continue;
      const BenchRow& row = *point.row;
      const bool is_default = row.settings == kDefaultSettings;
      fmt::format_to(std::back_inserter(svg), "<g class=\"point {}{}{}\">", method_class(row.method), variants ? " variant" : "",
                     is_default ? " default" : "");
      if (cost == Cost::kTime && row.ns_per_ray_spread > 0.0) {
        svg_line(svg, "spread", point.x, y.at(row.ns_per_ray_median + row.ns_per_ray_spread / 2), point.x,
                 y.at(std::max(row.ns_per_ray_median - row.ns_per_ray_spread / 2, y.low)));
      }
      svg += mark(row.method, point.x, point.y, is_default ? 6.0 : variants ? 2.6 : 4.0);
      svg += "<title>" + html_escaped(fmt::format("{}, {}: {:.1f} ns (spread {:.1f}), {:.1f} look-ups, error {:.3g}", row.method,
                                                  row.settings, row.ns_per_ray_median, row.ns_per_ray_spread,
                                                  row.lookups_mean, point.error)) +
             "</title></g>";
    }
  }
  draw_names(svg, plot, points);
  return svg + "</svg>";
}

std::string legend_html(const std::vector<BenchRow>& rows) {
  std::string html = "<p class=\"legend\">";
  std::map<std::string, bool> seen;
  for (const BenchRow& row : rows) {
    if (seen[row.method]) continue;
    seen[row.method] = true;
    html += fmt::format("<span><svg class=\"swatch\" viewBox=\"0 0 14 14\"><g class=\"point {}\">{}</g></svg>{}</span>",
                        method_class(row.method), mark(row.method, 7, 7, 4.5), row.method);
  }
  return html + "<span class=\"soft\">small: other settings of oat; bar: spread of the repetitions; dashed: nothing is both "
                "cheaper and more exact</span></p>\n";
}

const char* const kBenchStyle = R"css(
:root { --oat: #d9550f; --flat: #e39a6c; --env: #8a8f96; --sphere: #a3923c; --box: #6d8a3a; --impostor: #2d9a86; --m3d: #2f86d6;
  --m2d: #3f55c8; --m2h: #7a4fc0; --restart: #b84fa6; --two: #c3262f; }
@media (prefers-color-scheme: dark) { :root { --oat: #ff8a4c; --flat: #c98d68; --env: #9aa0a7; --sphere: #cdbb62; --box: #9dbb66;
  --impostor: #5cc7b3; --m3d: #6cb0f5; --m2d: #8594ff; --m2h: #b48cf0; --restart: #e58ad5; --two: #ff6b70; } }
main { max-width: 1320px; } td { white-space: nowrap; } td.words { white-space: normal; }
.charts.pareto { grid-template-columns: repeat(auto-fit, minmax(350px, 1fr)); }
.m-oat { --c: var(--oat); } .m-oat-flat { --c: var(--flat); } .m-environment { --c: var(--env); }
.m-sphere-proxy { --c: var(--sphere); } .m-box-proxy { --c: var(--box); } .m-impostor { --c: var(--impostor); }
.m-march-3d { --c: var(--m3d); } .m-march-2d { --c: var(--m2d); } .m-march-2d-hierarchical { --c: var(--m2h); }
.m-restart { --c: var(--restart); } .m-two-level { --c: var(--two); }
svg .point { fill: var(--c, var(--ink)); stroke: var(--card); stroke-width: 0.8; } svg .point.variant { opacity: 0.45; }
svg .point.default { stroke: var(--ink); stroke-width: 1.6; } svg .point .spread { stroke: var(--c); stroke-width: 1.2; }
svg path.sizes { stroke: var(--c); stroke-width: 1.2; opacity: 0.6; } svg path.front { stroke: var(--soft); stroke-dasharray: 4 3; }
svg .pointname { fill: var(--ink); font-size: 10px; paint-order: stroke; stroke: var(--card); stroke-width: 3px; }
.legend { max-width: none; } .legend span { margin-right: 16px; white-space: nowrap; font-size: 13px; }
.legend .soft { white-space: normal; } svg.swatch { display: inline-block; width: 14px; height: 14px; border: 0; background: none;
  margin-right: 5px; vertical-align: -2px; }
tr.own td { font-weight: 600; } tr.worse td.words { color: var(--soft); }
.yes { color: var(--good); font-weight: 600; } .no { color: var(--missed); font-weight: 600; }
details { margin: 10px 0; } summary { cursor: pointer; color: var(--soft); } details[open] summary { margin-bottom: 8px; }
.triple { display: grid; grid-template-columns: repeat(3, 1fr); gap: 8px; margin: 4px 0 18px; } .triple img { width: 100%; display: block;
  border: 1px solid var(--rule); border-radius: 6px; image-rendering: auto; } .triple figcaption { font-size: 12px; color: var(--soft); }
.triple figure { margin: 0; } nav a { margin-right: 18px; } a { color: inherit; }
)css";

}  // namespace probewalk::bench
