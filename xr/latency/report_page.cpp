#include "xr/latency/report_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <vector>

#include "xr/latency/comparison_page.h"
#include "xr/latency/report_charts.h"
#include "xr/latency/report_style.h"
#include "xr/latency/report_text.h"
#include "xr/latency/streaming_section.h"

namespace probewalk {
namespace {

// A frame this many times as long as the median, or one with a missed refresh before it, is worth a cause.
constexpr double kStandsOut = 1.05;

const std::string kNone = "<span class=\"soft\">–</span>";

std::string value_text(const QuantitySummary& quantity, std::int64_t value) {
  if (quantity.unit == "ns") return in_ms(value);
  const double in_unit = static_cast<double>(value) / quantity.scale;
  return in_unit != 0.0 && std::abs(in_unit) < 0.001 ? "&lt; 0.001" : fmt::format("{:.3f}", in_unit);
}

std::string heading(const QuantitySummary& quantity) {
  return fmt::format("{} <span class=\"soft\">{}</span>", quantity.name, quantity.unit == "ns" ? "ms" : quantity.unit);
}

std::string percent(double fraction) {
  return fmt::format("{:.1f} %", 100.0 * fraction);
}

// A table cell for a percentile: the value, or why there is none.
std::string percentile_cell(const QuantitySummary& quantity, const PercentileRank& rank) {
  if (const auto value = quantity.histogram.percentile(rank)) return value_text(quantity, *value);
  if (quantity.histogram.count() == 0) return kNone;
  return fmt::format("<span class=\"soft\" title=\"needs {} frames\">n &lt; {}</span>", rank.n_min, rank.n_min);
}

void tile(std::string& html, const std::string& value, const std::string& label, const char* kind = "") {
  fmt::format_to(std::back_inserter(html), "<div class=\"tile {}\"><b>{}</b><span>{}</span></div>\n", kind, value,
                 label);
}

std::string tiles(const Run& run, const Summary& summary) {
  std::string html = "<div class=\"tiles\">\n";
  const QuantitySummary& frame = summary.quantity("frame");
  for (const PercentileRank& rank : percentile_ranks()) {
    if (rank.p != 0.5 && rank.p != 0.99) continue;
    const auto value = frame.histogram.percentile(rank);
    tile(
        html, value ? in_ms(*value) + " <small>ms</small>" : kNone,
        value ? fmt::format("{} frame", rank.label) : fmt::format("{} frame: needs {} frames", rank.label, rank.n_min));
  }
  if (summary.period_ns > 0) {
    tile(html, in_ms(summary.period_ns) + " <small>ms</small>",
         fmt::format("budget ({:.1f} Hz)", 1e9 / static_cast<double>(summary.period_ns)));
  }
  if (summary.within_budget_fraction) {
    const double share = *summary.within_budget_fraction;
    tile(html, percent(share), "of frames within budget", share >= 0.999 ? "good" : share < 0.95 ? "bad" : "");
  }
  if (run.ledger.options().has_deadlines) {
    tile(html, fmt::format("{}", summary.missed),
         fmt::format("refreshes missed in {} frames; longest stale run {}", summary.frames, summary.stale_run_max),
         summary.missed == 0 ? "good" : "bad");
    if (const auto horizon = summary.quantity("prediction_horizon").histogram.percentile(0.5)) {
      tile(html, in_ms(*horizon) + " <small>ms</small>", "p50 prediction horizon");
    }
  } else {
    tile(html, fmt::format("{}", summary.frames), "frames; no deadlines on this display");
  }
  return html + "</div>\n";
}

std::string banners(const Run& run, const Summary& summary) {
  std::string html;
  if (run.info.device.is_software) {
    html +=
        "<div class=\"banner\"><b>Software rasteriser.</b> These frames were drawn by the CPU, in competition with the "
        "application. The times say nothing about a GPU; order, counts and causes are sound.</div>\n";
  }
  if (!run.ledger.options().has_deadlines) {
    html +=
        "<div class=\"banner\"><b>No deadlines.</b> This display runs on a fixed clock: prediction horizon, deadline "
        "margin and missed refreshes do not exist here.</div>\n";
  }
  if (summary.frames > 0 && !summary.clock_error_ns && summary.quantity("gpu_busy").histogram.count() > 0) {
    html +=
        "<div class=\"banner\"><b>Device clock not calibrated.</b> Durations on the device are sound; their place "
        "against the CPU's time is unknown, so there is no deadline margin.</div>\n";
  }
  return html;
}

std::string percentile_table(const Summary& summary) {
  std::string html = "<div class=\"scroll\"><table><tr><th>quantity</th><th>n</th>";
  for (const PercentileRank& rank : percentile_ranks())
    fmt::format_to(std::back_inserter(html), "<th>{}</th>", rank.label);
  html += "<th>max</th><th>min</th></tr>\n";
  for (const QuantitySummary& quantity : summary.quantities) {
    fmt::format_to(std::back_inserter(html), "<tr><td>{}</td><td>{}</td>", heading(quantity),
                   quantity.histogram.count());
    for (const PercentileRank& rank : percentile_ranks()) html += "<td>" + percentile_cell(quantity, rank) + "</td>";
    for (const std::int64_t end : {quantity.histogram.max(), quantity.histogram.min()}) {
      html += "<td>" + (quantity.histogram.count() > 0 ? value_text(quantity, end) : kNone) + "</td>";
    }
    html += "</tr>\n";
  }
  return html +
         "</table></div>\n<p class=\"soft\">From log-linear buckets, each within 1 %; max and min are exact (for the "
         "deadline margin, min is the worst). Up to p99 at least one "
         "frame lies beyond the percentile shown; p99.9 needs 10 000 frames. n differs where a quantity does not exist "
         "for "
         "every frame.</p>\n";
}

// A good run with a bad number: why that is no contradiction.
std::string margin_note(const Run& run, const Summary& summary) {
  const auto margin = summary.quantity("deadline_margin").histogram.percentile(0.5);
  if (!run.ledger.options().has_deadlines || summary.missed > 0 || !margin || *margin >= 0) return {};
  return "<p class=\"soft\">The deadline margin is negative and yet no refresh was missed: this runtime shows a frame "
         "sooner after its end than the one period that the convention leaves it. The margin is still good for "
         "comparisons with other runs on it.</p>\n";
}

std::string counts_line(const Run& run, const Summary& summary) {
  std::string text = fmt::format("{} frames counted, {} warm-up frames left out, {} discarded, {} not rendered",
                                 summary.frames, summary.warmup_frames, summary.discarded, summary.not_rendered);
  if (run.ledger.options().has_deadlines) text += fmt::format(", {} refreshes missed", summary.missed);
  return "<p>" + text + ".</p>\n";
}

std::string worst_table(const Summary& summary) {
  if (summary.worst.empty()) return "<p class=\"soft\">No frames to rank.</p>\n";
  const auto median_ns = static_cast<double>(summary.quantity("frame").histogram.percentile(0.5).value_or(0));
  const auto stands_out = [&](const WorstFrame& frame) {
    return frame.missed > 0 || static_cast<double>(frame.frame_ns) > kStandsOut * median_ns;
  };
  if (std::ranges::none_of(summary.worst, stands_out)) {
    const WorstFrame& longest = summary.worst.front();
    return fmt::format("<p>None stands out: the longest, frame {}, took {} ms, within {:.0f} % of the median.</p>\n",
                       longest.frame_id, in_ms(longest.frame_ns), 100.0 * (kStandsOut - 1.0));
  }
  std::string html =
      "<div class=\"scroll\"><table><tr><th>frame</th><th>frame ms</th><th>CPU busy ms</th><th>GPU busy ms</th>"
      "<th>missed</th><th class=\"words\">cause</th></tr>\n";
  for (const WorstFrame& frame : summary.worst) {
    fmt::format_to(std::back_inserter(html),
                   "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td class=\"words\">{}</td></tr>\n",
                   frame.frame_id, in_ms(frame.frame_ns), frame.cpu_busy_ns ? in_ms(*frame.cpu_busy_ns) : kNone,
                   frame.gpu_busy_ns ? in_ms(*frame.gpu_busy_ns) : kNone, frame.missed, html_escaped(frame.cause));
  }
  return html +
         "</table></div>\n<p class=\"soft\">A frame's time runs from the start of the frame before to its own: it is "
         "filled "
         "by the work of the frame before (whose CPU and GPU times stand here) and by its own wait. The cause is the "
         "stage "
         "that grew most over its median.</p>\n";
}

std::string words_of(const SourceStatistics& source) {
  std::string text = fmt::format("{}: {} chunks, {} more from the cache; {} requests, {} failed", source.address,
                                 source.chunks, source.from_cache, source.requests, source.failed_requests);
  if (source.requests > 0 && source.failed_requests > 0) {
    text += fmt::format(" ({})",
                        percent(static_cast<double>(source.failed_requests) / static_cast<double>(source.requests)));
  }
  if (source.damaged > 0) text += fmt::format(", {} answers damaged", source.damaged);
  if (!source.last_failure.empty()) text += "; the last failure: " + source.last_failure;
  return text;
}

// Facts of one run that every report must state, in the order of the table.
struct Fact {
  const char* name;
  std::function<std::string(const Run&, const Summary&)> text;
};

const std::vector<Fact>& facts() {
  static const std::vector<Fact> all = {
      {"pack", [](const Run& r, const Summary&) { return r.info.pack; }},
      {"display",
       [](const Run& r, const Summary&) {
         return r.info.display + (r.info.display_details.empty() ? "" : ": " + r.info.display_details);
       }},
      {"display changes",
       [](const Run& r, const Summary&) {
         std::string text;
         for (const DisplayChange& change : r.info.display_changes) {
           text += fmt::format("{}frame {}: {} to {} ({}), {}", text.empty() ? "" : "; ", change.frame, change.from,
                               change.to, change.reason,
                               change.gap_ns > 0 ? fmt::format("{} ms without a picture", in_ms(change.gap_ns))
                                                 : "left again before its first picture");
         }
         return text;
       }},
      {"runtime", [](const Run& r, const Summary&) { return r.info.runtime; }},
      {"refresh",
       [](const Run&, const Summary& s) {
         return s.period_ns > 0
                    ? fmt::format("{:.2f} Hz ({} ms)", 1e9 / static_cast<double>(s.period_ns), in_ms(s.period_ns))
                    : "";
       }},
      {"views",
       [](const Run& r, const Summary&) {
         return fmt::format("{} of {} × {} px", r.info.views, r.info.eye_width, r.info.eye_height);
       }},
      {"method",
       [](const Run& r, const Summary&) {
         return r.info.method + (r.info.samples > 1 ? fmt::format(", {} rays a pixel at edges", r.info.samples) : "") +
                (r.info.foveation != "off" ? ", foveation " + r.info.foveation : "") +
                (r.info.second_eye != "traced" ? ", second eye " + r.info.second_eye : "");
       }},
      {"device",
       [](const Run& r, const Summary&) {
         return r.info.device.name + (r.info.device.is_software ? " (software rasteriser)" : "");
       }},
      {"driver",
       [](const Run& r, const Summary&) {
         return r.info.device.driver +
                (r.info.device.api_version.empty() ? "" : ", Vulkan " + r.info.device.api_version);
       }},
      {"clock error",
       [](const Run&, const Summary& s) {
         return s.clock_error_ns ? fmt::format("at most {} ns between device and CLOCK_MONOTONIC", *s.clock_error_ns)
                                 : std::string("device clock not calibrated");
       }},
      {"CPU",
       [](const Run& r, const Summary&) {
         return fmt::format("{}, {} cores usable{}", r.info.machine.cpu, r.info.machine.cores,
                            r.info.machine.governor.empty() ? "" : ", governor " + r.info.machine.governor);
       }},
      {"memory", [](const Run& r, const Summary&) { return in_bytes(r.info.machine.memory_bytes); }},
      {"system",
       [](const Run& r, const Summary&) { return r.info.machine.operating_system + ", " + r.info.machine.kernel; }},
      {"build", [](const Run& r, const Summary&) { return r.info.build; }},
      {"started", [](const Run& r, const Summary&) { return r.info.started_utc; }},
      {"instrumentation",
       [](const Run& r, const Summary&) {
         return r.info.instrumentation_cost_fraction
                    ? percent(*r.info.instrumentation_cost_fraction) + " of frame time, from an on/off pair"
                    : std::string("its own cost was not measured in this run");
       }},
      {"device budget",
       [](const Run& r, const Summary&) { return budget_in_words(r.info.streaming); }},
      {"web server",
       [](const Run& r, const Summary&) { return r.info.streaming.source ? words_of(*r.info.streaming.source) : ""; }},
  };
  return all;
}

std::string facts_table(std::span<const Run> runs, std::span<const Summary> summaries) {
  std::string html = "<div class=\"scroll\"><table>";
  if (runs.size() > 1) {
    html += "<tr><th></th>";
    for (const Run& run : runs) html += "<th class=\"words\">" + html_escaped(run.name) + "</th>";
    html += "</tr>\n";
  }
  for (const Fact& fact : facts()) {
    std::vector<std::string> texts;
    for (std::size_t i = 0; i < runs.size(); ++i) texts.push_back(fact.text(runs[i], summaries[i]));
    // What no run had (a web server, another display on the way) is not worth a line.
    if (std::ranges::all_of(texts, &std::string::empty)) continue;
    fmt::format_to(std::back_inserter(html), "<tr><td class=\"soft\">{}</td>", fact.name);
    for (const std::string& text : texts) {
      html += "<td class=\"words\">" + (text.empty() ? kNone : html_escaped(text)) + "</td>";
    }
    html += "</tr>\n";
  }
  return html + "</table></div>\n";
}

// Percentiles of all runs next to each other; what of their differences is more than spread, the comparison says.
std::string comparison_table(std::span<const Run> runs, std::span<const Summary> summaries) {
  std::string html = "<div class=\"scroll\"><table><tr><th>quantity</th><th></th>";
  for (const Run& run : runs) html += "<th>" + html_escaped(run.name) + "</th>";
  html += "</tr>\n";
  const auto row = [&](const std::string& name, const std::string& what, const auto& value_of, const auto& text_of) {
    html += "<tr><td>" + name + "</td><td class=\"soft\">" + what + "</td>";
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const std::optional<double> value = value_of(summaries[i]);
      html += "<td>" + (value ? text_of(*value) : kNone);
      html += "</td>";
    }
    html += "</tr>\n";
  };
  for (std::size_t k = 0; k < quantity_definitions().size(); ++k) {
    const QuantitySummary& quantity = summaries[0].quantities[k];
    for (const PercentileRank& rank : percentile_ranks()) {
      if (rank.p != 0.5 && rank.p != 0.99) continue;
      row(
          heading(quantity), rank.label,
          [&](const Summary& summary) -> std::optional<double> {
            const auto value = summary.quantities[k].histogram.percentile(rank);
            return value ? std::optional(static_cast<double>(*value)) : std::nullopt;
          },
          [&](double value) { return value_text(quantity, std::llround(value)); });
    }
  }
  const auto count = [](double value) { return fmt::format("{:.0f}", value); };
  row("missed", "refreshes", [](const Summary& s) { return std::optional(static_cast<double>(s.missed)); }, count);
  row(
      "stale run", "longest", [](const Summary& s) { return std::optional(static_cast<double>(s.stale_run_max)); },
      count);
  row(
      "within budget", "share", [](const Summary& s) { return s.within_budget_fraction; },
      [](double value) { return percent(value); });
  row("frames", "n", [](const Summary& s) { return std::optional(static_cast<double>(s.frames)); }, count);
  return html + "</table></div>\n";
}

std::string run_section(const Run& run, const Summary& summary, const ChartScale& scale, bool only) {
  std::string html = "<section class=\"run\">\n";
  if (!only) html += "<h2>" + html_escaped(run.name) + "</h2>\n";
  html += banners(run, summary) + tiles(run, summary) + counts_line(run, summary);
  html +=
      "<h2>Timeline</h2>\n<p class=\"soft\"><span class=\"key\" style=\"background:var(--frame)\"></span>frame"
      "<span class=\"key\" style=\"background:var(--cpu)\"></span>CPU busy"
      "<span class=\"key\" style=\"background:var(--gpu)\"></span>GPU busy"
      "<span class=\"key\" style=\"background:var(--missed)\"></span>missed (below), cut off (above)"
      "<span class=\"key\" style=\"background:var(--discarded)\"></span>discarded</p>\n";
  html += "<div class=\"scroll wide\">" + timeline_svg(run.ledger, summary, scale) + "</div>\n";
  html += streaming_section(run, summary);
  html += "<h2>Histograms</h2>\n<div class=\"charts\">\n";
  for (const char* name : {"frame", "cpu_busy", "gpu_busy"}) {
    html += histogram_svg(summary.quantity(name), summary.period_ns, scale) + "\n";
  }
  html +=
      "</div>\n<p class=\"soft\">Counts on a logarithmic axis. Dashed: the budget. Red: longer than the axis.</p>\n";
  html += "<h2>Percentiles</h2>\n" + percentile_table(summary) + margin_note(run, summary);
  html += "<h2>The longest frames and their causes</h2>\n" + worst_table(summary);
  html += "<h2>To repeat it</h2>\n<pre>" + html_escaped(run.info.command) + "</pre>\n";
  if (only) {
    html +=
        "<p>Raw data beside this page: <a href=\"frames.csv\">frames.csv</a> (every time point of every frame), "
        "<a href=\"summary.json\">summary.json</a>, <a href=\"trace.json\">trace.json</a> (open it in Perfetto, "
        "<code>ui.perfetto.dev</code>).</p>\n";
  }
  return html + "</section>\n";
}

std::string definitions() {
  std::string html = "<h2>What the words mean</h2>\n<div class=\"scroll\"><table>";
  for (const QuantityDefinition& definition : quantity_definitions()) {
    fmt::format_to(std::back_inserter(html), "<tr><td><code>{}</code></td><td class=\"words\">{}</td></tr>\n",
                   definition.name, html_escaped(definition.text));
  }
  html +=
      "<tr><td>within budget</td><td class=\"words\">CPU busy and GPU busy both at most one period; of rendered frames "
      "with "
      "both measured.</td></tr>\n"
      "<tr><td>missed</td><td class=\"words\">Where predicted_display advanced by 1.5 periods or more between two "
      "frames: "
      "round(advance / period) - 1 refreshes.</td></tr>\n"
      "<tr><td>discarded</td><td class=\"words\">Frames that the runtime answered with XR_FRAME_DISCARDED.</td></tr>\n"
      "<tr><td>stale run</td><td class=\"words\">Consecutive refreshes without a new frame: missed ones and those of "
      "discarded "
      "frames.</td></tr>\n"
      "<tr><td>not rendered</td><td class=\"words\">Frames whose should_render was false.</td></tr>\n"
      "<tr><td>coarse</td><td class=\"words\">Frames shown below the level that the wearer's room was wanted at, or "
      "not "
      "at all.</td></tr>\n"
      "<tr><td>need to resident</td><td class=\"words\">From the frame that first wanted a room's level to its being "
      "handed to the device; one value a level.</td></tr>\n"
      "<tr><td>warm-up</td><td class=\"words\">The first frames, which load and compile: counted, in frames.csv, in no "
      "statistic.</td></tr>\n</table></div>\n";
  html +=
      "<h2>What is not measured</h2>\n<p>The panel (scan-out, persistence, switching time), the compositor's own work, "
      "and "
      "reprojection, which warps the last frame to a newer pose before it is shown: so neither motion-to-photon "
      "latency nor "
      "what the wearer finally saw. All times are CLOCK_MONOTONIC as the application saw them; other work on the "
      "machine is "
      "in them.</p>\n";
  return html;
}

}  // namespace

std::string report_page(std::span<const Run> runs, const Comparison& comparison) {
  std::vector<Summary> summaries;
  for (const Run& run : runs) summaries.push_back(run.ledger.summary());
  const ChartScale scale = chart_scale(runs, summaries);
  const bool only = runs.size() == 1;
  const std::string title = only ? "Walk report" + (runs[0].info.pack.empty() ? "" : ": " + runs[0].info.pack)
                                 : fmt::format("{} walks compared", runs.size());

  std::string html =
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
      html_escaped(title) + "</title>\n<style>" + kReportStyle + "</style>\n</head>\n<body>\n<main>\n<h1>" +
      html_escaped(title) + "</h1>\n";
  if (only) {
    const RunInfo& info = runs[0].info;
    html += "<p class=\"soft\">" +
            html_escaped(fmt::format("{} · {} × {} px, {} views · {} · {}", info.display, info.eye_width,
                                     info.eye_height, info.views, info.device.name, info.started_utc)) +
            "</p>\n";
  } else {
    html += "<p class=\"soft\">Pictures share their scales. Percentiles of runs are never averaged.</p>\n" +
            comparison_html(runs, comparison) + "<h2>Run by run</h2>\n" + comparison_table(runs, summaries);
  }
  for (std::size_t i = 0; i < runs.size(); ++i) html += run_section(runs[i], summaries[i], scale, only);
  html += "<h2>Machine, device, runtime, build</h2>\n" + facts_table(runs, summaries);
  html += definitions();
  return html + "</main>\n</body>\n</html>\n";
}

}  // namespace probewalk
