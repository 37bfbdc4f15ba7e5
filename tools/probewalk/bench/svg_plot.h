// Curves over axes as a picture of its own (SVG 1.1, light ground, no style sheet): opens anywhere, prints.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace probewalk::bench {

// Colours that the colour-blind can tell apart (Okabe and Ito).
inline constexpr std::string_view kBlack = "#222222", kOrange = "#e69f00", kSkyBlue = "#56b4e9", kGreen = "#009e73",
                                  kYellow = "#c9b700", kBlue = "#0072b2", kVermilion = "#d55e00", kPurple = "#cc79a7",
                                  kGrey = "#888888";

struct Curve {
  std::string name;  // in the legend; "" = not there
  std::vector<glm::dvec2> points;  // points that a logarithmic axis cannot show are left out
  std::string_view colour = kBlack;
  bool dashed = false;  // predictions
  bool markers = true;
};

struct PlotAxis {
  std::string label;  // with the unit
  bool logarithmic = false;
  std::vector<double> ticks;  // none = chosen
  double low = 0.0, high = 0.0;  // equal = chosen from the curves
};

struct LinePlot {
  std::string title;
  PlotAxis x, y;
  std::vector<Curve> curves;
};

std::string line_plot_svg(const LinePlot& plot);

// Text for SVG and HTML.
std::string escaped(std::string_view text);

}  // namespace probewalk::bench
