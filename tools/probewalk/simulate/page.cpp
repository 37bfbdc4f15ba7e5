#include "tools/probewalk/simulate/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "tools/probewalk/bench/svg_plot.h"
#include "xr/latency/report_style.h"
#include "xr/latency/report_text.h"

namespace probewalk::simulation {
namespace {

constexpr std::string_view kColours[] = {bench::kVermilion, bench::kBlue, bench::kGreen, bench::kPurple};
constexpr double kMiB = 1 << 20;

std::string_view colour_of(std::size_t k) {
  return kColours[k % std::size(kColours)];
}

bench::Curve curve_of(const std::string& name, const std::vector<SimulationSample>& samples, std::string_view colour,
                      double (*value)(const SimulationSample&)) {
  bench::Curve curve{.name = name, .points = {}, .colour = colour, .dashed = false, .markers = false};
  for (const SimulationSample& s : samples) curve.points.push_back({s.t_s, value(s)});
  return curve;
}

bench::LinePlot plot(const std::string& title, const std::string& axis) {
  bench::LinePlot result;
  result.title = title;
  result.x.label = "seconds walked";
  result.y.label = axis;
  return result;
}

std::string plots(const PageFacts& facts, const Trial& trial) {
  bench::LinePlot held = plot("On the device", "MiB"), missing = plot("Detail that the view lacks", "octaves"),
                  moved = plot("Moved from the source", "MB");
  double end_s = 0.0;
  for (std::size_t k = 0; k < trial.policies.size(); ++k) {
    const PolicyTrial& p = trial.policies[k];
    held.curves.push_back(curve_of(p.policy, p.samples, colour_of(k),
                                   [](const SimulationSample& s) { return double(s.held_bytes) / kMiB; }));
    missing.curves.push_back(
        curve_of(p.policy, p.samples, colour_of(k), [](const SimulationSample& s) { return s.missing_octaves; }));
    moved.curves.push_back(
        curve_of(p.policy, p.samples, colour_of(k), [](const SimulationSample& s) { return s.bytes_moved * 1e-6; }));
    if (!p.samples.empty()) end_s = std::max(end_s, p.samples.back().t_s);
  }
  if (facts.budget_bytes != kUnlimitedBudget) {
    const double budget = double(facts.budget_bytes) / kMiB;
    held.curves.push_back({"budget", {{0.0, budget}, {end_s, budget}}, bench::kGrey, true, false});
  }
  return bench::line_plot_svg(held) + bench::line_plot_svg(missing) + bench::line_plot_svg(moved);
}

std::string policies(const Trial& trial) {
  std::string html =
      "<div class=\"scroll\"><table class=\"numbers\"><tr><th>policy</th><th>lacks, octaves</th><th>more than the "
      "best</th><th>coarse frames</th><th>longest</th><th>frames with a hole</th><th>with a dark room in view</th><th>need to resident "
      "p50</th><th>p99</th><th>moved</th>"
      "<th>most held</th><th>over budget</th><th>loads</th><th>evictions</th><th>of what was in "
      "view</th><th>failed</th><th>a decision p50</th>"
      "<th>p99</th></tr>\n";
  for (const PolicyTrial& p : trial.policies) {
    fmt::format_to(std::back_inserter(html),
                   "<tr><td>{}</td><td>{:.3f}</td><td>{:.3f}</td><td>{:.2f} %</td><td>{:.2f} s</td><td>{:.2f} "
                   "%</td><td>{:.2f} %</td>"
                   "<td>{:.0f} ms</td><td>{:.0f} ms</td><td>{:.0f} MB</td><td>{:.1f} MiB</td><td>{}</td><td>{}</td>"
                   "<td>{}</td><td>{}</td><td>{}</td><td>{:.1f} µs</td><td>{:.1f} µs</td></tr>\n",
                   html_escaped(p.policy), p.missing_octaves, p.regret_octaves, 100.0 * p.coarse_share,
                   p.coarse_run_max_s, 100.0 * p.hole_share, 100.0 * p.dark_view_share, p.need_p50_s * 1e3,
                   p.need_p99_s * 1e3, p.bytes_moved * 1e-6, double(p.held_bytes_max) / kMiB, p.over_budget_steps,
                   p.loads, p.evictions, p.evictions_in_view, p.failures, p.decide_p50_ns * 1e-3,
                   p.decide_p99_ns * 1e-3);
  }
  return html + "</table></div>\n";
}

}  // namespace

std::string simulation_page(const PageFacts& facts, const Trial& trial) {
  std::string html =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Streaming simulated</title>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<style>";
  html += kReportStyle;
  html += "</style></head>\n<body><main>\n<h1>Streaming simulated</h1>\n<p class=\"soft\">" +
          html_escaped(facts.title) + "</p>\n";
  html += fmt::format(
      "<p>{:.0f} s of walking a policy. “Lacks” is the detail that the view misses against every room's finest level, "
      "in "
      "octaves, averaged over directions and time; no policy could go below {:.3f} with this budget, whatever the "
      "source. A frame is coarse when the walker's room shows less than the policy wants there; a hole is that room "
      "with nothing to "
      "show, dark any room in view.</p>\n",
      trial.simulated_s, trial.bound_octaves);
  html +=
      policies(trial) + "<h2>The first walk</h2>\n" + plots(facts, trial) + "<h2>What was simulated</h2>\n<table>\n";
  for (const auto& [name, value] : facts.facts) {
    html += "<tr><td class=\"soft\">" + html_escaped(name) + "</td><td class=\"words\">" + html_escaped(value) +
            "</td></tr>\n";
  }
  return html + "</table>\n</main></body></html>\n";
}

}  // namespace probewalk::simulation
