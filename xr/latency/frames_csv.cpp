#include "xr/latency/frames_csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <functional>
#include <iterator>
#include <optional>

#include "content/error.h"

namespace probewalk {
namespace {

// One column of what was recorded: how it is read from and written to a frame. Every value is an integer or a real.
struct Column {
  std::string name;
  bool is_real = false;
  std::function<double(const FrameRecord&)> real;
  std::function<void(FrameRecord&, double)> set_real;
  std::function<std::int64_t(const FrameRecord&)> integer;
  std::function<void(FrameRecord&, std::int64_t)> set_integer;
};

template <typename T>
Column column(std::string name, T FrameRecord::* member) {
  Column c;
  c.name = std::move(name);
  if constexpr (std::is_floating_point_v<T>) {
    c.is_real = true;
    c.real = [member](const FrameRecord& f) { return f.*member; };
    c.set_real = [member](FrameRecord& f, double value) { f.*member = value; };
  } else {
    c.integer = [member](const FrameRecord& f) { return static_cast<std::int64_t>(f.*member); };
    c.set_integer = [member](FrameRecord& f, std::int64_t value) { f.*member = static_cast<T>(value); };
  }
  return c;
}

Column column(std::string name, Interval FrameRecord::* interval, std::int64_t Interval::* side) {
  Column c;
  c.name = std::move(name);
  c.integer = [=](const FrameRecord& f) { return f.*interval.*side; };
  c.set_integer = [=](FrameRecord& f, std::int64_t value) { f.*interval.*side = value; };
  return c;
}

std::vector<Column> make_columns() {
  std::vector<Column> columns{column("frame_id", &FrameRecord::frame_id)};
  const std::pair<const char*, Interval FrameRecord::*> intervals[] = {
      {"wait", &FrameRecord::wait},
      {"begin", &FrameRecord::begin},
      {"locate_early", &FrameRecord::locate_early},
      {"record", &FrameRecord::record},
      {"locate_late", &FrameRecord::locate_late},
      {"submit", &FrameRecord::submit},
      {"end", &FrameRecord::end},
      {"gpu", &FrameRecord::gpu},
      {"gpu_trace", &FrameRecord::gpu_trace},
      {"gpu_resolve", &FrameRecord::gpu_resolve},
      {"mirror", &FrameRecord::mirror},
      {"ledger", &FrameRecord::ledger},
      {"runtime_wait", &FrameRecord::runtime_wait},
  };
  for (const auto& [name, interval] : intervals) {
    columns.push_back(column(std::string(name) + "_begin", interval, &Interval::begin));
    columns.push_back(column(std::string(name) + "_end", interval, &Interval::end));
  }
  columns.push_back(column("mirror_presented", &FrameRecord::mirror_presented));
  columns.push_back(column("clock_calibrated", &FrameRecord::clock_calibrated));
  columns.push_back(column("clock_deviation_ns", &FrameRecord::clock_deviation_ns));
  columns.push_back(column("predicted_display", &FrameRecord::predicted_display));
  columns.push_back(column("period", &FrameRecord::period));
  columns.push_back(column("should_render", &FrameRecord::should_render));
  columns.push_back(column("discarded", &FrameRecord::discarded));
  columns.push_back(column("blocked_ns", &FrameRecord::blocked_ns));
  columns.push_back(column("pipelines_built", &FrameRecord::pipelines_built));
  columns.push_back(column("bytes_uploaded", &FrameRecord::bytes_uploaded));
  columns.push_back(column("queue_depth", &FrameRecord::queue_depth));
  columns.push_back(column("room", &FrameRecord::room));
  columns.push_back(column("level_shown", &FrameRecord::level_shown));
  columns.push_back(column("level_wanted", &FrameRecord::level_wanted));
  columns.push_back(column("streaming_ns", &FrameRecord::streaming_ns));
  columns.push_back(column("device_bytes", &FrameRecord::device_bytes));
  columns.push_back(column("eye_scale", &FrameRecord::eye_scale));
  columns.push_back(column("pose_error_mm", &FrameRecord::pose_error_mm));
  columns.push_back(column("pose_error_deg", &FrameRecord::pose_error_deg));
  columns.push_back(column("pose_answer", &FrameRecord::pose_answer));
  columns.push_back(column("early_pose", &FrameRecord::early_pose));
  columns.push_back(column("process_cpu_ns", &FrameRecord::process_cpu_ns));
  columns.push_back(column("mirror_shown_begin", &FrameRecord::mirror_shown, &Interval::begin));
  columns.push_back(column("mirror_shown_end", &FrameRecord::mirror_shown, &Interval::end));
  return columns;
}

const std::vector<Column>& columns() {
  static const std::vector<Column> all = make_columns();
  return all;
}

// Of them every file has these; those after them came later, and are 0 where a file lacks them.
constexpr std::size_t kFirstColumns = 48;

constexpr const char* kDerivedColumns =
    ",warmup,frame_ns,cpu_busy_ns,cpu_wait_ns,gpu_busy_ns,gpu_trace_ns,prediction_horizon_ns,deadline_margin_ns,"
    "missed,within_budget";

std::string_view next_piece(std::string_view& rest, char separator) {
  const std::size_t at = rest.find(separator);
  const std::string_view piece = rest.substr(0, at);
  rest = at == std::string_view::npos ? std::string_view() : rest.substr(at + 1);
  return piece;
}

template <typename T>
bool parse(std::string_view text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

[[noreturn]] void bad_line(const std::string& file, std::size_t number, const std::string& why) {
  throw BadInput(
      fmt::format("{}, line {}: {}; give a directory that `probewalk walk --report` wrote", file, number, why));
}

void set(const Column& column, std::string_view cell, FrameRecord& frame, const std::string& file, std::size_t number) {
  bool read = false;
  if (column.is_real) {
    double value = 0.0;
    read = parse(cell, value) && value > -1e300 && value < 1e300;
    if (read) column.set_real(frame, value);
  } else {
    // Times stay far from the ends of the type, so that differences of any two are defined.
    std::int64_t value = 0;
    read = parse(cell, value) && value > -(std::int64_t{1} << 61) && value < (std::int64_t{1} << 61);
    if (read) column.set_integer(frame, value);
  }
  if (!read) bad_line(file, number, fmt::format("'{}' is no value for {}", cell.substr(0, 40), column.name));
}

}  // namespace

std::string frames_csv(const Ledger& ledger) {
  std::string text;
  auto out = std::back_inserter(text);
  for (const Column& column : columns()) fmt::format_to(out, "{}{}", text.empty() ? "" : ",", column.name);
  text += kDerivedColumns;
  text += '\n';
  const auto& frames = ledger.frames();
  const std::size_t first = ledger.first_counted();
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const char* separator = "";
    for (const Column& column : columns()) {
      if (column.is_real) {
        fmt::format_to(out, "{}{}", separator, column.real(frames[i]));
      } else {
        fmt::format_to(out, "{}{}", separator, column.integer(frames[i]));
      }
      separator = ",";
    }
    const bool counts = i >= first;
    const FrameQuantities q =
        derive(frames[i], i != 0 && i != first ? &frames[i - 1] : nullptr, ledger.options().has_deadlines);
    fmt::format_to(out, ",{}", counts ? 0 : 1);
    for (const auto& value : {q.frame_ns, q.cpu_busy_ns, q.cpu_wait_ns, q.gpu_busy_ns, q.gpu_trace_ns,
                              q.prediction_horizon_ns, q.deadline_margin_ns}) {
      text += ',';
      if (value) fmt::format_to(out, "{}", *value);
    }
    fmt::format_to(out, ",{},{}\n", q.missed, q.within_budget ? (*q.within_budget ? "1" : "0") : "");
  }
  return text;
}

std::vector<FrameRecord> parse_frames_csv(std::string_view text, const std::string& file) {
  std::string_view rest = text;
  std::string_view header = next_piece(rest, '\n');
  // Column i of the file is by_position[i], null when it is not one of those recorded.
  std::vector<const Column*> by_position;
  std::size_t known = 0;
  while (!header.empty()) {
    const std::string_view name = next_piece(header, ',');
    const Column* found = nullptr;
    for (const Column& column : columns()) {
      if (column.name == name) found = &column;
    }
    known += found != nullptr && found < columns().data() + kFirstColumns ? 1 : 0;
    by_position.push_back(found);
  }
  if (known != kFirstColumns) {
    bad_line(file, 1, fmt::format("{} of the {} columns are here", known, kFirstColumns));
  }
  std::vector<FrameRecord> frames;
  for (std::size_t number = 2; !rest.empty(); ++number) {
    const bool ends = rest.find('\n') != std::string_view::npos;
    std::string_view line = next_piece(rest, '\n');
    const auto cells = static_cast<std::size_t>(std::ranges::count(line, ',')) + 1;
    if (!ends || cells != by_position.size()) bad_line(file, number, "the line is cut short");
    FrameRecord frame;
    for (std::size_t i = 0; i < by_position.size(); ++i) {
      const std::string_view cell = next_piece(line, ',');
      if (by_position[i] != nullptr) set(*by_position[i], cell, frame, file, number);
    }
    frames.push_back(frame);
  }
  return frames;
}

}  // namespace probewalk
