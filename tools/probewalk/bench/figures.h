// The figures of `probewalk bench --figures`: the probe-ordering regions of the thesis's chapter 6, and the predictions of
// its chapter 9 beside what was counted. On procedural scenes and maps of geometry alone; no pack is needed.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "content/progress.h"

namespace probewalk::bench {

struct FigureOptions {
  int rays = 4000;           // a measured point
  int greatest_side = 4096;  // of the maps, 2^k, 128 at least: a probe of 4096^2 takes half a minute on two cores
  int most_per_axis = 8;     // probes along an axis of the densest grid
};

// Writes index.html, which holds everything, and each figure as an SVG beside it. Throws BadUsage for options out of
// range, Interrupted.
void write_figures(const std::filesystem::path& folder, const FigureOptions& options, Progress& progress);

// A finished picture and what is to be seen in it.
struct Figure {
  std::string file;   // without .svg; several pictures are numbered
  std::string title;  // plain text
  std::vector<std::string> text;  // paragraphs of plain text
  std::vector<std::string> svgs;
  std::string table_html;  // "" = none
};

std::vector<Figure> ordering_figures();
std::vector<Figure> lookup_figures(const std::filesystem::path& scratch, const FigureOptions& options, Progress& progress);

}  // namespace probewalk::bench
