#include "xr/latency/streaming_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <vector>

#include "xr/latency/report_svg.h"
#include "xr/latency/report_text.h"

namespace probewalk {
namespace {

constexpr std::size_t kNamedFailures = 8;

bool has_levels(const FrameRecord& frame) {
  return frame.level_wanted >= 0;
}
bool is_coarse(const FrameRecord& frame) {
  return has_levels(frame) && frame.level_shown < frame.level_wanted;
}

// One column of the picture: one frame, or several.
struct Column {
  std::size_t coarse = 0, dark = 0, frames = 0;
  std::uint64_t uploaded = 0, device = 0;
  std::uint32_t queue = 0;
  std::int32_t room = -1;
  bool new_room = false;
};

std::vector<Column> make_columns(const std::vector<FrameRecord>& frames, std::size_t most) {
  std::vector<Column> columns(std::min(most, frames.size()));
  for (std::size_t c = 0; c < columns.size(); ++c) {
    Column& column = columns[c];
    for (std::size_t i = c * frames.size() / columns.size(); i < (c + 1) * frames.size() / columns.size(); ++i) {
      const FrameRecord& frame = frames[i];
      column.coarse += is_coarse(frame) ? 1 : 0;
      column.dark += has_levels(frame) && frame.level_shown < 0 ? 1 : 0;
      column.uploaded += frame.bytes_uploaded;
      column.device = std::max(column.device, frame.device_bytes);
      column.queue = std::max(column.queue, frame.queue_depth);
      column.new_room |= i > 0 && frames[i - 1].room != frame.room;
      column.room = frame.room;
      ++column.frames;
    }
  }
  return columns;
}

// Three lanes over the frames of the timeline above: what was shown, what was uploaded, what lay on the device.
std::string streaming_svg(const Run& run, const Summary& summary) {
  const SvgPlot plot{1100, 196, 48, 12, 22, 34};  // left and right as the timeline's
  std::string svg = open_svg(plot, "Streaming over the run");
  const auto& frames = run.ledger.frames();
  const std::vector<Column> columns = make_columns(frames, 1000);
  const double dx = (plot.x1() - plot.x0()) / static_cast<double>(columns.size());
  const auto rect = [&](const char* kind, std::size_t c, double y, double height) {
    fmt::format_to(std::back_inserter(svg),
                   "<rect class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.2f}\" height=\"{:.1f}\"/>", kind,
                   plot.x0() + static_cast<double>(c) * dx, y, std::max(dx, 1.0), height);
  };
  constexpr double kShown = 24, kShownHeight = 14, kUpload = 92, kLane = 44, kDevice = 160;
  std::uint64_t most_uploaded = 1, most_device = std::max<std::uint64_t>(1, run.info.streaming.device_budget_bytes);
  for (const Column& column : columns) {
    most_uploaded = std::max(most_uploaded, column.uploaded);
    most_device = std::max(most_device, column.device);
  }
  svg_text(svg, "unit", plot.x0(), 15, "shown, and the room");
  svg_text(svg, "unit", plot.x0(), kUpload - kLane + 4, "uploaded, at most " + in_bytes(most_uploaded) + " a column");
  svg_text(svg, "unit", plot.x0(), kDevice - kLane + 4, "on the device, at most " + in_bytes(summary.device_bytes_max));
  double last_label = -100.0;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const Column& column = columns[c];
    const double x = plot.x0() + static_cast<double>(c) * dx;
    rect(column.dark > 0 ? "dark" : column.coarse > 0 ? "coarse" : "fine", c, kShown, kShownHeight);
    if (column.new_room || c == 0) {
      svg_line(svg, "axis", x, kShown - 3, x, kShown + kShownHeight + 3);
      if (x - last_label > 26 && c > 0 && x > plot.x0() + 130) {
        svg_text(svg, "unit", x + 2, kShown - 6, fmt::format("{}", column.room));
        last_label = x;
      }
    }
    const double part = (kLane - 8) * static_cast<double>(column.uploaded) / static_cast<double>(most_uploaded);
    if (column.uploaded > 0) rect("bar", c, kUpload - part, std::max(part, 1.0));
    const double device = (kLane - 8) * static_cast<double>(column.device) / static_cast<double>(most_device);
    rect("device", c, kDevice - device, device);
  }
  svg_line(svg, "axis", plot.x0(), kUpload, plot.x1(), kUpload);
  svg_line(svg, "axis", plot.x0(), kDevice, plot.x1(), kDevice);
  if (run.info.streaming.device_budget_bytes > 0) {
    const double y = kDevice - (kLane - 8) * static_cast<double>(run.info.streaming.device_budget_bytes) /
                                   static_cast<double>(most_device);
    svg_line(svg, "budget", plot.x0(), y, plot.x1(), y);
    svg_text(svg, "budgetlabel", plot.x1() - 4, y - 4,
             "device budget " + in_bytes(run.info.streaming.device_budget_bytes));
  }
  const double step = std::max(1.0, nice_step(static_cast<double>(frames.size())));
  for (double f = 0.0; f < static_cast<double>(frames.size()); f += step) {
    svg_text(svg, "xlabel", plot.x0() + (plot.x1() - plot.x0()) * f / static_cast<double>(frames.size()), kDevice + 15,
             fmt::format("{:g}", f));
  }
  svg_text(svg, "xlabel", (plot.x0() + plot.x1()) / 2, kDevice + 30, "frame");
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const Column& column = columns[c];
    fmt::format_to(
        std::back_inserter(svg),
        "<rect class=\"hit\" x=\"{:.1f}\" y=\"22\" width=\"{:.2f}\" height=\"{:.0f}\"><title>frame {}, room {}: {}; {} "
        "uploaded, {} on the device, {} in the queue</title></rect>",
        plot.x0() + static_cast<double>(c) * dx, dx, kDevice - 22, frames[c * frames.size() / columns.size()].frame_id,
        column.room,
        column.dark > 0     ? "nothing to show"
        : column.coarse > 0 ? "coarse"
                            : "as fine as wanted",
        in_bytes(column.uploaded), in_bytes(column.device), column.queue);
  }
  return svg + "</svg>\n";
}

// What could not be loaded when it was wanted, what never came first.
std::vector<std::string> failures(const StreamingFacts& facts) {
  std::vector<std::string> lines;
  for (const bool overcome : {false, true}) {
    for (const LevelTrouble& trouble : facts.troubles) {
      if (trouble.overcome != overcome) continue;
      lines.push_back(fmt::format("room {}, level {}: {} ({} {}{})", trouble.room, trouble.level, trouble.reason,
                                  trouble.tries, trouble.tries == 1 ? "time" : "times",
                                  overcome ? ", then loaded" : ""));
    }
  }
  return lines;
}

void tile(std::string& html, const std::string& value, const std::string& label, const char* kind = "") {
  fmt::format_to(std::back_inserter(html), "<div class=\"tile {}\"><b>{}</b><span>{}</span></div>\n", kind, value,
                 label);
}

std::string milliseconds(std::int64_t ns) {
  return in_ms(ns) + " <small>ms</small>";
}

}  // namespace

std::string budget_in_words(const StreamingFacts& facts) {
  if (facts.device_budget_bytes > 0) return in_bytes(facts.device_budget_bytes);
  return facts.device_free_bytes > 0 ? "none set, the device had " + in_bytes(facts.device_free_bytes) + " free"
                                     : "none set";
}

std::string streaming_section(const Run& run, const Summary& summary) {
  const auto& frames = run.ledger.frames();
  if (std::ranges::none_of(frames, has_levels)) return {};
  const StreamingFacts& facts = run.info.streaming;
  std::string html = "<h2>Streaming</h2>\n<div class=\"tiles\">\n";
  if (summary.coarse_frame_fraction) {
    const double share = *summary.coarse_frame_fraction;
    tile(html, fmt::format("{:.1f} %", 100.0 * share), "of frames below the level wanted",
         share <= 0.001 ? "good"
         : share > 0.05 ? "bad"
                        : "");
  }
  tile(html, fmt::format("{} <small>frames</small>", summary.coarse_run_max),
       summary.coarse_run_max == 0
           ? std::string("the longest run of coarse frames")
           : fmt::format("the longest run of coarse frames, from frame {}; the longest in time took {} ms",
                         summary.coarse_run_first, in_ms(summary.coarse_run_max_ns)));
  const Histogram need = need_to_resident_histogram(facts);
  if (need.count() > 0) {
    tile(html, milliseconds(*need.percentile(0.5)), fmt::format("p50 from need to resident (n = {})", need.count()));
    if (need.count() >= 100) {
      tile(html, milliseconds(*need.percentile(0.99)), "p99 from need to resident");
    } else {
      tile(html, milliseconds(need.max()), "the longest from need to resident; p99 needs 100 levels");
    }
  }
  tile(html, in_bytes(summary.bytes_uploaded), fmt::format("uploaded, {} rooms loaded", facts.rooms_loaded));
  tile(html, in_bytes(summary.device_bytes_max),
       facts.device_budget_bytes > 0 ? "on the device at most, of a budget of " + in_bytes(facts.device_budget_bytes)
                                     : "on the device at most; budget: " + budget_in_words(facts),
       facts.device_budget_bytes > 0 && summary.device_bytes_max > facts.device_budget_bytes ? "bad" : "");
  if (summary.frame_thread_p99_ns) {
    tile(html, milliseconds(*summary.frame_thread_p99_ns), "p99 of what streaming takes from the frame thread");
  }
  html += "</div>\n";
  const std::vector<std::string> lines = failures(facts);
  if (!lines.empty()) {
    html += "<div class=\"banner\"><b>Not everything could be loaded.</b> The walk went on with what was there:<ul>";
    for (std::size_t i = 0; i < std::min(kNamedFailures, lines.size()); ++i) {
      html += "<li>" + html_escaped(lines[i]) + "</li>";
    }
    if (lines.size() > kNamedFailures) fmt::format_to(std::back_inserter(html), "<li>… {} in all</li>", lines.size());
    html += "</ul></div>\n";
  }
  html +=
      "<p class=\"soft\"><span class=\"key\" style=\"background:var(--fine)\"></span>as fine as wanted"
      "<span class=\"key\" style=\"background:var(--missed)\"></span>coarse"
      "<span class=\"key\" style=\"background:var(--ink)\"></span>nothing to show</p>\n";
  return html + "<div class=\"scroll wide\">" + streaming_svg(run, summary) + "</div>\n";
}

}  // namespace probewalk
