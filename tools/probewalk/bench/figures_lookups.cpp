// Chapter 9 of the thesis: what it predicts of the number of look-ups, and what was counted.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <fstream>
#include <numbers>
#include <optional>
#include <span>

#include "content/baseline/lookup_study.h"
#include "content/baseline/lookup_theory.h"
#include "content/error.h"
#include "content/scene/procedural/procedural.h"
#include "tools/probewalk/bench/figures.h"
#include "tools/probewalk/bench/svg_plot.h"

namespace probewalk::bench {
namespace {

struct DrawnMethod {
  const char* name;
  std::string_view colour;
};
constexpr std::array<DrawnMethod, 6> kDrawn{{{"march-3d", kOrange},
                                             {"march-2d", kVermilion},
                                             {"march-2d-hierarchical", kPurple},
                                             {"two-level", kGreen},
                                             {"oat-flat", kSkyBlue},
                                             {"oat", kBlue}}};
constexpr const char* kRoom = "box-room";
// The coarsest nodes of march-2d-hierarchical are the map's side over 2^4 (shaders/shared/baseline_marches.h).
constexpr int kNodesBelowMap = 4;

std::string degrees(double rad) {
  return fmt::format("{:.0f}", rad * 180 / std::numbers::pi);
}

StudyScene load_study_scene(const std::filesystem::path& scratch, const std::string& name) {
  const std::filesystem::path file = scratch / fmt::format(".{}.glb", name);
  const std::vector<std::byte> bytes = make_procedural_glb(name);
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  Scene scene = load_scene(file);
  std::filesystem::remove(file);
  return StudyScene(std::move(scene));
}

// A place in the room from which most of it is seen, off every symmetry.
glm::dvec3 probe_place(const StudyScene& scene) {
  return glm::mix(scene.bounds().lower_m, scene.bounds().upper_m, glm::dvec3(0.543, 0.612, 0.457));
}

double mean_lookups(const OneProbe& probe, const TracerChoice& choice, std::span<const StudyRay> rays,
                    std::optional<int> start_level = {}) {
  double sum = 0.0;
  for (const StudyRay& ray : rays) sum += probe.walk(choice, ray, start_level).lookups;
  return sum / static_cast<double>(rays.size());
}

Figure resolution_figure(const StudyScene& room, const FigureOptions& options, Progress& progress) {
  const glm::dvec3 place_m = probe_place(room);
  const std::vector<StudyRay> rays = rays_seen_by(room, std::span(&place_m, 1), options.rays);
  std::array<std::vector<double>, kDrawn.size()> means;
  std::vector<double> sides, flat, hierarchical, ticks, raised;
  for (int side = 128; side <= options.greatest_side; side *= 2) {
    const OneProbe probe(room, place_m, side, progress);
    sides.push_back(side);
    flat.push_back(flat_shape(side));
    hierarchical.push_back(hierarchical_shape(side, 0.0));
    ticks.push_back(side);
    for (std::size_t k = 0; k < kDrawn.size(); ++k)
      means[k].push_back(mean_lookups(probe, choice_of(kDrawn[k].name), rays));
    raised.push_back(
        mean_lookups(probe, choice_of("oat"), rays, std::bit_width(static_cast<unsigned>(side)) - 1 - kNodesBelowMap));
  }
  LinePlot plot{"Look-ups of a ray through one probe, by the map's resolution",
                {"texels along a side of the probe's map", true, ticks},
                {"look-ups per ray, mean (logarithmic)", true, {}},
                {}};
  const auto curve_of = [&](const std::vector<double>& values, double factor) {
    std::vector<glm::dvec2> points;
    for (std::size_t i = 0; i < sides.size(); ++i) points.emplace_back(sides[i], factor * values[i]);
    return points;
  };
  constexpr const char* kRaised = "oat, first look by the side / 16";
  const auto row_of = [&](const char* name, const std::vector<double>& values) {
    std::string row = fmt::format("<tr><td>{}</td>", name);
    for (const double value : values) row += fmt::format("<td>{:.1f}</td>", value);
    return row + fmt::format("<td>{}</td></tr>",
                             sides.size() > 1 ? fmt::format("{:.2f}", growth_exponent(flat, values)) : "");
  };
  std::string table = "<table><tr><th>method</th>";
  for (const double side : sides) table += fmt::format("<th>{:g}²</th>", side);
  table += "<th>growth: exponent of the side</th></tr>";
  for (std::size_t k = 0; k < kDrawn.size(); ++k) {
    plot.curves.push_back({kDrawn[k].name, curve_of(means[k], 1.0), kDrawn[k].colour});
    table += row_of(kDrawn[k].name, means[k]);
  }
  plot.curves.push_back({kRaised, curve_of(raised, 1.0), kBlack});
  table += row_of(kRaised, raised);
  const double flat_factor = fitted_factor(flat, means[1]);
  const double nodes_factor = fitted_factor(hierarchical, means[2]);
  plot.curves.push_back(
      {fmt::format("thesis: sqrt r, times {:.3f}", flat_factor), curve_of(flat, flat_factor), kVermilion, true, false});
  plot.curves.push_back({fmt::format("thesis: log r, times {:.2f}", 0.5 * nodes_factor),
                         curve_of(hierarchical, nodes_factor), kPurple, true, false});
  return {
      "lookups-resolution",
      "Look-ups against resolution",
      {fmt::format(
           "One probe in a plain room of 4 by 2.6 by 4 m with a block in it, {} rays from points that the probe "
           "sees, in all directions alike; each method's walk alone, without selection. r is the number of texels, "
           "side times side. Dashed: growth as the thesis predicts it; it gives no constants, so one factor a curve "
           "is fitted.",
           rays.size()),
       "Texel by texel the number grows with the side, as predicted (exponent 1). By nodes of a pyramid it grows by "
       "the logarithm, as 9.1 says of the worst case, if the coarsest nodes grow with the map: "
       "march-2d-hierarchical's are the side over 16. Two-level's are 16 texels and the product's 32 cells wide, so "
       "on the largest maps these are crossed one by one; the black curve is the product when it first looks at "
       "nodes of the side over 16. It hardly grows: walls are met as planes of whole nodes, which a finer map only "
       "makes wider. Steps in space do not know the resolution, and are without bound: their number is the ray's "
       "length over the step."},
      {line_plot_svg(plot)},
      table + "</table>"};
}

Figure angle_figure(const StudyScene& room, const FigureOptions& options, Progress& progress) {
  constexpr int kBins = 18;
  const int side = std::min(1024, options.greatest_side);
  const glm::dvec3 place_m = probe_place(room);
  const std::vector<StudyRay> rays = rays_seen_by(room, std::span(&place_m, 1), 4 * options.rays);
  const OneProbe probe(room, place_m, side, progress);
  std::vector<TracerChoice> choices;
  for (const DrawnMethod& method : kDrawn) choices.push_back(choice_of(method.name));
  std::vector<double> middles_rad, swept;
  std::array<std::vector<double>, kDrawn.size()> means;
  std::array<int, kBins> count{};
  std::array<std::array<double, kBins>, kDrawn.size()> sums{};
  std::array<double, kBins> swept_sums{};
  for (const StudyRay& ray : rays) {
    const double angle = displacement_angle_rad(ray, place_m);
    const auto bin = static_cast<std::size_t>(std::min(kBins - 1, static_cast<int>(angle / std::numbers::pi * kBins)));
    ++count[bin];
    for (std::size_t k = 0; k < kDrawn.size(); ++k) sums[k][bin] += probe.walk(choices[k], ray).lookups;
    // What the ray sweeps until the march ends: the angle at the probe between where it starts and where it ends.
    const Walk walk = probe.walk(choices[1], ray);
    const glm::dvec3 start = ray.origin_m - place_m, end = start + ray.direction * std::min(walk.t_m, 1e6);
    swept_sums[bin] += std::atan2(glm::length(glm::cross(start, end)), glm::dot(start, end));
  }
  LinePlot plot{fmt::format("Look-ups of a ray through one probe of {0}², by its angle", side),
                {"angle between the displacement from the probe and the ray, degrees",
                 false,
                 {0, 30, 60, 90, 120, 150, 180},
                 0,
                 180},
                {"look-ups per ray, mean (logarithmic)", true, {}},
                {}};
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    if (count[bin] < 5) continue;
    middles_rad.push_back((static_cast<double>(bin) + 0.5) * std::numbers::pi / kBins);
    swept.push_back(swept_sums[bin] / count[bin]);
    for (std::size_t k = 0; k < kDrawn.size(); ++k) means[k].push_back(sums[k][bin] / count[bin]);
  }
  const auto curve_of = [&](const auto& value_of) {
    std::vector<glm::dvec2> points;
    for (std::size_t i = 0; i < middles_rad.size(); ++i)
      points.emplace_back(middles_rad[i] * 180 / std::numbers::pi, value_of(i));
    return points;
  };
  for (std::size_t k = 0; k < kDrawn.size(); ++k) {
    plot.curves.push_back({kDrawn[k].name, curve_of([&](std::size_t i) { return means[k][i]; }), kDrawn[k].colour});
  }
  std::vector<double> nodes;
  for (const double angle : middles_rad) nodes.push_back(hierarchical_shape(side, angle));
  const double swept_factor = fitted_factor(swept, means[1]);
  const double nodes_factor = fitted_factor(nodes, means[2]), oat_factor = fitted_factor(nodes, means[5]);
  plot.curves.push_back({"most that a march can read",
                         curve_of([&](std::size_t i) { return most_texels_crossed(side, middles_rad[i]); }), kGrey,
                         true, false});
  plot.curves.push_back({fmt::format("angle swept up to the hit, times {:.0f}", swept_factor),
                         curve_of([&](std::size_t i) { return swept_factor * swept[i]; }), kVermilion, true, false});
  plot.curves.push_back({fmt::format("thesis: log r (1 + angle), times {:.2f}", 0.5 * nodes_factor),
                         curve_of([&](std::size_t i) { return nodes_factor * nodes[i]; }), kPurple, true, false});
  plot.curves.push_back({fmt::format("log r (1 + angle), times {:.2f}", 0.5 * oat_factor),
                         curve_of([&](std::size_t i) { return oat_factor * nodes[i]; }), kBlue, true, false});
  return {
      "lookups-angle",
      "Look-ups against the angle between ray and displacement",
      {fmt::format("The same room, {} rays. At 0 degrees the ray runs straight away from the probe: it stays in one "
                   "texel, one look-up is exact (4.3). At 180 it runs towards the probe and past it. The grey line "
                   "is no fit: a ray sweeps at most the angle drawn, and that many texels at most lie on its way.",
                   rays.size()),
       fmt::format(
           "Texel by texel the number is proportional to the angle that the ray really sweeps before it hits "
           "something (dashed, one fitted factor, {:.2f} a texel's side): {:.0f} look-ups at 5 degrees, {:.0f} at "
           "175. For a trace by nodes the thesis's log r (1 + angle) is drawn, with one fitted factor each: "
           "march-2d-hierarchical takes {:.1f} to {:.1f}, the product {:.1f} to {:.1f}. The product passes what lies "
           "inside the empty octahedron around a probe without a look, so rays right past the probe, the thesis's "
           "worst case, are among its cheap ones.",
           swept_factor / side, means[1].front(), means[1].back(), means[2].front(),
           *std::max_element(means[2].begin(), means[2].end()), means[5].front(),
           *std::max_element(means[5].begin(), means[5].end()))},
      {line_plot_svg(plot)},
      ""};
}

Figure probes_figure(const StudyScene& room, const FigureOptions& options, Progress& progress) {
  const int side = std::min(256, options.greatest_side);
  constexpr std::array<const char*, 3> kMethods{"march-2d", "march-2d-hierarchical", "oat"};
  constexpr std::array<std::string_view, 3> kColours{kVermilion, kPurple, kBlue};
  std::array<std::vector<glm::dvec2>, 3> by_cell, by_best;
  std::vector<double> ticks;
  std::string table =
      "<table><tr><th>probes</th><th>angle to the probe that answers, of the cell, degrees</th><th>of "
      "all</th><th>march-2d, of the cell</th><th>of all</th><th>rays of one look-up, of all</th></tr>";
  for (int per_axis = 1; per_axis <= options.most_per_axis; ++per_axis) {
    const ProbeLattice lattice = lattice_in(room, per_axis);
    const std::vector<StudyRay> rays = rays_seen_by(room, lattice.positions_m, options.rays / 2);
    const ManyProbes probes(room, lattice, side, progress);
    const auto count = static_cast<double>(lattice.positions_m.size());
    if (per_axis != 7) ticks.push_back(count);
    for (std::size_t k = 0; k < kMethods.size(); ++k) {
      TracerChoice choice = choice_of(kMethods[k]);
      choice.rules.first = kFirstSigned;
      const ManyProbes::Count cell = probes.by_cell(choice, rays), best = probes.by_best_of_all(choice, rays);
      by_cell[k].emplace_back(count, cell.lookups_mean);
      by_best[k].emplace_back(count, best.lookups_mean);
      if (k != 0) continue;
      table +=
          fmt::format("<tr><td>{:g}</td><td>{}</td><td>{}</td><td>{:.1f}</td><td>{:.1f}</td><td>{:.1f} %</td></tr>",
                      count, degrees(cell.angle_mean_rad), degrees(best.angle_mean_rad), cell.lookups_mean,
                      best.lookups_mean, 100 * best.one_lookup_share);
    }
  }
  LinePlot plot{fmt::format("Look-ups of a ray, by the number of probes of {0}² in the room", side),
                {"probes in the room", true, ticks},
                {"look-ups per ray, mean (logarithmic)", true, {1, 2, 5, 10, 20, 50, 100, 200}},
                {}};
  for (std::size_t k = 0; k < kMethods.size(); ++k) {
    plot.curves.push_back({fmt::format("{}, best of all", kMethods[k]), by_best[k], kColours[k]});
    plot.curves.push_back({fmt::format("{}, of the cell", kMethods[k]), by_cell[k], kColours[k], true, true});
  }
  plot.curves.push_back(
      {"thesis: the limit, one look-up", {{ticks.front(), 1}, {ticks.back(), 1}}, kGrey, true, false});
  return {
      "lookups-probes",
      "Look-ups against the number of probes",
      {fmt::format(
           "Regular grids of 1 to {} probes along an axis in the same room. Solid: the first probe is, of all that "
           "see the ray's origin, the one that the ray runs most nearly straight away from, which is what 9.1 "
           "supposes. Dashed with dots: the best of the eight of the origin's cell, which is what the thesis's "
           "algorithm does (5.5), by the signed cosine.",
           options.most_per_axis),
       fmt::format(
           "With the best of all, the angle falls with every probe that is added, and with it the number of look-ups "
           "towards one, as the thesis says, if slowly: texel by texel {:.0f} with {:g} probe, {:.0f} with {:g}. "
           "With the best of the cell it does not go on falling ({:.0f}): a denser grid is the same cell made "
           "smaller, so the angle settles. What a trace by nodes still gains there is that the ray sweeps it within "
           "a smaller part of the empty space around the probe.",
           by_best[0].front().y, by_best[0].front().x, by_best[0].back().y, by_best[0].back().x, by_cell[0].back().y)},
      {line_plot_svg(plot)},
      table + "</table>"};
}

Figure failures_figure(const std::filesystem::path& scratch, const FigureOptions& options, Progress& progress) {
  struct Place {
    const char* scene;
    const char* words;
    std::string_view colour;
  };
  constexpr std::array<Place, 3> kPlaces{{{"two-rooms", "two furnished rooms", kGreen},
                                          {"lattice", "two grilles of 2 cm bars", kVermilion},
                                          {"grove", "foliage", kPurple}}};
  constexpr std::array<const char*, 2> kMethods{"march-2d-hierarchical", "oat"};
  const int side = std::min(512, options.greatest_side);
  LinePlot shares{fmt::format("How many probes of {0}² a ray is walked through", side),
                  {"probes walked through (8: eight and more)", false, {1, 2, 3, 4, 5, 6, 7, 8}, 1, 8},
                  {"share of rays, % (logarithmic)", true, {0.01, 0.1, 1, 10, 100}, 0.01, 110},
                  {}};
  std::string table =
      "<table><tr><th>scene</th><th>method</th><th>probes a ray</th><th>look-ups a ray</th><th>no answer</th></tr>";
  LinePlot costs{"What a failure costs",
                 {"probes walked through (8: eight and more)", false, {1, 2, 3, 4, 5, 6, 7, 8}, 1, 8},
                 {"look-ups per ray, mean", false, {}},
                 {}};
  for (const Place& place : kPlaces) {
    const StudyScene scene = load_study_scene(scratch, place.scene);
    const ProbeLattice lattice = lattice_in(scene, 3);
    const std::vector<StudyRay> rays = rays_seen_by(scene, lattice.positions_m, options.rays);
    const ManyProbes probes(scene, lattice, side, progress);
    for (const char* method : kMethods) {
      const bool product = std::string_view(method) == "oat";
      const ManyProbes::Count count = probes.by_cell(choice_of(method), rays);
      Curve share{fmt::format("{}, {}", place.words, method), {}, place.colour, !product, true}, cost = share,
                                                                                                 predicted;
      double tries = 0.0;
      for (std::size_t k = 1; k < count.share_by_tries.size(); ++k) {
        tries += static_cast<double>(k) * count.share_by_tries[k];
        share.points.emplace_back(k, 100 * count.share_by_tries[k]);
        if (count.share_by_tries[k] * options.rays < 8) continue;
        cost.points.emplace_back(k, count.lookups_by_tries[k]);
      }
      shares.curves.push_back(share);
      costs.curves.push_back(cost);
      table += fmt::format("<tr><td>{}</td><td>{}</td><td>{:.2f}</td><td>{:.1f}</td><td>{:.1f} %</td></tr>",
                           place.words, method, tries, count.lookups_mean, 100 * count.unknown_share);
    }
  }
  // k probes, each as dear as the first: the thesis's product, from the mean of a method's first points.
  for (std::size_t method = 0; method < kMethods.size(); ++method) {
    double first = 0.0;
    for (std::size_t k = method; k < costs.curves.size() && k < kMethods.size() * kPlaces.size();
         k += kMethods.size()) {
      if (!costs.curves[k].points.empty()) first += costs.curves[k].points.front().y / kPlaces.size();
    }
    Curve product{fmt::format("thesis: k times {:.1f} ({})", first, kMethods[method]),
                  {},
                  method == 0 ? kGrey : kBlack,
                  true,
                  false};
    for (int k = 1; k <= 8; ++k) product.points.emplace_back(k, k * first);
    costs.curves.push_back(product);
  }
  return {
      "failures",
      "Partial failures per ray",
      {fmt::format(
           "Grids of 3 by 3 by 3 probes in three scenes, {} rays each. A ray is walked through one probe after the "
           "other until one answers: a walk that ends where the probe's knowledge does is a partial failure, k in "
           "9.1. Solid: the product. Dashed: the thesis's march by nodes with its own selection (eight probes of the "
           "origin's cell, corner + 3 mod 8).",
           options.rays),
       "The thesis bounds the number of look-ups by the number of probes times that of one walk (straight lines, "
       "with the mean of each method's first walks). The march by nodes is near its line for the first failures and "
       "falls below it: a walk that fails has ended early, and the next one goes on from there. The product is above "
       "its line: most rays meet a wall that is one plane and are done after a few looks, but rays that fail run "
       "among thin things, where its walks go down to the cells, and every further probe is first tested for whether "
       "it sees the point reached. It fails less often for that, and leaves fewer rays without an answer (table)."},
      {line_plot_svg(shares), line_plot_svg(costs)},
      table + "</table>"};
}

}  // namespace

std::vector<Figure> lookup_figures(const std::filesystem::path& scratch, const FigureOptions& options,
                                   Progress& progress) {
  const StudyScene room = load_study_scene(scratch, kRoom);
  std::vector<Figure> figures;
  figures.push_back(resolution_figure(room, options, progress));
  figures.push_back(angle_figure(room, options, progress));
  figures.push_back(probes_figure(room, options, progress));
  figures.push_back(failures_figure(scratch, options, progress));
  return figures;
}

}  // namespace probewalk::bench
