#include "xr/latency/trace_json.h"

#include <fmt/format.h>

#include <iterator>

namespace probewalk {
namespace {

enum Track { kCalls = 1, kDevice = 2, kMirror = 3 };

class TraceWriter {
 public:
  explicit TraceWriter(std::int64_t origin_ns) : origin_ns_(origin_ns) {
    text_ = "{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\n{\"name\":\"process_name\",\"ph\":\"M\",\"pid\":1,\"args\":{\"name\":\"probewalk walk\"}}";
    name_track(kCalls, "frame thread");
    name_track(kDevice, "device");
    name_track(kMirror, "mirror");
  }

  void span(Track track, const char* name, const Interval& interval, std::uint64_t frame_id) {
    if (interval.begin == 0 || interval.end < interval.begin) return;
    fmt::format_to(out_, ",\n{{\"name\":\"{}\",\"ph\":\"X\",\"pid\":1,\"tid\":{},\"ts\":{:.3f},\"dur\":{:.3f},\"args\":{{\"frame_id\":{}}}}}",
                   name, static_cast<int>(track), microseconds(interval.begin - origin_ns_),
                   microseconds(interval.end - interval.begin), frame_id);
  }

  void mark(const std::string& name, std::int64_t at_ns) {
    fmt::format_to(out_, ",\n{{\"name\":\"{}\",\"ph\":\"i\",\"s\":\"t\",\"pid\":1,\"tid\":{},\"ts\":{:.3f}}}", name,
                   static_cast<int>(kCalls), microseconds(at_ns - origin_ns_));
  }

  void counter(const char* name, std::int64_t at_ns, std::uint64_t value) {
    fmt::format_to(out_, ",\n{{\"name\":\"{}\",\"ph\":\"C\",\"pid\":1,\"ts\":{:.3f},\"args\":{{\"{}\":{}}}}}", name,
                   microseconds(at_ns - origin_ns_), name, value);
  }

  std::string finish(bool device_placed) && {
    fmt::format_to(out_, "\n],\"otherData\":{{\"clock\":\"CLOCK_MONOTONIC\",\"origin_ns\":{},\"device_passes\":\"{}\"}}}}\n",
                   origin_ns_, device_placed ? "placed by a calibrated clock" : "left out: device clock not calibrated");
    return std::move(text_);
  }

 private:
  static double microseconds(std::int64_t ns) { return static_cast<double>(ns) * 1e-3; }
  void name_track(Track track, const char* name) {
    fmt::format_to(out_, ",\n{{\"name\":\"thread_name\",\"ph\":\"M\",\"pid\":1,\"tid\":{},\"args\":{{\"name\":\"{}\"}}}}",
                   static_cast<int>(track), name);
  }

  std::int64_t origin_ns_;
  std::string text_;
  std::back_insert_iterator<std::string> out_{text_};
};

}  // namespace

std::string trace_json(const Ledger& ledger) {
  const auto& frames = ledger.frames();
  TraceWriter trace(frames.empty() ? 0 : frames.front().wait.begin);
  bool device_placed = false;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const FrameRecord& f = frames[i];
    const std::pair<const char*, const Interval&> calls[] = {
        {"wait", f.wait},     {"begin", f.begin},             {"locate_early", f.locate_early},
        {"record", f.record}, {"locate_late", f.locate_late}, {"submit", f.submit},
        {"end", f.end}};
    for (const auto& [name, interval] : calls) trace.span(kCalls, name, interval, f.frame_id);
    if (f.clock_calibrated) {
      device_placed = true;
      trace.span(kDevice, "gpu", f.gpu, f.frame_id);
      trace.span(kDevice, "gpu_trace", f.gpu_trace, f.frame_id);
      trace.span(kDevice, "gpu_resolve", f.gpu_resolve, f.frame_id);
    }
    trace.span(kMirror, f.mirror_presented ? "mirror" : "mirror (not presented)", f.mirror, f.frame_id);
    const FrameQuantities q = derive(f, i > 0 ? &frames[i - 1] : nullptr, ledger.options().has_deadlines);
    if (q.missed > 0) trace.mark(fmt::format("missed {}", q.missed), f.wait.end);
    if (f.discarded) trace.mark("discarded", f.begin.end);
    trace.counter("bytes_uploaded", f.wait.end, f.bytes_uploaded);
    trace.counter("queue_depth", f.wait.end, f.queue_depth);
  }
  return std::move(trace).finish(device_placed);
}

}  // namespace probewalk
