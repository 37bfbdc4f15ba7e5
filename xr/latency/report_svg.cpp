#include "xr/latency/report_svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "xr/latency/report_text.h"

namespace probewalk {

std::string open_svg(const SvgPlot& plot, const std::string& label) {
  return fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">", plot.width, plot.height,
                     html_escaped(label));
}

void svg_line(std::string& svg, const std::string& kind, double x0, double y0, double x1, double y1) {
  fmt::format_to(std::back_inserter(svg), "<line class=\"{}\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>", kind,
                 x0, y0, x1, y1);
}

void svg_text(std::string& svg, const std::string& kind, double x, double y, const std::string& words) {
  fmt::format_to(std::back_inserter(svg), "<text class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", kind, x, y,
                 html_escaped(words));
}

double nice_step(double range) {
  const double rough = std::max(range, 1e-9) / 5.0;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough) return factor * power;
  }
  return 10.0 * power;
}

}  // namespace probewalk
