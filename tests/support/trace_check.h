// Whether a trace is one that Perfetto and chrome://tracing show whole: what their event format demands of each kind of
// event that we write, and that the spans of one track nest.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>
#include <vector>

namespace probewalk::test {

// One line a fault; empty = sound.
inline std::vector<std::string> trace_faults(const nlohmann::json& trace) {
  struct Span {
    std::int64_t begin_ns, end_ns;
    std::string name;
  };
  std::vector<std::string> faults;
  std::map<std::pair<int, int>, std::vector<Span>> tracks;
  std::map<std::pair<int, int>, std::string> names;
  if (!trace.is_object() || !trace.contains("traceEvents") || !trace["traceEvents"].is_array())
    return {"no traceEvents"};
  const auto ns = [](const nlohmann::json& us) {
    return static_cast<std::int64_t>(std::llround(us.get<double>() * 1e3));
  };
  for (const nlohmann::json& event : trace["traceEvents"]) {
    const auto fault = [&](const char* what) { faults.push_back(what + (": " + event.dump())); };
    const auto has_number = [&](const char* key) { return event.contains(key) && event[key].is_number(); };
    if (!event.contains("name") || !event["name"].is_string() || event["name"].get<std::string>().empty())
      fault("no name");
    if (!has_number("pid") || !has_number("tid")) {
      fault("no pid or tid");
      continue;
    }
    if (!has_number("ts") || event["ts"].get<double>() < 0.0) {
      fault("no ts");
      continue;
    }
    const std::pair track(event["pid"].get<int>(), event["tid"].get<int>());
    const nlohmann::json args = event.value("args", nlohmann::json::object());
    const std::string phase = event.value("ph", "");
    if (phase == "X") {
      if (!has_number("dur") || event["dur"].get<double>() < 0.0) {
        fault("no dur");
        continue;
      }
      tracks[track].push_back({ns(event["ts"]), ns(event["ts"]) + ns(event["dur"]), event["name"]});
    } else if (phase == "i") {
      const std::string scope = event.value("s", "");
      if (scope != "t" && scope != "p" && scope != "g") fault("an instant without a scope");
    } else if (phase == "C") {
      if (args.empty()) fault("a counter without values");
      for (const auto& value : args) {
        if (!value.is_number()) fault("a counter of no number");
      }
    } else if (phase == "M") {
      if (args.value("name", "").empty()) fault("a name that names nothing");
      if (event["name"] == "thread_name" && !names.emplace(track, args.value("name", "")).second) fault("named twice");
    } else {
      fault("unknown ph");
    }
  }
  for (auto& [track, spans] : tracks) {
    if (!names.contains(track)) faults.push_back("track " + std::to_string(track.second) + " has no name");
    std::stable_sort(spans.begin(), spans.end(), [](const Span& a, const Span& b) {
      return std::tuple(a.begin_ns, -a.end_ns) < std::tuple(b.begin_ns, -b.end_ns);
    });
    std::vector<Span> open;
    for (const Span& span : spans) {
      while (!open.empty() && open.back().end_ns <= span.begin_ns) open.pop_back();
      if (!open.empty() && span.end_ns > open.back().end_ns) {
        faults.push_back(names[track] + ": " + span.name + " begins in " + open.back().name + " and outlasts it");
      }
      open.push_back(span);
    }
  }
  return faults;
}

// The names of the tracks that have spans.
inline std::vector<std::string> track_names(const nlohmann::json& trace) {
  std::map<int, std::string> names;
  std::map<int, bool> used;
  for (const nlohmann::json& event : trace["traceEvents"]) {
    if (event["name"] == "thread_name") names[event["tid"].get<int>()] = event["args"]["name"].get<std::string>();
    if (event["ph"] == "X") used[event["tid"].get<int>()] = true;
  }
  std::vector<std::string> result;
  for (const auto& [track, is_used] : used) result.push_back(names[track]);
  return result;
}

}  // namespace probewalk::test
