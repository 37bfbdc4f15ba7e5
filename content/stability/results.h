// The hard cases' results as files: rows for programs, and the words of the page.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "content/stability/trial.h"

namespace probewalk::stability {

// What was run, beside the rows.
struct TrialInfo {
  std::string command;
  std::string build;
  std::string device;  // name and driver
  std::string cpu;
  std::string system;
  std::string started_utc;
  double seconds = 0.0;
  double tie = kTie;
  std::uint64_t rays_asked = 0;
};

// {schema, machine, ..., totals, failures, cases: [row, ...]}
nlohmann::ordered_json results_json(const TrialInfo& info, const std::vector<CaseResult>& results);
// A line a case, with a heading; the same names as in the JSON, nested ones joined by a dot.
std::string results_csv(const std::vector<CaseResult>& results);
// A few sentences for people: what was asked, what came out, and what failed.
std::vector<std::string> summary(const TrialInfo& info, const std::vector<CaseResult>& results);

// All cases as one.
CaseTally totals(const std::vector<CaseResult>& results);
std::vector<std::string> all_failures(const std::vector<CaseResult>& results);

}  // namespace probewalk::stability
