#include "tools/probewalk/bench/svg_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace probewalk::bench {
namespace {

constexpr double kWidth = 960, kHeight = 500, kLeft = 74, kRight = 300, kTop = 44, kBottom = 62;

// A round step that cuts `range` into 3 to 8 parts.
double nice_step(double range) {
  const double rough = std::max(range, 1e-12) / 6.0, power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough) return factor * power;
  }
  return 10.0 * power;
}

struct Range {
  double low, high;
  bool logarithmic;
  double part(double value) const {
    if (logarithmic) return std::log(value / low) / std::log(high / low);
    return (value - low) / (high - low);
  }
};

bool shown(const glm::dvec2& point, const LinePlot& plot) {
  return std::isfinite(point.x) && std::isfinite(point.y) && (!plot.x.logarithmic || point.x > 0) &&
         (!plot.y.logarithmic || point.y > 0);
}

Range range_of(const PlotAxis& axis, const LinePlot& plot, int component) {
  if (axis.low < axis.high) return {axis.low, axis.high, axis.logarithmic};
  double low = 1e300, high = -1e300;
  for (const Curve& curve : plot.curves) {
    for (const glm::dvec2& point : curve.points) {
      if (!shown(point, plot)) continue;
      low = std::min(low, point[component]);
      high = std::max(high, point[component]);
    }
  }
  if (low > high) low = 1, high = 2;
  if (axis.logarithmic) {
    if (component == 1) low /= 1.3, high *= 1.3;
    if (!(high > low)) low /= 2, high *= 2;
    return {low, high, true};
  }
  if (component == 1) low = std::min(0.0, low), high += 0.06 * (high - low);
  if (!(high > low)) high = low + 1;
  return {low, high, false};
}

std::vector<double> ticks_of(const PlotAxis& axis, const Range& range) {
  if (!axis.ticks.empty()) return axis.ticks;
  std::vector<double> ticks;
  if (!axis.logarithmic) {
    const double step = nice_step(range.high - range.low);
    for (double k = std::ceil(range.low / step); k * step <= range.high * 1.0000001; k += 1) ticks.push_back(k * step);
    return ticks;
  }
  const bool few = range.high / range.low < 60;
  for (double power = std::pow(10.0, std::floor(std::log10(range.low))); power <= range.high; power *= 10) {
    for (const double digit : {1.0, 2.0, 5.0}) {
      const double tick = digit * power;
      if (tick >= range.low && tick <= range.high && (few || digit == 1.0)) ticks.push_back(tick);
    }
  }
  return ticks;
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      default: out += c;
    }
  }
  return out;
}

std::string line_plot_svg(const LinePlot& plot) {
  const Range x = range_of(plot.x, plot, 0), y = range_of(plot.y, plot, 1);
  const double x0 = kLeft, x1 = kWidth - kRight, y0 = kHeight - kBottom, y1 = kTop;
  const auto px = [&](double v) { return x0 + (x1 - x0) * x.part(v); };
  const auto py = [&](double v) { return y0 + (y1 - y0) * y.part(v); };
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" font-family=\"sans-serif\" font-size=\"13\" "
      "role=\"img\" aria-label=\"{}\"><rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>",
      kWidth, kHeight, escaped(plot.title));
  const auto out = std::back_inserter(svg);
  fmt::format_to(out, "<text x=\"{}\" y=\"24\" font-size=\"16\" font-weight=\"bold\">{}</text>", x0, escaped(plot.title));
  for (const double tick : ticks_of(plot.x, x)) {
    fmt::format_to(out, "<path d=\"M{0:.1f} {1}V{2}\" stroke=\"#e4e4e4\"/><text x=\"{0:.1f}\" y=\"{3}\" text-anchor=\"middle\">{4:g}</text>",
                   px(tick), y0, y1, y0 + 18, tick);
  }
  for (const double tick : ticks_of(plot.y, y)) {
    fmt::format_to(out, "<path d=\"M{1} {0:.1f}H{2}\" stroke=\"#e4e4e4\"/><text x=\"{3}\" y=\"{4:.1f}\" text-anchor=\"end\">{5:g}</text>",
                   py(tick), x0, x1, x0 - 7, py(tick) + 4.5, tick);
  }
  fmt::format_to(out, "<path d=\"M{} {}V{}H{}\" fill=\"none\" stroke=\"#444444\"/>", x0, y1, y0, x1);
  fmt::format_to(out, "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>", 0.5 * (x0 + x1), kHeight - 16, escaped(plot.x.label));
  fmt::format_to(out, "<text transform=\"translate(18 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>", 0.5 * (y0 + y1),
                 escaped(plot.y.label));
  fmt::format_to(out, "<clipPath id=\"area\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></clipPath>", x0 - 5, y1 - 5,
                 x1 - x0 + 10, y0 - y1 + 10);
  double legend_y = y1 + 8;
  for (const Curve& curve : plot.curves) {
    std::string path;
    for (const glm::dvec2& point : curve.points) {
      if (!shown(point, plot)) continue;
      fmt::format_to(std::back_inserter(path), "{}{:.1f} {:.1f}", path.empty() ? "M" : "L", px(point.x), py(point.y));
    }
    const char* dashes = curve.dashed ? " stroke-dasharray=\"6 4\"" : "";
    fmt::format_to(out, "<g clip-path=\"url(#area)\"><path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"{}/>", path,
                   curve.colour, curve.dashed ? 1.6 : 2.2, dashes);
    for (const glm::dvec2& point : curve.points) {
      if (!curve.markers || !shown(point, plot)) continue;
      fmt::format_to(out, "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.4\" fill=\"{}\"/>", px(point.x), py(point.y), curve.colour);
    }
    svg += "</g>";
    if (curve.name.empty()) continue;
    fmt::format_to(out, "<path d=\"M{} {}h30\" stroke=\"{}\" stroke-width=\"2.2\"{}/>", x1 + 20, legend_y - 4.5, curve.colour, dashes);
    if (curve.markers) fmt::format_to(out, "<circle cx=\"{}\" cy=\"{}\" r=\"3.4\" fill=\"{}\"/>", x1 + 35, legend_y - 4.5, curve.colour);
    fmt::format_to(out, "<text x=\"{}\" y=\"{}\">{}</text>", x1 + 58, legend_y, escaped(curve.name));
    legend_y += 21;
  }
  return svg + "</svg>";
}

}  // namespace probewalk::bench
