#include "tools/probewalk/stability_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "xr/latency/report_style.h"
#include "xr/latency/report_text.h"

namespace probewalk {

namespace {

using stability::CaseResult;
using stability::CaseTally;
using stability::Comparison;

constexpr const char* kStyle = R"css(
td.bad { color: var(--missed); font-weight: 600; } td.case { min-width: 13em; white-space: normal; } td { white-space: nowrap; } td.words { white-space: normal; }
 tr.place td { padding-top: 22px; font-weight: 600; text-align: left; }
th { vertical-align: bottom; } th.group { text-align: center; border-bottom: 1px solid var(--rule); color: var(--ink); } main { max-width: 1360px; }
td .soft { display: block; font-size: 12px; max-width: 46ch; }
)css";

std::string grouped(std::uint64_t value) {
  std::string digits = fmt::format("{}", value);
  for (std::size_t at = digits.size(); at > 3; at -= 3) digits.insert(at - 3, "\u202f");
  return digits;
}

// "1.2e-7".
std::string error_text(double error) {
  if (!(error > 0.0)) return "0";
  const int exponent = static_cast<int>(std::floor(std::log10(error)));
  return fmt::format("{:.1f}e{}", error / std::pow(10.0, exponent), exponent);
}

std::string zero_is_good(std::uint64_t count) {
  return fmt::format("<td{}>{}</td>", count > 0 ? " class=\"bad\"" : "", grouped(count));
}

// "0 of 12": beyond ties, of all that differ; "0" where none does.
std::string disagreements(const Comparison& comparison) {
  if (comparison.rays == 0) return "<td class=\"soft\">–</td>";
  if (comparison.disagreements == 0) return "<td>0</td>";
  std::string by_class;
  for (int a = 0; a < stability::kClasses; ++a) {
    for (int b = 0; b < stability::kClasses; ++b) {
      const std::uint64_t count = comparison.by_class[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)];
      if (count > 0) {
        fmt::format_to(std::back_inserter(by_class), "{}{} → {}: {}", by_class.empty() ? "" : "; ",
                       stability::class_name(a), stability::class_name(b), count);
      }
    }
  }
  const bool bad = comparison.beyond_ties() > 0;
  return fmt::format("<td{} title=\"{}\">{} <small>of {}</small></td>", bad ? " class=\"bad\"" : "", by_class,
                     grouped(comparison.beyond_ties()), grouped(comparison.disagreements));
}

std::string tally_cells(const CaseTally& tally) {
  std::string html = fmt::format("<td>{}</td>", grouped(tally.rays));
  html += zero_is_good(tally.not_finite) + zero_is_good(tally.endless) + zero_is_good(tally.hierarchical_differs);
  const double rays = static_cast<double>(std::max<std::uint64_t>(tally.rays, 1));
  fmt::format_to(std::back_inserter(html), "<td>{:.1f}</td><td>{}</td>", static_cast<double>(tally.lookups) / rays,
                 tally.lookups_max);
  html += disagreements(tally.float_flat);
  fmt::format_to(std::back_inserter(html), "<td>{}</td>", error_text(tally.float_flat.errors.percentile(0.99)));
  html += disagreements(tally.double_planes);
  fmt::format_to(std::back_inserter(html), "<td>{}</td>", error_text(tally.double_planes.errors.max()));
  html += disagreements(tally.float_double);
  fmt::format_to(std::back_inserter(html), "<td>{}</td><td>{}</td>",
                 error_text(tally.float_double.errors.percentile(0.99)), error_text(tally.float_double.errors.max()));
  html += disagreements(tally.device_float);
  if (tally.device_rays > 0) {
    const std::uint64_t other = tally.device_rays - tally.device_same_bits;
    fmt::format_to(std::back_inserter(html), "<td>{}</td>", grouped(other));
  } else {
    html += "<td class=\"soft\">–</td>";
  }
  fmt::format_to(std::back_inserter(html), "<td>{}</td>", grouped(tally.float_brute.rays));
  html += disagreements(tally.float_brute) + disagreements(tally.double_brute);
  fmt::format_to(std::back_inserter(html), "<td>{}</td><td>{}</td>",
                 error_text(tally.float_brute.errors.percentile(0.99)), error_text(tally.float_brute.errors.max()));
  return html;
}

std::string table(const std::vector<CaseResult>& results) {
  std::string html =
      "<div class=\"scroll\"><table>\n<tr><th></th><th class=\"group\" colspan=\"6\">sound</th>"
      "<th class=\"group\" colspan=\"4\">planes</th><th class=\"group\" colspan=\"3\">float against double</th><th "
      "class=\"group\" colspan=\"2\">device against float</th>"
      "<th class=\"group\" colspan=\"5\">against brute force</th></tr>\n"
      "<tr><th>case</th><th>rays</th><th>NaN</th><th>endless</th><th>pyramid changes</th><th>look-ups, "
      "mean</th><th>max</th>"
      "<th>beyond ties</th><th>change p99</th><th>in double beyond ties</th><th>worst change</th><th>beyond "
      "ties</th><th>error p99</th><th>worst</th><th>beyond "
      "ties</th><th>other bits</th>"
      "<th>rays</th><th>float beyond ties</th><th>double beyond ties</th><th>error p99</th><th>worst</th></tr>\n";
  std::string place;
  for (const CaseResult& result : results) {
    const std::string here = fmt::format("{}, {} cells a side", result.place, result.cells);
    if (here != place) html += "<tr class=\"place\"><td colspan=\"21\">" + html_escaped(here) + "</td></tr>\n";
    place = here;
    html += "<tr><td class=\"case\">" + html_escaped(result.hard.name) + "<span class=\"soft\">" +
            html_escaped(result.hard.says) + "</span></td>" + tally_cells(result.tally) + "</tr>\n";
  }
  return html + "<tr class=\"place\"><td>all</td>" + tally_cells(totals(results)) + "</tr>\n</table></div>\n";
}

void tile(std::string& html, const std::string& value, const std::string& label, bool good) {
  fmt::format_to(std::back_inserter(html), "<div class=\"tile {}\"><b>{}</b><span>{}</span></div>\n",
                 good ? "good" : "bad", value, label);
}

std::string tiles(const CaseTally& all) {
  std::string html = "<div class=\"tiles\">\n";
  fmt::format_to(std::back_inserter(html), "<div class=\"tile\"><b>{}</b><span>rays</span></div>\n", grouped(all.rays));
  tile(html, grouped(all.not_finite), "NaN or infinite", all.not_finite == 0);
  tile(html, grouped(all.endless), "endless walks", all.endless == 0);
  tile(html, grouped(all.hierarchical_differs), "changed by the pyramid", all.hierarchical_differs == 0);
  tile(html, grouped(all.float_double.beyond_ties()), "float against double, beyond ties",
       all.float_double.beyond_ties() == 0);
  tile(html, grouped(all.device_float.beyond_ties()), "device against float, beyond ties",
       all.device_float.beyond_ties() == 0);
  tile(html, grouped(all.float_brute.beyond_ties()), "against brute force, beyond ties",
       all.float_brute.beyond_ties() == 0);
  return html + "</div>\n";
}

}  // namespace

std::string stability_page(const stability::TrialInfo& info, const std::vector<CaseResult>& results) {
  std::string html =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Hard cases of the tracer</title>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<style>";
  html += kReportStyle;
  html += kStyle;
  html += "</style></head>\n<body><main>\n<h1>Hard cases of the tracer</h1>\n";
  html += "<p class=\"soft\">" +
          html_escaped(fmt::format("{} · {} · {:.0f} s", info.started_utc, info.build, info.seconds)) + "</p>\n";
  html += tiles(totals(results));
  for (const std::string& sentence : summary(info, results)) html += "<p>" + html_escaped(sentence) + "</p>\n";
  const std::vector<std::string> failed = all_failures(results);
  if (!failed.empty()) {
    html += "<div class=\"banner\"><b>What does not hold</b><ul>";
    for (const std::string& line : failed) html += "<li>" + html_escaped(line) + "</li>";
    html += "</ul></div>\n";
  }
  html +=
      "<h2>Case by case</h2>\n"
      "<p>“Beyond ties” counts rays whose class or distance (by more than 1 %) differs and that are no ties, of all "
      "that differ; "
      "the classes are in the cell’s tip. Errors are relative distances of rays on whose class both agree. “Endless” "
      "means "
      "more look-ups than lines of the grid times levels can cost. “Pyramid changes” counts answers that a "
      "walk by pyramid has other bits of than cell by cell; “planes” compares with that walk when one plane may stand "
      "for "
      "many cells. “Other bits” counts device answers that are not C++ "
      "float’s to the last bit.</p>\n";
  html += table(results);
  html += "<h2>Where and how</h2>\n<table>\n";
  const auto fact = [&](const char* name, const std::string& value) {
    html += std::string("<tr><td class=\"soft\">") + name + "</td><td class=\"words\">" + html_escaped(value) +
            "</td></tr>\n";
  };
  fact("command", info.command);
  fact("device", info.device);
  fact("processor", info.cpu);
  fact("system", info.system);
  fact("build", info.build);
  fact("beside the page",
       "results.json (all numbers, with the first ray of each kind that fails), results.csv (a line a case)");
  return html + "</table>\n</main></body></html>\n";
}

}  // namespace probewalk
