#include "xr/latency/run_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "content/error.h"
#include "support/report_contract.h"
#include "support/trace_check.h"
#include "xr/latency/frames_csv.h"
#include "xr/latency/summary_json.h"
#include "xr/latency/synthetic_run.h"
#include "xr/latency/trace_json.h"

namespace probewalk {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

// 300 frames, 20 of them warm-up, with a stall, a discarded frame, uploads and pose errors.
Ledger eventful_run() {
  Ledger ledger(LedgerOptions{.warmup_frames = 20});
  for (std::size_t i = 0; i < 300; ++i) {
    FrameRecord f = synthetic_frame(i);
    if (i == 120) {
      f.record.end += 35 * kMs;
      for (Interval* later : {&f.locate_late, &f.submit, &f.end})
        *later = {later->begin + 35 * kMs, later->end + 35 * kMs};
    }
    if (i > 120) delay(f, 40 * kMs);
    f.discarded = i == 200;
    f.bytes_uploaded = i % 10 == 0 ? 4096 : 0;
    f.device_bytes = 1'000'000 + i;
    f.pose_error_mm = 0.001 * static_cast<double>(i);
    f.pose_error_deg = 0.01;
    f.mirror = {f.end.begin, f.end.end};
    f.mirror_presented = i % 2 == 0;
    ledger.add(f);
  }
  return ledger;
}

RunInfo some_info() {
  RunInfo info;
  info.command = "probewalk walk house.probes --report 'a <b> & c'";
  info.device = {"llvmpipe (LLVM 19)", "llvmpipe Mesa 25", "1.4.305", true};
  info.runtime = "Monado 25.0.0";
  info.display = "headset";
  info.eye_width = 320;
  info.eye_height = 240;
  info.views = 2;
  info.method = "octant-affine";
  info.pack = "house.probes";
  info.build = "test";
  info.started_utc = "2026-01-01T00:00:00Z";
  info.streaming.rooms_loaded = 3;
  info.streaming.device_budget_bytes = 64 << 20;
  info.streaming.need_to_resident_ns = {5 * kMs, 6 * kMs};
  return info;
}

class RunFiles : public testing::Test {
 protected:
  std::filesystem::path directory_ =
      std::filesystem::path(PROBEWALK_TEST_OUTPUT_DIR) / testing::UnitTest::GetInstance()->current_test_info()->name();
  void SetUp() override { std::filesystem::remove_all(directory_); }

  std::string read(const char* name) const {
    std::ostringstream text;
    text << std::ifstream(directory_ / name, std::ios::binary).rdbuf();
    return text.str();
  }
  void write(const char* name, const std::string& text) const {
    std::ofstream(directory_ / name, std::ios::binary) << text;
  }
};

TEST_F(RunFiles, SummaryHasEveryKeyOfTheContract) {
  const json summary = json::parse(summary_json(eventful_run(), some_info()));
  test::expect_contract(summary);
  EXPECT_EQ(summary["frames"], 280);
  EXPECT_EQ(summary["warmup_frames"], 20);
  EXPECT_EQ(summary["missed"], 4);
  EXPECT_EQ(summary["discarded"], 1);
  EXPECT_TRUE(summary["instrumentation_cost_fraction"].is_null());
  EXPECT_NEAR(summary["percentiles"]["frame"]["p50"].get<double>(), 10e6, 0.1e6);
  EXPECT_EQ(summary["percentiles"]["frame"]["max"], 50 * kMs);
  EXPECT_TRUE(summary["percentiles"]["frame"]["p999"].is_null());
  EXPECT_NEAR(summary["percentiles"]["pose_error_mm"]["max"].get<double>(), 0.299, 1e-9);
  EXPECT_EQ(summary["streaming"]["bytes"], 30 * 4096);
  EXPECT_EQ(summary["streaming"]["device_bytes_max"], 1'000'299);
  EXPECT_NEAR(summary["streaming"]["need_to_resident_p50_ns"].get<double>(), 5e6, 0.05e6);
  EXPECT_TRUE(summary["streaming"]["need_to_resident_p99_ns"].is_null());
}

TEST_F(RunFiles, WhatADisplayLacksIsNullInsideItsEntry) {
  Ledger ledger(LedgerOptions{.has_deadlines = false});
  for (std::size_t i = 0; i < 10; ++i) ledger.add(synthetic_frame(i));
  RunInfo info = some_info();
  info.runtime.clear();
  const json summary = json::parse(summary_json(ledger, info));
  EXPECT_EQ(summary["percentiles"]["deadline_margin"]["n"], 0);
  EXPECT_TRUE(summary["percentiles"]["deadline_margin"]["p50"].is_null());
  EXPECT_TRUE(summary["percentiles"]["deadline_margin"]["max"].is_null());
  EXPECT_TRUE(summary["runtime"].is_null());
  // No frame at all still gives a whole file.
  EXPECT_EQ(json::parse(summary_json(Ledger{}, info))["frames"], 0);
}

TEST_F(RunFiles, ARunReadBackSaysTheSame) {
  const Ledger ledger = eventful_run();
  write_run(directory_, ledger, some_info());
  const auto run = read_run(directory_);
  EXPECT_EQ(run.name, directory_.filename().string());
  EXPECT_EQ(frames_csv(run.ledger), frames_csv(ledger));
  EXPECT_EQ(summary_json(run.ledger, run.info), read("summary.json"));
  EXPECT_EQ(run.ledger.frames()[33].record.begin, ledger.frames()[33].record.begin);
}

TEST_F(RunFiles, ATableWithoutTheProcessorTimeOfLaterVersionsIsRead) {
  Ledger ledger;
  for (std::size_t i = 0; i < 10; ++i) ledger.add(synthetic_frame(i));
  const std::string name = "process_cpu_ns";
  std::string csv = frames_csv(ledger);
  EXPECT_EQ(parse_frames_csv(csv, "now")[3].process_cpu_ns, 18 * kMs);
  // A column of another name is one that this version does not know.
  csv.replace(csv.find(name), name.size(), "something_else");
  const auto frames = parse_frames_csv(csv, "then");
  ASSERT_EQ(frames.size(), 10u);
  EXPECT_EQ(frames[3].process_cpu_ns, 0);
  EXPECT_EQ(frames[3].submit.end, ledger.frames()[3].submit.end);
}

TEST_F(RunFiles, DamagedRunsAreRefusedByFileAndPlace) {
  write_run(directory_, eventful_run(), some_info());
  const std::string csv = read("frames.csv"), summary = read("summary.json");
  const auto refusal = [&] {
    try {
      read_run(directory_);
    } catch (const BadInput& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  // Cut anywhere in its last line, the table is refused.
  const std::size_t last_line = csv.rfind('\n', csv.size() - 2) + 1;
  for (std::size_t cut = last_line + 1; cut < csv.size(); ++cut) {
    write("frames.csv", csv.substr(0, cut));
    EXPECT_THAT(refusal(), HasSubstr("line 301: the line is cut short")) << cut;
  }
  write("frames.csv", csv.substr(0, 50));
  EXPECT_THAT(refusal(), HasSubstr("line 1"));
  std::string wrong_cell = csv;
  wrong_cell.replace(last_line, 3, "abc");
  write("frames.csv", wrong_cell);
  EXPECT_THAT(refusal(), HasSubstr("'abc' is no value for frame_id"));
  write("frames.csv", "");
  EXPECT_THAT(refusal(), HasSubstr("frames.csv"));
  write("frames.csv", csv);

  for (std::size_t cut = 0; cut + 2 < summary.size(); cut += 97) {
    write("summary.json", summary.substr(0, cut));
    EXPECT_THAT(refusal(), HasSubstr("summary.json")) << cut;
  }
  write("summary.json", "[]");
  EXPECT_THAT(refusal(), HasSubstr("no JSON object"));
  write("summary.json", R"({"schema": 99})");
  EXPECT_THAT(refusal(), HasSubstr("schema 99"));
  write("summary.json", R"({"schema": 1, "warmup_frames": "many"})");
  EXPECT_THAT(refusal(), HasSubstr("\"warmup_frames\" has the wrong type"));
  std::filesystem::remove(directory_ / "summary.json");
  EXPECT_THAT(refusal(), HasSubstr("summary.json"));
}

TEST_F(RunFiles, TraceIsWellFormedAndHoldsEveryCall) {
  const Ledger ledger = eventful_run();
  const json trace = json::parse(trace_json(ledger));
  EXPECT_THAT(test::trace_faults(trace), testing::IsEmpty());
  EXPECT_THAT(test::track_names(trace), testing::ElementsAre("frame thread", "device", "mirror"));
  std::size_t waits = 0, device = 0, missed = 0, discarded = 0;
  for (const json& event : trace["traceEvents"]) {
    waits += event["name"] == "wait" ? 1 : 0;
    device += event["name"] == "gpu_trace" ? 1 : 0;
    missed += event["name"] == "missed 4" ? 1 : 0;
    discarded += event["name"] == "discarded" ? 1 : 0;
  }
  EXPECT_EQ(waits, 300u);
  EXPECT_EQ(device, 300u);
  EXPECT_EQ(missed, 1u);
  EXPECT_EQ(discarded, 1u);

  Ledger uncalibrated;
  FrameRecord frame = synthetic_frame(0);
  frame.clock_calibrated = false;
  uncalibrated.add(frame);
  EXPECT_THAT(trace_json(uncalibrated), Not(HasSubstr("\"gpu_trace\"")));
}

TEST_F(RunFiles, TraceShowsEachLoadOnItsThread) {
  const std::int64_t t = 1'000 * kMs;
  StreamingFacts streaming;
  streaming.loads = {{"hall", 1, 0, "", 1000, 4000, t, t + 1, t + 3, t + 6, t + 10},
                     {"b\"room\xff", 0, 1, "", 10, 40, t, t + 2, t + 3, t + 4, t + 5},
                     {"hall", 2, 0, "damaged", 0, 0, t, t + 10, 0, 0, t + 12},
                     {"attic", 0, 1, "", 10, 40, t, t + 5, t + 5, t + 5, t + 5}};
  const json trace = json::parse(trace_json(eventful_run(), streaming));
  EXPECT_THAT(test::trace_faults(trace), testing::IsEmpty());
  EXPECT_THAT(test::track_names(trace),
              testing::ElementsAre("frame thread", "device", "mirror", "loader 1", "loader 2"));
  std::vector<std::string> hall;
  for (const json& event : trace["traceEvents"]) {
    if (event["ph"] != "X" || event["args"].value("room", "") != "hall") continue;
    hall.push_back(event["name"].get<std::string>() + " " +
                   std::to_string(std::llround(event["dur"].get<double>() * 1e3)));
    if (event["name"] == "load hall level 2") {
      EXPECT_EQ(event["args"]["failure"], "damaged");
      EXPECT_EQ(event["args"]["level"], 2);
      EXPECT_EQ(event["args"]["queued_ns"], 10);
    }
  }
  EXPECT_THAT(hall,
              testing::ElementsAre("load hall level 1 9", "read 2", "decompress 3", "upload 4", "load hall level 2 2"));
  // Loads alone are a trace, too.
  EXPECT_THAT(test::trace_faults(json::parse(trace_json(Ledger{}, streaming))), testing::IsEmpty());
  EXPECT_THAT(test::trace_faults(json::parse(trace_json(Ledger{}))), testing::IsEmpty());
}

TEST_F(RunFiles, ADeviceClockSetAnewTearsNoSpans) {
  Ledger ledger;
  for (std::size_t i = 0; i < 3; ++i) {
    FrameRecord f = synthetic_frame(i);
    if (i == 1) f.gpu.begin = f.gpu_trace.begin = ledger.frames()[0].gpu.end - 30;
    ledger.add(f);
  }
  EXPECT_THAT(test::trace_faults(json::parse(trace_json(ledger))), testing::IsEmpty());
}

TEST(TraceCheck, FindsWhatIsWrong) {
  const json name = {{"name", "thread_name"},  {"ph", "M"}, {"pid", 1}, {"tid", 1}, {"ts", 0},
                     {"args", {{"name", "a"}}}};
  const auto span = [](double ts, double dur) {
    return json{{"name", "s"}, {"ph", "X"}, {"pid", 1}, {"tid", 1}, {"ts", ts}, {"dur", dur}};
  };
  const auto faults = [](const std::vector<json>& events) {
    return test::trace_faults({{"traceEvents", events}}).size();
  };
  EXPECT_EQ(faults({name, span(0, 10), span(2, 8), span(2, 3), span(10, 1)}), 0u);
  EXPECT_EQ(faults({name, span(0, 10), span(2, 8.001)}), 1u);
  EXPECT_EQ(faults({name, span(0, -1)}), 1u);
  EXPECT_EQ(faults({span(0, 1)}), 1u) << "no name";
  EXPECT_EQ(faults({name, name}), 1u) << "two names";
  EXPECT_EQ(faults({{{"name", "c"}, {"ph", "C"}, {"pid", 1}, {"tid", 0}, {"ts", 0}}}), 1u) << "no args";
  EXPECT_EQ(faults({{{"name", "m"}, {"ph", "i"}, {"pid", 1}, {"tid", 1}, {"ts", 0}}}), 1u) << "no scope";
  EXPECT_EQ(faults({{{"name", "m"}, {"ph", "C"}, {"pid", 1}, {"ts", 0}}}), 1u) << "no tid";
  EXPECT_EQ(test::trace_faults(json::array()).size(), 1u);
}

TEST_F(RunFiles, ThePageIsWholeAndSaysWhatItMust) {
  write_run(directory_, eventful_run(), some_info());
  const std::string page = read("index.html");
  for (const char* words : {"Software rasteriser", "llvmpipe (LLVM 19)", "Monado 25.0.0", "budget 10.0 ms",
                            "What is not measured", "record took", "warm-up frames", "prediction_horizon",
                            "n &lt; 10000", "class=\"missed\"", "320 × 240 px", "a &lt;b&gt; &amp; c"}) {
    EXPECT_THAT(page, HasSubstr(words));
  }
  // Self-contained: nothing is fetched from anywhere.
  for (const char* words : {"http:", "https:", "<script src", "<link", "@import", "url("})
    EXPECT_THAT(page, Not(HasSubstr(words)));
  EXPECT_THAT(page, Not(HasSubstr("a <b>")));
  for (const auto& entry : std::filesystem::directory_iterator(directory_)) {
    EXPECT_THAT(entry.path().filename().string(),
                testing::AnyOf("frames.csv", "summary.json", "trace.json", "index.html"));
  }
}

TEST_F(RunFiles, ADirectoryThatCannotBeMadeIsOneClearLine) {
  std::filesystem::create_directories(directory_);
  write("file", "in the way");
  EXPECT_THROW(write_run(directory_ / "file", Ledger{}, some_info()), BadInput);
}

TEST(CommandLine, QuotesWhatAShellWouldSplit) {
  const char* words[] = {"probewalk", "walk", "my house.probes", "--path=it's", ""};
  EXPECT_EQ(command_line(5, words), R"(probewalk walk 'my house.probes' '--path=it'\''s' '')");
}

TEST(MachineInfo, IsReadFromTheMachineAtHand) {
  const MachineInfo machine = read_machine_info();
  EXPECT_GT(machine.cores, 0u);
  EXPECT_GT(machine.memory_bytes, 1u << 20);
  EXPECT_THAT(machine.kernel, HasSubstr("Linux"));
}

}  // namespace
}  // namespace probewalk
