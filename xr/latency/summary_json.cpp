#include "xr/latency/summary_json.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "content/error.h"

namespace probewalk {
namespace {

using Json = nlohmann::ordered_json;

template <typename T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}
Json text_or_null(const std::string& text) {
  return text.empty() ? Json() : Json(text);
}

Json percentiles(const QuantitySummary& quantity) {
  const auto in_unit = [&](std::int64_t value) {
    return quantity.scale == 1.0 ? Json(value) : Json(static_cast<double>(value) / quantity.scale);
  };
  Json entry = {{"n", quantity.histogram.count()}};
  for (const PercentileRank& rank : percentile_ranks()) {
    const auto value = quantity.histogram.percentile(rank);
    entry[rank.name] = value ? in_unit(*value) : Json();
  }
  const bool any = quantity.histogram.count() > 0;
  entry["max"] = any ? in_unit(quantity.histogram.max()) : Json();
  entry["min"] = any ? in_unit(quantity.histogram.min()) : Json();
  return entry;
}

Json machine_json(const MachineInfo& machine) {
  return {{"cpu", machine.cpu},
          {"cores", machine.cores},
          {"kernel", machine.kernel},
          {"operating_system", machine.operating_system},
          {"memory_bytes", machine.memory_bytes},
          {"governor", text_or_null(machine.governor)}};
}

Json device_json(const DeviceFacts& device) {
  return {{"name", device.name},
          {"driver", device.driver},
          {"api_version", device.api_version},
          {"is_software", device.is_software}};
}

Json source_json(const std::optional<SourceStatistics>& source) {
  if (!source) return {};
  return {{"address", source->address},
          {"chunks", source->chunks},
          {"from_cache", source->from_cache},
          {"requests", source->requests},
          {"failed_requests", source->failed_requests},
          {"damaged", source->damaged},
          {"bytes", source->bytes},
          {"last_failure", text_or_null(source->last_failure)}};
}

Json troubles_json(const std::vector<LevelTrouble>& troubles) {
  Json list = Json::array();
  for (const LevelTrouble& trouble : troubles) {
    list.push_back({{"room", trouble.room},
                    {"level", trouble.level},
                    {"tries", trouble.tries},
                    {"overcome", trouble.overcome},
                    {"reason", trouble.reason}});
  }
  return list;
}

Json streaming_json(const Summary& summary, const StreamingFacts& facts) {
  const NeedToResident need = need_to_resident(facts);
  return {{"bytes", summary.bytes_uploaded},
          {"rooms_loaded", facts.rooms_loaded},
          {"coarse_frame_fraction", or_null(summary.coarse_frame_fraction)},
          {"coarse_run_max", summary.coarse_run_max},
          {"coarse_run_max_ns", summary.coarse_run_max_ns},
          {"need_to_resident_n", need.count},
          {"need_to_resident_p50_ns", or_null(need.p50_ns)},
          {"need_to_resident_p99_ns", or_null(need.p99_ns)},
          {"need_to_resident_ns", facts.need_to_resident_ns},
          {"frame_thread_p99_ns", or_null(summary.frame_thread_p99_ns)},
          {"device_bytes_max", summary.device_bytes_max},
          {"device_budget_bytes", facts.device_budget_bytes > 0 ? Json(facts.device_budget_bytes) : Json()},
          {"device_free_bytes", facts.device_free_bytes > 0 ? Json(facts.device_free_bytes) : Json()},
          {"source", source_json(facts.source)},
          {"troubles", troubles_json(facts.troubles)}};
}

Json pose_answers_json(const Summary& summary) {
  const auto frames = [&](PoseAnswer answer) { return summary.pose_answers[static_cast<std::size_t>(answer)]; };
  return {{"measured", frames(PoseAnswer::kMeasured)},
          {"too_late", frames(PoseAnswer::kTooLate)},
          {"refused", frames(PoseAnswer::kRefused)},
          {"pending", frames(PoseAnswer::kPending)}};
}

Json worst_json(const std::vector<WorstFrame>& worst) {
  Json list = Json::array();
  for (const WorstFrame& frame : worst) {
    list.push_back({{"frame_id", frame.frame_id},
                    {"frame_ns", frame.frame_ns},
                    {"missed", frame.missed},
                    {"stage", text_or_null(frame.stage)},
                    {"excess_ns", frame.excess_ns},
                    {"cause", frame.cause}});
  }
  return list;
}

Json changes_json(const std::vector<DisplayChange>& changes) {
  Json list = Json::array();
  for (const DisplayChange& change : changes) {
    list.push_back({{"frame_id", change.frame},
                    {"from", change.from},
                    {"to", change.to},
                    {"reason", change.reason},
                    {"gap_ns", change.gap_ns}});
  }
  return list;
}

// Reads json[key] into value; a missing key or null leaves it as it was.
template <typename T>
void take(const Json& json, const char* key, T& value, const std::string& file) {
  const auto found = json.find(key);
  if (found == json.end() || found->is_null()) return;
  try {
    value = found->get<T>();
  } catch (const Json::exception&) {
    throw BadInput(
        fmt::format("{}: \"{}\" has the wrong type; give a directory that `probewalk walk --report` wrote", file, key));
  }
}

Json object_in(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_object() ? *found : Json::object();
}

void take_source_facts(const Json& streaming, StreamingFacts& facts, const std::string& file) {
  if (const Json source = object_in(streaming, "source"); !source.empty()) {
    SourceStatistics& read = facts.source.emplace();
    take(source, "address", read.address, file);
    take(source, "chunks", read.chunks, file);
    take(source, "from_cache", read.from_cache, file);
    take(source, "requests", read.requests, file);
    take(source, "failed_requests", read.failed_requests, file);
    take(source, "damaged", read.damaged, file);
    take(source, "bytes", read.bytes, file);
    take(source, "last_failure", read.last_failure, file);
  }
  const auto troubles = streaming.find("troubles");
  if (troubles == streaming.end() || !troubles->is_array()) return;
  for (const Json& entry : *troubles) {
    LevelTrouble& trouble = facts.troubles.emplace_back();
    take(entry, "room", trouble.room, file);
    take(entry, "level", trouble.level, file);
    take(entry, "tries", trouble.tries, file);
    take(entry, "overcome", trouble.overcome, file);
    take(entry, "reason", trouble.reason, file);
  }
}

}  // namespace

std::string summary_json(const Ledger& ledger, const RunInfo& info) {
  const Summary summary = ledger.summary();
  Json json = {{"schema", kSummarySchema},
               {"command", info.command},
               {"pack", info.pack},
               {"build", info.build},
               {"started_utc", info.started_utc},
               {"machine", machine_json(info.machine)},
               {"device", device_json(info.device)},
               {"runtime", text_or_null(info.runtime)},
               {"display", info.display},
               {"display_details", info.display_details},
               {"has_deadlines", ledger.options().has_deadlines},
               {"eye_width", info.eye_width},
               {"eye_height", info.eye_height},
               {"views", info.views},
               {"method", info.method},
               {"samples", info.samples},
               {"foveation", info.foveation},
               {"second_eye", info.second_eye},
               {"eye_scale", {{"min", or_null(summary.eye_scale_min)}, {"mean", or_null(summary.eye_scale_mean)}}},
               {"period_ns", summary.period_ns},
               {"frames", summary.frames},
               {"warmup_frames", summary.warmup_frames},
               {"missed", summary.missed},
               {"discarded", summary.discarded},
               {"not_rendered", summary.not_rendered},
               {"stale_run_max", summary.stale_run_max},
               {"within_budget_fraction", or_null(summary.within_budget_fraction)},
               {"early_pose_frames", summary.early_pose_frames},
               {"pose_answers", pose_answers_json(summary)},
               {"clock_error_ns", or_null(summary.clock_error_ns)},
               {"instrumentation_cost_fraction", or_null(info.instrumentation_cost_fraction)}};
  Json& table = json["percentiles"] = Json::object();
  for (const QuantitySummary& quantity : summary.quantities) table[quantity.name] = percentiles(quantity);
  json["streaming"] = streaming_json(summary, info.streaming);
  json["worst_frames"] = worst_json(summary.worst);
  if (!info.display_changes.empty()) json["display_changes"] = changes_json(info.display_changes);
  // Names may hold any bytes; what is not UTF-8 is replaced rather than refused.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

SummaryHead parse_summary_json(std::string_view text, const std::string& file) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object())
    throw BadInput(file + ": is no JSON object; give a directory that `probewalk walk --report` wrote");
  int schema = 0;
  take(json, "schema", schema, file);
  if (schema != kSummarySchema) {
    throw BadInput(fmt::format("{}: schema {} is not the {} that this probewalk reads; use the version that wrote it",
                               file, schema, kSummarySchema));
  }
  SummaryHead head;
  RunInfo& info = head.info;
  take(json, "command", info.command, file);
  take(json, "pack", info.pack, file);
  take(json, "build", info.build, file);
  take(json, "started_utc", info.started_utc, file);
  take(json, "runtime", info.runtime, file);
  take(json, "display", info.display, file);
  take(json, "display_details", info.display_details, file);
  take(json, "eye_width", info.eye_width, file);
  take(json, "eye_height", info.eye_height, file);
  take(json, "views", info.views, file);
  take(json, "method", info.method, file);
  if (json.contains("samples")) take(json, "samples", info.samples, file);
  if (json.contains("foveation")) take(json, "foveation", info.foveation, file);
  if (json.contains("second_eye")) take(json, "second_eye", info.second_eye, file);
  take(json, "warmup_frames", head.options.warmup_frames, file);
  take(json, "has_deadlines", head.options.has_deadlines, file);
  if (const auto cost = json.find("instrumentation_cost_fraction"); cost != json.end() && !cost->is_null()) {
    take(json, "instrumentation_cost_fraction", info.instrumentation_cost_fraction.emplace(), file);
  }
  const Json machine = object_in(json, "machine");
  info.machine = {};
  take(machine, "cpu", info.machine.cpu, file);
  take(machine, "cores", info.machine.cores, file);
  take(machine, "kernel", info.machine.kernel, file);
  take(machine, "operating_system", info.machine.operating_system, file);
  take(machine, "memory_bytes", info.machine.memory_bytes, file);
  take(machine, "governor", info.machine.governor, file);
  const Json device = object_in(json, "device");
  take(device, "name", info.device.name, file);
  take(device, "driver", info.device.driver, file);
  take(device, "api_version", info.device.api_version, file);
  take(device, "is_software", info.device.is_software, file);
  const Json streaming = object_in(json, "streaming");
  take(streaming, "rooms_loaded", info.streaming.rooms_loaded, file);
  take(streaming, "device_budget_bytes", info.streaming.device_budget_bytes, file);
  take(streaming, "device_free_bytes", info.streaming.device_free_bytes, file);
  take(streaming, "need_to_resident_ns", info.streaming.need_to_resident_ns, file);
  take_source_facts(streaming, info.streaming, file);
  if (const auto changes = json.find("display_changes"); changes != json.end() && changes->is_array()) {
    for (const Json& entry : *changes) {
      DisplayChange change;
      take(entry, "frame_id", change.frame, file);
      take(entry, "from", change.from, file);
      take(entry, "to", change.to, file);
      take(entry, "reason", change.reason, file);
      take(entry, "gap_ns", change.gap_ns, file);
      info.display_changes.push_back(std::move(change));
    }
  }
  return head;
}

}  // namespace probewalk
