#include "xr/latency/report_charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "xr/latency/report_svg.h"
#include "xr/latency/report_text.h"

namespace probewalk {
namespace {

double ms(std::int64_t ns) { return static_cast<double>(ns) * 1e-6; }

// One column of the timeline: one frame, or the worst of several.
struct Column {
  std::size_t first = 0, last = 0;
  std::int64_t frame = 0, cpu = 0, gpu = 0;
  std::uint32_t missed = 0, discarded = 0;
};

std::vector<Column> make_columns(const Ledger& ledger, std::size_t most) {
  const auto& frames = ledger.frames();
  const std::size_t count = std::min(most, frames.size());
  std::vector<Column> columns(count);
  for (std::size_t c = 0; c < count; ++c) {
    Column& column = columns[c];
    column.first = c * frames.size() / count;
    column.last = (c + 1) * frames.size() / count - 1;
    for (std::size_t i = column.first; i <= column.last; ++i) {
      const FrameQuantities q = derive(frames[i], i > 0 ? &frames[i - 1] : nullptr, ledger.options().has_deadlines);
      column.frame = std::max(column.frame, q.frame_ns.value_or(0));
      column.cpu = std::max(column.cpu, q.cpu_busy_ns.value_or(0));
      column.gpu = std::max(column.gpu, q.gpu_busy_ns.value_or(0));
      column.missed += q.missed;
      column.discarded += frames[i].discarded ? 1 : 0;
    }
  }
  return columns;
}

std::string step_path(const std::vector<Column>& columns, std::int64_t Column::*member, double x0, double dx,
                      const auto& y_of) {
  std::string path;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    fmt::format_to(std::back_inserter(path), "{}{:.1f} {:.1f}H{:.1f}", c == 0 ? "M" : "L",
                   x0 + static_cast<double>(c) * dx, y_of(columns[c].*member), x0 + static_cast<double>(c + 1) * dx);
  }
  return path;
}

void draw_y_axis(std::string& svg, const SvgPlot& plot, double max_ms, const auto& y_of_ms) {
  const double step = nice_step(max_ms);
  for (double tick = 0.0; tick <= max_ms * 1.0001; tick += step) {
    svg_line(svg, "grid", plot.x0(), y_of_ms(tick), plot.x1(), y_of_ms(tick));
    svg_text(svg, "ylabel", plot.x0() - 6, y_of_ms(tick) + 4, fmt::format("{:g}", tick));
  }
  svg_text(svg, "unit", 4, plot.y1() - 6, "ms");
}

}  // namespace

ChartScale chart_scale(std::span<const Run> runs, std::span<const Summary> summaries) {
  // Beyond three times the usual tail, single frames would flatten everything else; those are drawn clipped.
  ChartScale scale{1, 1};
  for (std::size_t i = 0; i < runs.size(); ++i) {
    std::int64_t largest = 0, tail = summaries[i].period_ns;
    for (const char* name : {"frame", "cpu_busy", "gpu_busy"}) {
      const Histogram& histogram = summaries[i].quantity(name).histogram;
      largest = std::max(largest, histogram.max());
      tail = std::max(tail, histogram.percentile(0.95).value_or(0));
    }
    const std::int64_t shown = std::max(std::min(largest, 3 * tail), summaries[i].period_ns);
    scale.timeline_max_ns = std::max(scale.timeline_max_ns, shown + shown / 10);
    scale.histogram_max_ns = std::max(scale.histogram_max_ns, shown);
  }
  return scale;
}

std::string timeline_svg(const Ledger& ledger, const Summary& summary, const ChartScale& scale) {
  const SvgPlot plot{1100, 300, 48, 12, 24, 56};
  std::string svg = open_svg(plot, "Timeline of the run");
  const std::vector<Column> columns = make_columns(ledger, 1000);
  if (columns.empty()) {
    svg_text(svg, "note", plot.x0(), plot.height / 2, "No frames.");
    return svg + "</svg>";
  }
  const double max_ms = ms(scale.timeline_max_ns);
  const auto y_of_ms = [&](double v) { return plot.y0() - (plot.y0() - plot.y1()) * std::clamp(v / max_ms, 0.0, 1.0); };
  const auto y_of = [&](std::int64_t v) { return y_of_ms(ms(v)); };
  const double dx = (plot.x1() - plot.x0()) / static_cast<double>(columns.size());
  const auto& frames = ledger.frames();
  const auto x_of_frame = [&](std::size_t i) {
    return plot.x0() + (plot.x1() - plot.x0()) * static_cast<double>(i) / static_cast<double>(frames.size());
  };

  if (const std::size_t warmup = ledger.first_counted(); warmup > 0) {
    fmt::format_to(std::back_inserter(svg), "<rect class=\"warmup\" x=\"{:.1f}\" y=\"{}\" width=\"{:.1f}\" height=\"{}\"/>",
                   plot.x0(), plot.y1(), x_of_frame(warmup) - plot.x0(), plot.y0() - plot.y1());
    svg_text(svg, "warmuplabel", plot.x0() + 4, plot.y1() - 6, fmt::format("{} warm-up frames, left out", warmup));
  }
  draw_y_axis(svg, plot, max_ms, y_of_ms);
  const std::string frame_path = step_path(columns, &Column::frame, plot.x0(), dx, y_of);
  fmt::format_to(std::back_inserter(svg), "<path class=\"framearea\" d=\"{}V{}H{}Z\"/>", frame_path, plot.y0(),
                 plot.x0());
  fmt::format_to(std::back_inserter(svg), "<path class=\"frameline\" d=\"{}\"/>", frame_path);
  fmt::format_to(std::back_inserter(svg), "<path class=\"gpuline\" d=\"{}\"/>",
                 step_path(columns, &Column::gpu, plot.x0(), dx, y_of));
  fmt::format_to(std::back_inserter(svg), "<path class=\"cpuline\" d=\"{}\"/>",
                 step_path(columns, &Column::cpu, plot.x0(), dx, y_of));
  if (summary.period_ns > 0) {
    const double y = y_of(summary.period_ns);
    svg_line(svg, "budget", plot.x0(), y, plot.x1(), y);
    svg_text(svg, "budgetlabel", plot.x1() - 4, y - 5, "budget " + in_ms(summary.period_ns) + " ms");
  }

  // Below the axis: a mark for each column with missed (upper) or discarded (lower) frames. Above: clipped ones.
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const Column& column = columns[c];
    const double x = plot.x0() + (static_cast<double>(c) + 0.5) * dx;
    const double mark = std::max(dx, 1.5);
    const auto tick = [&](const char* kind, double y, double height) {
      fmt::format_to(std::back_inserter(svg),
                     "<rect class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{}\"/>", kind,
                     x - mark / 2, y, mark, height);
    };
    if (column.missed > 0) tick("missed", plot.y0() + 3, 10);
    if (column.discarded > 0) tick("discarded", plot.y0() + 15, 6);
    if (std::max({column.frame, column.cpu, column.gpu}) > scale.timeline_max_ns) tick("clipped", plot.y1(), 4);
  }
  const double frame_step = std::max(1.0, nice_step(static_cast<double>(frames.size())));
  for (double f = 0.0; f < static_cast<double>(frames.size()); f += frame_step) {
    svg_text(svg, "xlabel", x_of_frame(static_cast<std::size_t>(f)), plot.y0() + 34, fmt::format("{:g}", f));
  }
  svg_text(svg, "xlabel", (plot.x0() + plot.x1()) / 2, plot.y0() + 50, "frame");

  // What a pointer over a column tells.
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const Column& column = columns[c];
    std::string words =
        column.first == column.last
            ? fmt::format("frame {}", frames[column.first].frame_id)
            : fmt::format("frames {} to {}, largest", frames[column.first].frame_id, frames[column.last].frame_id);
    words += fmt::format(": frame {} ms, CPU busy {} ms, GPU busy {} ms", in_ms(column.frame), in_ms(column.cpu),
                         in_ms(column.gpu));
    if (column.missed > 0) words += fmt::format(", {} missed", column.missed);
    if (column.discarded > 0) words += fmt::format(", {} discarded", column.discarded);
    fmt::format_to(std::back_inserter(svg),
                   "<rect class=\"hit\" x=\"{:.1f}\" y=\"{}\" width=\"{:.2f}\" height=\"{}\"><title>{}</title></rect>",
                   plot.x0() + static_cast<double>(c) * dx, plot.y1(), dx, plot.y0() - plot.y1() + 22, words);
  }
  return svg + "</svg>";
}

std::string histogram_svg(const QuantitySummary& quantity, std::int64_t period_ns, const ChartScale& scale) {
  const SvgPlot plot{360, 200, 40, 10, 34, 36};
  std::string svg = open_svg(plot, "Histogram of " + quantity.name);
  svg_text(svg, "title", plot.x0(), 14, fmt::format("{}  (n = {})", quantity.name, quantity.histogram.count()));
  if (quantity.histogram.count() == 0) {
    svg_text(svg, "note", plot.x0(), plot.height / 2, "not measured here");
    return svg + "</svg>";
  }
  constexpr std::size_t kBins = 64;
  const double width_ns = static_cast<double>(scale.histogram_max_ns) / static_cast<double>(kBins);
  std::vector<double> bins(kBins, 0.0);
  for (const Histogram::Bucket& bucket : quantity.histogram.buckets()) {
    // A bucket wider than a bin is spread over the bins that it covers; what lies beyond goes into the last.
    const double low = std::max(0.0, static_cast<double>(bucket.low) / width_ns);
    const double high = std::max(low + 1e-9, (static_cast<double>(bucket.high) + 1.0) / width_ns);
    const auto bin_of = [](double at) {
      return static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(kBins) - 1.0));
    };
    if (bin_of(low) == bin_of(high)) {
      bins[bin_of(low)] += static_cast<double>(bucket.count);
      continue;
    }
    for (std::size_t b = bin_of(low); b <= bin_of(high); ++b) {
      const double from = std::max(low, static_cast<double>(b));
      const double to = b + 1 == kBins ? high : std::min(high, static_cast<double>(b + 1));
      bins[b] += static_cast<double>(bucket.count) * std::max(0.0, to - from) / (high - low);
    }
  }

  const double top = std::log10(1.0 + std::max(10.0, *std::ranges::max_element(bins)));
  const auto y_of = [&](double count) { return plot.y0() - (plot.y0() - plot.y1()) * std::log10(1.0 + count) / top; };
  for (double count = 1.0; std::log10(1.0 + count) <= top; count *= 10.0) {
    svg_line(svg, "grid", plot.x0(), y_of(count), plot.x1(), y_of(count));
    svg_text(svg, "ylabel", plot.x0() - 5, y_of(count) + 4, fmt::format("{:g}", count));
  }
  const double dx = (plot.x1() - plot.x0()) / static_cast<double>(kBins);
  for (std::size_t b = 0; b < kBins; ++b) {
    if (bins[b] < 0.005) continue;
    const bool beyond = b + 1 == kBins && quantity.histogram.max() > scale.histogram_max_ns;
    fmt::format_to(std::back_inserter(svg),
                   "<rect class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"><title>{}{} ms: "
                   "about {:.0f}</title></rect>",
                   beyond ? "bar beyond" : "bar", plot.x0() + static_cast<double>(b) * dx, y_of(bins[b]), dx - 0.6,
                   plot.y0() - y_of(bins[b]), beyond ? "at least " : "from ",
                   in_ms(static_cast<std::int64_t>(static_cast<double>(b) * width_ns)), bins[b]);
  }
  const double max_ms = ms(scale.histogram_max_ns);
  const auto x_of_ms = [&](double v) { return plot.x0() + (plot.x1() - plot.x0()) * std::clamp(v / max_ms, 0.0, 1.0); };
  svg_line(svg, "axis", plot.x0(), plot.y0(), plot.x1(), plot.y0());
  for (double tick = 0.0; tick <= max_ms * 1.0001; tick += nice_step(max_ms)) {
    svg_text(svg, "xlabel", x_of_ms(tick), plot.y0() + 14, fmt::format("{:g}", tick));
  }
  svg_text(svg, "xlabel", (plot.x0() + plot.x1()) / 2, plot.y0() + 29, "ms");
  if (period_ns > 0 && period_ns <= scale.histogram_max_ns) {
    svg_line(svg, "budget", x_of_ms(ms(period_ns)), plot.y0(), x_of_ms(ms(period_ns)), plot.y1());
  }
  const auto percentile_mark = [&](double p, const char* label, double y) {
    const auto value = quantity.histogram.percentile(p);
    svg_line(svg, "pmark", x_of_ms(ms(*value)), plot.y0(), x_of_ms(ms(*value)), y);
    const bool leftwards = x_of_ms(ms(*value)) > plot.x1() - 90;
    svg_text(svg, leftwards ? "plabel left" : "plabel", x_of_ms(ms(*value)) + (leftwards ? -4 : 4), y + 8,
         fmt::format("{} {} ms", label, in_ms(*value)));
  };
  percentile_mark(0.5, "p50", plot.y1() - 6);
  if (quantity.histogram.count() >= 100) percentile_mark(0.99, "p99", plot.y1() + 7);
  return svg + "</svg>";
}

}  // namespace probewalk
