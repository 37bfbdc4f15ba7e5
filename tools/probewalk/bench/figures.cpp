#include "tools/probewalk/bench/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <iterator>

#include "content/error.h"
#include "content/image/image.h"
#include "tools/probewalk/bench/svg_plot.h"

namespace probewalk::bench {
namespace {

constexpr const char* kPageHead = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>Probewalk: figures</title><style>
body { font: 16px/1.5 sans-serif; max-width: 1180px; margin: 2em auto; padding: 0 1em; color: #222; background: #fff; }
h1 { font-size: 26px; } h2 { font-size: 20px; margin-top: 2em; } svg { width: 100%; height: auto; border: 1px solid #ddd; }
p { max-width: 52em; } table { border-collapse: collapse; font-size: 14px; margin: 1em 0; }
th, td { border: 1px solid #ddd; padding: 3px 9px; text-align: right; } th { background: #f4f4f4; }
td:first-child, th:first-child { text-align: left; } nav a { margin-right: 1.2em; }
</style></head><body><h1>Figures: which probe, and how many look-ups</h1>
<p>Sources: Sam Donow, Light Probe Selection Algorithms for Real-Time Rendering of Light Fields (2016), chapters 6 and 9. A
look-up is one dependent read of a pyramid's node, a cell with its words, or a map's texel.</p>
)";

std::string page(const std::vector<Figure>& figures) {
  std::string html = kPageHead;
  html += "<nav>";
  for (const Figure& figure : figures) html += fmt::format("<a href=\"#{}\">{}</a>", figure.file, escaped(figure.title));
  html += "</nav>";
  for (const Figure& figure : figures) {
    fmt::format_to(std::back_inserter(html), "<h2 id=\"{}\">{}</h2>", figure.file, escaped(figure.title));
    for (const std::string& paragraph : figure.text) html += "<p>" + escaped(paragraph) + "</p>";
    for (const std::string& svg : figure.svgs) html += svg;
    html += figure.table_html;
  }
  return html + "</body></html>\n";
}

}  // namespace

void write_figures(const std::filesystem::path& folder, const FigureOptions& options, Progress& progress) {
  if (options.greatest_side < 128 || options.greatest_side > 8192 ||
      !std::has_single_bit(static_cast<unsigned>(options.greatest_side))) {
    throw BadUsage(fmt::format("figures of maps up to {} texels a side; give a power of two from 128 to 8192", options.greatest_side));
  }
  if (options.rays < 100) throw BadUsage(fmt::format("figures from {} rays a point; give 100 or more", options.rays));
  if (options.most_per_axis < 2 || options.most_per_axis > 16) {
    throw BadUsage(fmt::format("figures of grids up to {} probes an axis; give 2 to 16", options.most_per_axis));
  }
  std::filesystem::create_directories(folder);
  std::vector<Figure> figures = ordering_figures();
  std::vector<Figure> counted = lookup_figures(folder, options, progress);
  std::move(counted.begin(), counted.end(), std::back_inserter(figures));
  for (const Figure& figure : figures) {
    for (std::size_t k = 0; k < figure.svgs.size(); ++k) {
      const std::string number = figure.svgs.size() > 1 ? fmt::format("-{}", k + 1) : "";
      write_file_atomically(folder / fmt::format("{}{}.svg", figure.file, number), figure.svgs[k]);
    }
  }
  write_file_atomically(folder / "index.html", page(figures));
}

}  // namespace probewalk::bench
