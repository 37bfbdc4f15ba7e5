#include "xr/latency/trace_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

namespace probewalk {
namespace {

// Loader threads follow from kFirstLoader on.
enum Track : unsigned { kCalls = 1, kDevice = 2, kMirror = 3, kWaiter = 4, kMirrorThread = 5, kFirstLoader = 10 };

std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

class TraceWriter {
 public:
  explicit TraceWriter(std::int64_t origin_ns) : origin_ns_(origin_ns) {
    text_ = "{\"displayTimeUnit\":\"ms\",\"traceEvents\":[";
    name("process_name", 0, "probewalk walk");
    name("thread_name", kCalls, "frame thread");
    name("thread_name", kDevice, "device");
    name("thread_name", kMirror, "mirror");
  }

  void name_mirror_thread() { name("thread_name", kMirrorThread, "mirror's thread"); }
  void name_waiter() { name("thread_name", kWaiter, "wait ahead"); }
  void name_loader(unsigned thread) {
    name("thread_name", kFirstLoader + thread, fmt::format("loader {}", thread + 1).c_str());
  }

  // `args`: a JSON object.
  void span(unsigned track, const std::string& name, const Interval& interval, const std::string& args) {
    if (interval.begin == 0 || interval.end < interval.begin) return;
    begin_event();
    fmt::format_to(out_, R"({{"name":{},"ph":"X","pid":1,"tid":{},"ts":{:.3f},"dur":{:.3f},"args":{}}})", quoted(name),
                   track, microseconds(interval.begin - origin_ns_), microseconds(interval.end - interval.begin), args);
  }

  void mark(const std::string& name, std::int64_t at_ns) {
    begin_event();
    fmt::format_to(out_, R"({{"name":"{}","ph":"i","s":"t","pid":1,"tid":{},"ts":{:.3f}}})", name,
                   static_cast<unsigned>(kCalls), microseconds(at_ns - origin_ns_));
  }

  void counter(const char* name, std::int64_t at_ns, std::uint64_t value) {
    begin_event();
    fmt::format_to(out_, R"({{"name":"{}","ph":"C","pid":1,"tid":0,"ts":{:.3f},"args":{{"{}":{}}}}})", name,
                   microseconds(at_ns - origin_ns_), name, value);
  }

  std::string finish(bool device_placed) && {
    fmt::format_to(
        out_, "\n],\"otherData\":{{\"clock\":\"CLOCK_MONOTONIC\",\"origin_ns\":{},\"device_passes\":\"{}\"}}}}\n",
        origin_ns_, device_placed ? "placed by a calibrated clock" : "left out: device clock not calibrated");
    return std::move(text_);
  }

 private:
  static double microseconds(std::int64_t ns) { return static_cast<double>(ns) * 1e-3; }
  void begin_event() {
    text_ += is_first_ ? "\n" : ",\n";
    is_first_ = false;
  }
  void name(const char* what, unsigned track, const char* name) {
    begin_event();
    fmt::format_to(out_, R"({{"name":"{}","ph":"M","pid":1,"tid":{},"ts":0,"args":{{"name":"{}"}}}})", what, track,
                   name);
  }

  std::int64_t origin_ns_;
  std::string text_;
  bool is_first_ = true;
  std::back_insert_iterator<std::string> out_{text_};
};

std::int64_t first_ns(const Ledger& ledger, const StreamingFacts& streaming) {
  std::int64_t first = ledger.frames().empty() ? 0 : ledger.frames().front().wait.begin;
  for (const LevelLoad& load : streaming.loads) first = first == 0 ? load.started_ns : std::min(first, load.started_ns);
  return first;
}

// Device times are placed by a calibration that is renewed now and then, so that a frame may seem to begin some
// nanoseconds before the frame ahead of it has ended. On one device it cannot.
Interval not_before(std::int64_t end_ns, const Interval& interval) {
  if (interval.begin == 0) return interval;
  return {std::max(interval.begin, end_ns), std::max(interval.end, end_ns)};
}

void add_load(TraceWriter& trace, const LevelLoad& load) {
  const unsigned track = kFirstLoader + load.thread;
  const std::string key = fmt::format(R"("room":{},"level":{})", quoted(load.room), load.level);
  trace.span(
      track, fmt::format("load {} level {}", load.room, load.level), {load.started_ns, load.finished_ns},
      fmt::format(R"({{{},"queued_ns":{},"bytes_disk":{},"bytes_device":{},"failure":{}}})", key,
                  load.started_ns - load.requested_ns, load.bytes_disk, load.bytes_device, quoted(load.failure)));
  const std::string args = "{" + key + "}";
  if (load.read_ns != 0) trace.span(track, "read", {load.started_ns, load.read_ns}, args);
  if (load.decoded_ns == 0) return;
  trace.span(track, "decompress", {load.read_ns, load.decoded_ns}, args);
  trace.span(track, "upload", {load.decoded_ns, load.finished_ns}, args);
}

}  // namespace

std::string trace_json(const Ledger& ledger, const StreamingFacts& streaming) {
  const auto& frames = ledger.frames();
  TraceWriter trace(first_ns(ledger, streaming));
  bool device_placed = false, waits_ahead = false, mirrors = false;
  std::int64_t device_end_ns = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const FrameRecord& f = frames[i];
    const std::string args = fmt::format(R"({{"frame_id":{}}})", f.frame_id);
    const std::pair<const char*, const Interval&> calls[] = {{"wait", f.wait},
                                                             {"begin", f.begin},
                                                             {"locate_early", f.locate_early},
                                                             {"record", f.record},
                                                             {"locate_late", f.locate_late},
                                                             {"submit", f.submit},
                                                             {"end", f.end},
                                                             {"ledger", f.ledger}};
    trace.span(kCalls, "frame", {f.wait.begin, f.end.end}, args);
    for (const auto& [name, interval] : calls) trace.span(kCalls, name, interval, args);
    if (f.runtime_wait.begin < f.wait.begin) {
      if (!std::exchange(waits_ahead, true)) trace.name_waiter();
      trace.span(kWaiter, "runtime_wait", f.runtime_wait, args);
    }
    if (f.clock_calibrated) {
      device_placed = true;
      trace.span(kDevice, "gpu", not_before(device_end_ns, f.gpu), args);
      trace.span(kDevice, "gpu_trace", not_before(device_end_ns, f.gpu_trace), args);
      trace.span(kDevice, "gpu_resolve", not_before(device_end_ns, f.gpu_resolve), args);
      device_end_ns = std::max(device_end_ns, f.gpu.end);
    }
    trace.span(kMirror, f.mirror_presented ? "mirror" : "mirror (not presented)", f.mirror, args);
    if (f.mirror_shown.begin != 0) {
      if (!std::exchange(mirrors, true)) trace.name_mirror_thread();
      trace.span(kMirrorThread, f.mirror_presented ? "to the window" : "not to the window", f.mirror_shown, args);
    }
    const FrameQuantities q = derive(f, i > 0 ? &frames[i - 1] : nullptr, ledger.options().has_deadlines);
    if (q.missed > 0) trace.mark(fmt::format("missed {}", q.missed), f.wait.end);
    if (f.discarded) trace.mark("discarded", f.begin.end);
    trace.counter("bytes_uploaded", f.wait.end, f.bytes_uploaded);
    trace.counter("queue_depth", f.wait.end, f.queue_depth);
  }
  std::set<unsigned> loaders;
  for (const LevelLoad& load : streaming.loads) {
    if (loaders.insert(load.thread).second) trace.name_loader(load.thread);
    add_load(trace, load);
  }
  return std::move(trace).finish(device_placed);
}

}  // namespace probewalk
