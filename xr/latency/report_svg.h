// What the pictures of all reports are drawn with: inline SVG coloured by the page's style.
#pragma once

#include <string>

namespace probewalk {

// A picture with a plot area inside it, in SVG units.
struct SvgPlot {
  double width, height, left, right, top, bottom;
  double x0() const { return left; }
  double x1() const { return width - right; }
  double y0() const { return height - bottom; }
  double y1() const { return top; }
};

// The opening tag; `label` is what readers of screens are told.
std::string open_svg(const SvgPlot& plot, const std::string& label);
// `kind`: classes of the style sheet.
void svg_line(std::string& svg, const std::string& kind, double x0, double y0, double x1, double y1);
void svg_text(std::string& svg, const std::string& kind, double x, double y, const std::string& words);

// A round step that cuts `range` into 3 to 8 parts.
double nice_step(double range);

}  // namespace probewalk
