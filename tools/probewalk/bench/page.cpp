#include "tools/probewalk/bench/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "tools/probewalk/bench/equal_error.h"
#include "tools/probewalk/bench/page_charts.h"
#include "tools/probewalk/bench/page_text.h"
#include "xr/latency/report_style.h"
#include "xr/latency/report_text.h"

namespace probewalk::bench {
namespace {

template <typename... Args>
void add(std::string& html, fmt::format_string<Args...> format, Args&&... args) {
  fmt::format_to(std::back_inserter(html), format, std::forward<Args>(args)...);
}

std::string anchor(const std::string& name) {
  std::string id = "scene-";
  for (const char c : name) id += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '-';
  return id;
}

const char* verdict_cell(Verdict verdict) {
  switch (verdict) {
    case Verdict::kReached: return "<span class=\"yes\">reached</span>";
    case Verdict::kNotReached: return "<span class=\"no\">not reached</span>";
    case Verdict::kNotMeasured: break;
  }
  return "<span class=\"soft\">not measured</span>";
}

std::string goals_table(const std::vector<SceneReport>& scenes) {
  std::string html =
      "<div class=\"scroll\"><table><tr><th>scene</th><th class=\"words\">aim</th><th class=\"words\">measured</th>"
      "<th class=\"words\">verdict</th></tr>\n";
  std::size_t reached = 0, measured = 0;
  for (const SceneReport& scene : scenes) {
    for (const Goal& goal : goals_of(scene)) {
      add(html, "<tr><td>{}</td><td class=\"words\">{}</td><td class=\"words\">{}</td><td class=\"words\">{}</td></tr>\n",
          html_escaped(goal.scene), html_escaped(goal.aim), html_escaped(goal.result), verdict_cell(goal.verdict));
      reached += goal.verdict == Verdict::kReached;
      measured += goal.verdict != Verdict::kNotMeasured;
    }
  }
  return fmt::format("<p>Of the aims that this run could judge, {} of {} were reached. Factors of time are ratios within one "
                     "repetition on the same device, so that what else the machine does falls on both sides.</p>\n",
                     reached, measured) + html + "</table></div>\n";
}

// A header row of the methods' table; the cells of row_cells in the same order.
constexpr const char* kRowHeader =
    "<th>ns a ray</th><th>time / oat</th><th>look-ups</th><th>p99</th><th>reads at hit</th><th>probes</th><th>error p50</th>"
    "<th>p95</th><th>p99</th><th>tracer max</th><th>wrong</th><th>hole</th><th>NaN</th><th>FLIP</th><th>PSNR dB</th>"
    "<th>device</th>";

std::string row_cells(const BenchRow& row) {
  std::string html;
  const auto cell = [&](const std::string& text) { add(html, "<td>{}</td>", text); };
  cell(time_text(row));
  cell(row.time_ratio ? fmt::format("{:.2f} ± {:.2f}", *row.time_ratio, row.time_ratio_spread.value_or(0.0) / 2.0) : "–");
  cell(fmt::format("{:.1f}", row.lookups_mean));
  cell(fmt::format("{:.0f}", row.lookups_p99));
  cell(fmt::format("{:.1f}", row.attribute_reads_mean));
  cell(fmt::format("{:.2f}", row.probes_mean));
  cell(error_text(row.hit_error_p50));
  cell(error_text(row.hit_error_p95));
  cell(error_text(row.hit_error_p99));
  cell(error_text(row.tracer_error_max));
  cell(share_text(row.wrong_surface_fraction));
  cell(share_text(row.hole_fraction));
  cell(fmt::format("{}", row.nan_count));
  cell(row.flip_mean ? fmt::format("{:.4f}", *row.flip_mean) : "–");
  cell(number_text(row.psnr_db, 2));
  cell(in_bytes(row.bytes_device));
  return html;
}

// A row a method: the product's default, of the others the first, which by default is of the product's resolution.
std::string methods_table(const SceneReport& report) {
  const BenchRow* product = report.default_row();
  std::string html = std::string("<div class=\"scroll\"><table><tr><th>method</th><th class=\"words\">settings</th>") +
                     "<th>ns a ray</th><th>look-ups</th><th>error p50</th><th>wrong</th><th>hole</th><th>FLIP</th>"
                     "<th class=\"words\">beside oat</th></tr>\n";
  std::vector<std::string> told;
  for (const BenchRow& row : report.rows) {
    if (std::find(told.begin(), told.end(), row.method) != told.end()) continue;
    told.push_back(row.method);
    add(html, "<tr{}><td>{}</td><td class=\"words\">{}</td><td>{}</td><td>{:.1f}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>"
              "<td class=\"words\">{}</td></tr>\n",
        row.settings == kDefaultSettings ? " class=\"own\"" : "", row.method, html_escaped(row.settings), time_text(row),
        row.lookups_mean, error_text(row.hit_error_p50), share_text(row.wrong_surface_fraction), share_text(row.hole_fraction),
        row.flip_mean ? fmt::format("{:.4f}", *row.flip_mean) : "–", product != nullptr ? beside_product(row, *product) : "");
  }
  return html + "</table></div>\n";
}

std::string all_rows(const SceneReport& report) {
  std::string html = fmt::format("<details><summary>All {} rows of this scene</summary>\n<div class=\"scroll\"><table><tr><th>method"
                                 "</th><th class=\"words\">settings</th>{}</tr>\n", report.rows.size(), kRowHeader);
  for (const BenchRow& row : report.rows) {
    add(html, "<tr{}><td>{}</td><td class=\"words\">{}</td>{}</tr>\n", row.settings == kDefaultSettings ? " class=\"own\"" : "",
        row.method, html_escaped(row.settings), row_cells(row));
  }
  return html + "</table></div></details>\n";
}

std::string equal_error_table(const SceneReport& report) {
  const std::vector<EqualError> all = equal_errors(report.rows);
  if (all.empty()) return {};
  std::string html =
      "<h3>At equal error</h3>\n<p class=\"soft\">Each march beside oat where both err alike. Where a march does not get as good "
      "as oat's default with any of the maps measured, its own best is taken, and beside it the cheapest setting of oat that is "
      "at least as good.</p>\n<div class=\"scroll\"><table><tr><th>march</th><th class=\"words\">equal in</th><th>error of both</th>"
      "<th class=\"words\">where</th><th>oat is faster by</th></tr>\n";
  for (const EqualError& equal : all) {
    add(html, "<tr><td>{}</td><td class=\"words\">{}</td><td>{}</td><td class=\"words\">{}</td><td>{:.2f} ×</td></tr>\n", equal.march,
        equal.by == EqualBy::kMedian ? "median distance error" : "wrong + hole",
        equal.by == EqualBy::kMedian ? error_text(equal.error) : share_text(equal.error),
        equal.reached ? "at oat's default" : fmt::format("at the march's best, maps of {}; it never gets as good as oat", equal.march_size),
        equal.speed_ratio);
  }
  return html + "</table></div>\n";
}

std::string accelerations_table(const SceneReport& report) {
  if (report.accelerations.empty()) return {};
  std::string html =
      "<h3>Each acceleration alone</h3>\n<div class=\"scroll\"><table><tr><th>acceleration</th><th>look-ups before</th><th>after</th>"
      "<th>probes before</th><th>after</th><th>time</th><th>identical</th><th>class changes</th><th>worst change of distance</th>"
      "<th>wrong + hole before</th><th>after</th><th class=\"words\">answers</th></tr>\n";
  for (const AccelerationResult& r : report.accelerations) {
    add(html, "<tr><td title=\"{}\">{}</td><td>{:.1f}</td><td>{:.1f}</td><td>{:.2f}</td><td>{:.2f}</td><td>{:.2f} ± {:.2f} ×</td><td>{}</td>"
              "<td>{}</td><td>{}</td><td>{}</td><td>{}</td><td class=\"words\">{}</td></tr>\n",
        html_escaped(r.acceleration.what), r.acceleration.name, r.without.lookups_mean, r.with.lookups_mean, r.without.probes_mean,
        r.with.probes_mean, r.time_ratio, r.time_ratio_spread / 2.0, share_text(r.identity.identical_fraction),
        r.identity.class_changes, error_text(r.identity.worst_distance_change), share_text(failed_fraction(r.without)),
        share_text(failed_fraction(r.with)), identity_in_words(r));
  }
  html += "</table></div>\n<p class=\"soft\">";
  for (const AccelerationResult& r : report.accelerations) add(html, "<b>{}</b>: {} ", r.acceleration.name, html_escaped(r.acceleration.what));
  return html + "Identical: share of rays with the same class, probe and distance, bit for bit. Time: after over before, repetition by "
                "repetition.</p>\n";
}

std::string pictures(const SceneReport& report) {
  if (report.pictures.empty()) return {};
  std::string html = "<h3>The worst view of each method</h3>\n<p class=\"soft\">By FLIP, among the views of each method's first row: the "
                     "triangles, the method, and the error as an eye sees it (blue 0, yellow 1).</p>\n";
  for (const WorstPicture& p : report.pictures) {
    add(html, "<p><b>{}</b> <span class=\"soft\">{} · {} · FLIP {:.4f}</span></p>\n<div class=\"triple\">", p.method, html_escaped(p.settings),
        html_escaped(p.view), p.flip);
    for (const auto& [file, caption] : {std::pair(&p.reference, "triangles"), std::pair(&p.shown, "probes"), std::pair(&p.difference, "difference")}) {
      add(html, "<figure><img loading=\"lazy\" src=\"{}\" alt=\"{} of {}\"><figcaption>{}</figcaption></figure>", html_escaped(*file), caption,
          p.method, caption);
    }
    html += "</div>\n";
  }
  return html;
}

std::string charts(const SceneReport& report) {
  std::string html = legend_html(report.rows) + "<div class=\"charts pareto\">\n";
  std::size_t count = 0;
  for (const Cost cost : {Cost::kTime, Cost::kLookups}) {
    for (const ErrorKind kind : {ErrorKind::kMedian, ErrorKind::kFailed, ErrorKind::kFlip}) {
      const std::string svg = pareto_svg(report.rows, cost, kind);
      if (svg.empty()) continue;
      html += svg + "\n";
      ++count;
    }
  }
  return count > 0 ? html + "</div>\n" : std::string();
}

std::string scene_section(const SceneReport& report) {
  std::string html = fmt::format("<section class=\"run\" id=\"{}\">\n<h2>{}</h2>\n", anchor(report.name), html_escaped(report.name));
  std::string facts = fmt::format("{} · {} rooms, {} probes of {}²", html_escaped(report.scene_name), report.rooms, report.probes,
                                  report.resolution);
  if (report.triangles > 0) facts += fmt::format(" · {} triangles", report.triangles);
  if (const BenchRow* row = report.default_row()) {
    facts += fmt::format(" · {} views of {} × {} rays", row->views, row->width, row->height);
    if (row->pixels_per_degree) facts += fmt::format(" · pictures at {:.0f} pixels per degree", *row->pixels_per_degree);
  }
  if (!report.credits.empty()) facts += " · " + html_escaped(report.credits);
  html += "<p class=\"soft\">" + facts + "</p>\n";
  for (const std::string& missing : report.missing) html += "<div class=\"banner\"><b>Missing.</b> " + html_escaped(missing) + "</div>\n";
  html += "<p>" + html_escaped(scene_in_words(report)) + "</p>\n";
  html += charts(report) + "<h3>Methods</h3>\n" + methods_table(report) + all_rows(report) + equal_error_table(report) +
          accelerations_table(report) + eyes_table(report.eyes) + pictures(report);
  return html + "</section>\n";
}

constexpr const char* kDefinitions = R"html(<h2>What the words mean</h2>
<div class="scroll"><table>
<tr><td>ns a ray</td><td class="words">Time of the device's dispatches alone, of all views' rays, divided by their number: median of the repetitions ± half the distance between their quartiles. Radiance is found, too. Everything is run once before (warm-up); then each repetition runs every method once, each time starting with another.</td></tr>
<tr><td>time / oat</td><td class="words">To the product's defaults, in the same repetition.</td></tr>
<tr><td>look-up</td><td class="words">One dependent read of a pyramid node, a cell (all its words) or a map's texel. Reads of radiance at the hit are counted apart.</td></tr>
<tr><td>probes</td><td class="words">Probes that a ray was walked or marched through.</td></tr>
<tr><td>data error</td><td class="words">Distance to the hit against the triangles (Embree), relative, over rays that hit in both. <b>Wrong</b>: off by over 2 %, or a hit for a miss, or a miss for a hit. <b>Hole</b>: no answer. Both as shares of all rays.</td></tr>
<tr><td>tracer error</td><td class="words">Distance against the same probes in double precision, cell by cell, by the same rules of selection: what arithmetic and the pyramid cost. Rays whose answer is exactly that of a ray beside them, within 2e-6 of the distance, are ties: the answer jumps there, and rounding decides. They are counted, and left out of the maximum. Of the baselines there is none: their data define no surface to intersect exactly.</td></tr>
<tr><td>picture error</td><td class="words">FLIP (Andersson et al. 2020) and PSNR, after the display transform, against pictures cast at the triangles with the light that was baked, of narrow views whose pixels are as wide as a headset's.</td></tr>
<tr><td>device</td><td class="words">Bytes that the method's answers are made from.</td></tr>
</table></div>
)html";

std::string machine_table(const BenchSummary& summary) {
  std::string html = "<h2>Machine, device, build</h2>\n<div class=\"scroll\"><table>";
  const auto fact = [&](const char* name, const std::string& text) {
    if (!text.empty()) add(html, "<tr><td class=\"soft\">{}</td><td class=\"words\">{}</td></tr>\n", name, html_escaped(text));
  };
  fact("device", summary.device.name + (summary.device.is_software ? " (software rasteriser)" : ""));
  fact("driver", summary.device.driver + ", Vulkan " + summary.device.api_version);
  fact("CPU", fmt::format("{}, {} cores usable{}", summary.machine.cpu, summary.machine.cores,
                          summary.machine.governor.empty() ? "" : ", governor " + summary.machine.governor));
  fact("memory", in_bytes(summary.machine.memory_bytes));
  fact("system", summary.machine.operating_system + ", " + summary.machine.kernel);
  fact("build", summary.build);
  fact("started", summary.started_utc);
  fact("repetitions", fmt::format("{}, after one to warm up", summary.options.repeats));
  for (const SceneReport& scene : summary.scenes) fact("pack", scene.pack + (scene.scene.empty() ? "" : ", baked from " + scene.scene));
  return html + "</table></div>\n<h2>To repeat it</h2>\n<pre>" + html_escaped(summary.options.command) + "</pre>\n";
}

std::string figures_section(const BenchSummary& summary) {
  if (!summary.has_figures) return {};
  return "<h2>Figures</h2>\n<p><a href=\"figures/index.html\">The regions of probe ordering, and look-ups against what the thesis "
         "predicts</a>.</p>\n";
}

std::string triangles_section(const BenchSummary& summary) {
  if (summary.triangles.empty()) return {};
  std::string html =
      "<h2>Cost against triangles</h2>\n<p>The same room in more and more triangles, the same rays for all. The ratio is to the same "
      "contender's time in the first room, repetition by repetition: 1 means that triangles cost nothing. Only oat finds radiance, too. "
      "Embree runs on the CPU; where the device is the CPU, it is faster than tracing probes, and nothing here claims otherwise.</p>\n"
      "<div class=\"scroll\"><table><tr><th>room</th><th>triangles</th><th class=\"words\">contender</th><th>ns a ray</th><th>time / first "
      "room</th><th>processor time / first room</th><th>look-ups</th><th>agrees with Embree</th><th>set-up s</th></tr>\n";
  for (const TriangleCostRow& row : summary.triangles) {
    add(html, "<tr{}><td>{}</td><td>{}</td><td class=\"words\">{}</td><td>{:.1f} ± {:.1f}</td><td>{:.2f}</td><td>{:.2f}</td><td>{}</td>"
              "<td>{}</td><td>{:.1f}</td></tr>\n",
        row.contender == "oat" ? " class=\"own\"" : "", html_escaped(row.room), row.triangles, row.contender, row.ns_per_ray_median,
        row.ns_per_ray_spread / 2.0, row.ratio_to_smallest, row.cpu_ratio_to_smallest,
        row.lookups_mean > 0.0 ? fmt::format("{:.1f}", row.lookups_mean) : "–", share_text(row.agreement_fraction), row.setup_s);
  }
  return html + "</table></div>\n<p class=\"soft\">Also in <a href=\"triangles.json\">triangles.json</a>.</p>\n";
}

}  // namespace

std::string bench_page(const BenchSummary& summary) {
  std::string html =
      std::string("<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
                  "content=\"width=device-width, initial-scale=1\">\n<title>Speed against error</title>\n<style>") +
      kReportStyle + kBenchStyle + "</style>\n</head>\n<body>\n<main>\n<h1>Speed against error</h1>\n";
  html += "<p class=\"soft\">" + html_escaped(fmt::format("{} · {}", summary.device.name, summary.started_utc)) + "</p>\n";
  if (summary.device.is_software) {
    html +=
        "<div class=\"banner\"><b>Software rasteriser.</b> The device is the CPU, which does other work, too. Times say nothing about a "
        "GPU; ratios within this run, look-ups and errors are sound. Differences of time within the spread are none.</div>\n";
  }
  if (summary.scenes.size() > 1) {
    html += "<nav><p>";
    for (const SceneReport& scene : summary.scenes) add(html, "<a href=\"#{}\">{}</a>", anchor(scene.name), html_escaped(scene.name));
    html += "</p></nav>\n";
  }
  if (!summary.scenes.empty()) html += "<h2>What was to be reached</h2>\n" + goals_table(summary.scenes);
  for (const SceneReport& scene : summary.scenes) html += scene_section(scene);
  html += triangles_section(summary) + figures_section(summary) + kDefinitions + machine_table(summary);
  if (!summary.scenes.empty()) html += "<p>Raw data beside this page: <a href=\"results.json\">results.json</a>, <a href=\"results.csv\">results.csv</a>.</p>\n";
  return html + "</main>\n</body>\n</html>\n";
}

}  // namespace probewalk::bench
