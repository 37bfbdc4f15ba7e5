#include "xr/latency/comparison_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "xr/latency/report_svg.h"
#include "xr/latency/report_text.h"

namespace probewalk {
namespace {

const std::string kNone = "<span class=\"soft\">–</span>";

std::string value_text(const ComparedValue& value, double v) {
  if (value.unit == "ns") return in_ms(std::llround(v)) + " ms";
  if (value.unit == "per_frame") return fmt::format("{:.2f} %", 100.0 * v);
  return fmt::format("{:.3f} {}", v, value.unit);
}

std::string signed_text(const ComparedValue& value, double v) {
  const std::string text = value.unit == "per_frame" ? fmt::format("{:.2f}", 100.0 * v) : value_text(value, v);
  return (v > 0.0 ? "+" : "") + text;
}

std::string change_text(const ComparedValue& value) {
  const Change& change = value.change;
  if (change.is_ratio) return fmt::format("× {:.3f}", change.value);
  return signed_text(value, change.value) + (value.unit == "per_frame" ? " points" : "");
}

std::string interval_text(const ComparedValue& value) {
  const Change& change = value.change;
  if (change.is_ratio) return fmt::format("{:.3f} … {:.3f}", change.low, change.high);
  return signed_text(value, change.low) + " … " + signed_text(value, change.high);
}

std::string verdict_cell(const ComparedValue& value) {
  const char* kind = value.verdict == Verdict::kBetter   ? "better"
                     : value.verdict == Verdict::kWorse  ? "worse"
                     : value.verdict == Verdict::kTooFew ? "few"
                                                         : "same";
  return fmt::format("<td class=\"verdict {}\">{}</td>", kind, verdict_words(value));
}

void add_rows(std::string& html, std::span<const ComparedValue> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const ComparedValue& value = values[i];
    const Change& change = value.change;
    const bool first = i == 0 || values[i - 1].name != value.name;
    if (!change.exists) {
      if (!first) continue;
      fmt::format_to(std::back_inserter(html),
                     "<tr class=\"head\"><td>{}</td><td class=\"words soft\" colspan=\"6\">not measured, or does not "
                     "exist here</td></tr>\n",
                     html_escaped(name_in_words(value)));
      continue;
    }
    fmt::format_to(
        std::back_inserter(html), "<tr{}><td>{}</td><td>{}</td><td>{}</td><td>{}</td>", first ? " class=\"head\"" : "",
        first ? html_escaped(name_in_words(value)) : "",
        value.statistic == "mean" ? "share" : html_escaped(value.statistic == "p999" ? "p99.9" : value.statistic),
        value_text(value, change.base), value_text(value, change.other));
    if (change.enough) {
      fmt::format_to(std::back_inserter(html), "<td>{}</td><td>{}</td>", change_text(value), interval_text(value));
    } else {
      fmt::format_to(std::back_inserter(html), "<td class=\"soft\">{}</td><td>{}</td>", change_text(value), kNone);
    }
    html += verdict_cell(value) + "</tr>\n";
  }
}

std::string changes_table(std::span<const ComparedValue> values, const std::string& base, const std::string& other,
                          const char* what) {
  std::string html = fmt::format(
      "<div class=\"scroll\"><table class=\"changes\"><tr><th>{}</th><th></th><th>{}</th><th>{}</th><th>change</th>"
      "<th>99 % interval</th><th>verdict</th></tr>\n",
      what, html_escaped(base), html_escaped(other));
  add_rows(html, values);
  return html + "</table></div>\n";
}

// The answer in a sentence: what the three times that matter most did at p50 and p99.
std::string headline(const GroupComparison& pair, const std::string& base, const std::string& other) {
  std::vector<std::string> faster, slower, same, few;
  for (const ComparedValue& value : pair.times) {
    const bool asked = value.name == "frame" || value.name == "cpu_busy" || value.name == "gpu_busy";
    if (!asked || (value.statistic != "p50" && value.statistic != "p99")) continue;
    const std::string name = value.name + " " + value.statistic;
    const std::string by = fmt::format("{} by {:.1f} %", name, 100.0 * std::abs(value.change.value - 1.0));
    switch (value.verdict) {
      case Verdict::kBetter:
        faster.push_back(by);
        break;
      case Verdict::kWorse:
        slower.push_back(by);
        break;
      case Verdict::kNoChange:
        same.push_back(name);
        break;
      case Verdict::kTooFew:
        few.push_back(name);
        break;
      case Verdict::kAbsent:
        break;
    }
  }
  std::string text;
  const auto add = [&](const char* words, const std::vector<std::string>& names) {
    if (!names.empty()) text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", words, fmt::join(names, ", "));
  };
  add("faster", faster);
  add("slower", slower);
  add("no change beyond the spread", same);
  add("too few frames to say", few);
  return fmt::format("<p class=\"headline\"><b>{}</b> against <b>{}</b> — {}.</p>\n", html_escaped(other),
                     html_escaped(base), html_escaped(text.empty() ? "nothing to compare" : text));
}

std::string disagreement_banner(std::span<const Run> runs, const Comparison& comparison) {
  std::string odd, expected;
  bool repeats_differ = false;
  std::size_t count = 0;
  for (const Disagreement& d : comparison.disagreements) {
    std::string values;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      // Equal neighbours are told once.
      if (i > 0 && d.values[i] == d.values[i - 1]) continue;
      values += fmt::format("{}{}: <code>{}</code>", values.empty() ? "" : " · ", html_escaped(runs[i].name),
                            d.values[i].empty() ? "–" : html_escaped(d.values[i]));
    }
    repeats_differ |= d.within_group;
    const std::string line = fmt::format("<li><b>{}</b>{} — {}</li>\n", d.what,
                                         d.within_group ? " (also among repeats of one thing)" : "", values);
    if (d.expected) {
      expected += line;
    } else {
      odd += line;
      ++count;
    }
  }
  std::string html;
  if (!odd.empty()) {
    html +=
        fmt::format("<div class=\"banner\"><b>These runs differ in more than their times.</b> {}<ul>{}</ul></div>\n",
                    count == 1 ? "If this is what is compared, well; else it alone may make the difference."
                               : "What changed cannot be put down to one of these alone.",
                    odd);
  }
  if (repeats_differ) {
    html +=
        "<div class=\"banner\"><b>Repeats that are none.</b> Runs of one group were not made alike (above, below): "
        "their "
        "spread is more than that of repeating.</div>\n";
  }
  if (!expected.empty()) html += "<p class=\"soft\">Also different:</p><ul class=\"soft\">" + expected + "</ul>\n";
  return html;
}

}  // namespace

std::string change_svg(const GroupComparison& pair, const std::string& base, const std::string& other) {
  std::vector<const ComparedValue*> shown;
  double reach = 0.05;
  for (const ComparedValue& value : pair.times) {
    if (!value.change.exists || !value.change.enough || !value.change.is_ratio) continue;
    shown.push_back(&value);
    reach = std::max({reach, std::abs(value.change.value - 1.0) * 1.3,
                      std::min(0.5, std::max(value.change.high - 1.0, 1.0 - value.change.low))});
  }
  if (shown.empty()) return {};
  reach = std::min(reach * 1.1, 3.0);
  constexpr double kRow = 17;
  const SvgPlot plot{760, 46 + kRow * static_cast<double>(shown.size()), 170, 20, 24, 22};
  std::string svg = open_svg(plot, "Changes and their intervals");
  const auto x_of = [&](double ratio) {
    return plot.x0() + (plot.x1() - plot.x0()) * (0.5 + 0.5 * std::clamp((ratio - 1.0) / reach, -1.0, 1.0));
  };
  const double step = nice_step(2.0 * reach);
  for (double tick = -std::floor(reach / step) * step; tick <= reach * 1.0001; tick += step) {
    const double at = std::abs(tick) < 1e-9 ? 0.0 : tick;
    svg_line(svg, at == 0.0 ? "axis" : "grid", x_of(1.0 + at), plot.y0(), x_of(1.0 + at), plot.y1());
    svg_text(svg, "xlabel", x_of(1.0 + at), plot.y0() + 15, at == 0.0 ? "0" : fmt::format("{:+g} %", 100.0 * at));
  }
  svg_text(svg, "unit", plot.x0(), 14, "← " + other + " faster than " + base);
  svg_text(svg, "left", plot.x1(), 14, "slower →");
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const ComparedValue& value = *shown[i];
    const double y = plot.y1() + kRow * (static_cast<double>(i) + 0.5);
    const char* kind = value.verdict == Verdict::kBetter  ? "better"
                       : value.verdict == Verdict::kWorse ? "worse"
                                                          : "same";
    svg_text(svg, "ylabel", plot.x0() - 8, y + 4,
             value.name + " " + (value.statistic == "p999" ? "p99.9" : value.statistic));
    fmt::format_to(
        std::back_inserter(svg),
        "<rect class=\"change {}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"8\" rx=\"2\"><title>{}: "
        "{}</title></rect><rect class=\"point {}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"3\" height=\"12\"/>",
        kind, x_of(value.change.low), y - 4, std::max(1.0, x_of(value.change.high) - x_of(value.change.low)),
        interval_text(value), verdict_words(value), kind, x_of(value.change.value) - 1.5, y - 6);
  }
  return svg + "</svg>\n";
}

std::string comparison_html(std::span<const Run> runs, const Comparison& comparison) {
  const RunGroup& base = comparison.groups.front();
  std::string html = "<h2>What is compared</h2>\n<ul>";
  for (const RunGroup& group : comparison.groups) {
    std::vector<std::string> names;
    std::size_t frames = 0;
    for (const std::size_t run : group.runs) {
      names.push_back(html_escaped(runs[run].name));
      frames += runs[run].ledger.frames().size() - runs[run].ledger.first_counted();
    }
    fmt::format_to(std::back_inserter(html), "<li><b>{}</b>: {} ({}), {} frames{}</li>", html_escaped(group.name),
                   group.runs.size() == 1 ? std::string("one run") : fmt::format("{} repeats", group.runs.size()),
                   fmt::join(names, ", "), frames, &group == &base ? " — what the others are compared with" : "");
  }
  html += "</ul>\n" + disagreement_banner(runs, comparison);
  const bool repeats = std::ranges::any_of(comparison.others, &GroupComparison::repeats);
  if (!repeats && !comparison.others.empty()) {
    html +=
        "<div class=\"banner\"><b>No repeats.</b> The intervals hold the spread within these runs; what differs from "
        "one "
        "run to the next of the same command (clocks, heat, other work) is not known. A change found here is one "
        "between "
        "these runs: repeat each three times or more and give all of them before it is put down to the "
        "program.</div>\n";
  }
  for (const GroupComparison& pair : comparison.others) {
    const RunGroup& other = comparison.groups[pair.other];
    html += "<h2>" + html_escaped(other.name) + " against " + html_escaped(base.name) + "</h2>\n";
    html += headline(pair, base.name, other.name);
    if (!pair.paid_with.empty()) {
      html += "<div class=\"banner\"><b>Speed against error.</b><ul>";
      for (const std::string& sentence : pair.paid_with) html += "<li>" + html_escaped(sentence) + "</li>";
      html += "</ul></div>\n";
    }
    html += "<div class=\"scroll wide\">" + change_svg(pair, base.name, other.name) + "</div>\n";
    html += "<h3>Times</h3>\n" + changes_table(pair.times, base.name, other.name, "quantity");
    html += "<h3>What the wearer gets</h3>\n" + changes_table(pair.quality, base.name, other.name, "");
  }
  html += fmt::format(
      "<p class=\"soft\">Values are of all frames of a side together, exact. A change is called one when its 99 % "
      "interval leaves it no doubt and it is {:.0f} % at least (of differences in time: of the period); so about one "
      "in "
      "a hundred of these lines would call one where there is none. The interval is the wider of two: the spread "
      "within "
      "the runs, from blocks of frames drawn again (blocks, since one frame is like the one before; the same places of "
      "the way on all sides, since dear places are no noise); and, with repeats, the spread from run to run "
      "(Student's t). Too few frames: under five beyond the percentile, or all of them from fewer than four blocks. "
      "The "
      "low percentiles of the deadline margin are its bad end.</p>\n",
      100.0 * kSmallestChange);
  return html;
}

}  // namespace probewalk
