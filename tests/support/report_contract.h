// The keys that other programs find in a run's summary.json, whatever was walked.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace probewalk::test {

inline void expect_contract(const nlohmann::json& summary) {
  for (const char* key : {"schema",         "command",
                          "machine",        "device",
                          "runtime",        "display",
                          "eye_width",      "eye_height",
                          "views",          "method",
                          "period_ns",      "frames",
                          "warmup_frames",  "missed",
                          "discarded",      "not_rendered",
                          "stale_run_max",  "within_budget_fraction",
                          "clock_error_ns", "instrumentation_cost_fraction",
                          "percentiles",    "streaming"}) {
    ASSERT_TRUE(summary.contains(key)) << key;
  }
  for (const char* quantity : {"frame", "cpu_busy", "cpu_wait", "gpu_busy", "gpu_trace", "prediction_horizon",
                               "deadline_margin", "pose_error_mm", "pose_error_deg"}) {
    ASSERT_TRUE(summary["percentiles"].contains(quantity)) << quantity;
    for (const char* key : {"n", "p50", "p90", "p95", "p99", "p999", "max"}) {
      EXPECT_TRUE(summary["percentiles"][quantity].contains(key)) << quantity << " " << key;
    }
  }
  for (const char* key : {"bytes", "rooms_loaded", "coarse_frame_fraction", "coarse_run_max", "coarse_run_max_ns",
                          "need_to_resident_p50_ns", "need_to_resident_p99_ns", "frame_thread_p99_ns",
                          "device_bytes_max", "device_budget_bytes"}) {
    EXPECT_TRUE(summary["streaming"].contains(key)) << key;
  }
}

}  // namespace probewalk::test
