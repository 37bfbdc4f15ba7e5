// Runs the hard cases: every ray through every contender, and each answer against the references.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "content/progress.h"
#include "content/stability/cases.h"
#include "content/stability/places.h"
#include "content/stability/tally.h"

namespace probewalk::stability {

// The contender that is not of this library: the device, or in tests a tracer with a planted fault. Called by one
// thread, case after case; the place stays the same object for all its cases and is alive during the call.
using Contender = std::function<std::vector<Answer>(const Place& place, std::span<const Ray> rays)>;

struct TrialOptions {
  std::uint64_t rays = 20'000'000;  // in all; every case gets its share, and at least kLeastRays
  double tie = kTie;                // see agreement.h
  int threads = 0;                  // 0 = all cores
  Contender device;                 // empty = none
  std::function<void(const HardCase&)> started;  // told of every case before its first ray; may be empty
};

inline constexpr std::uint64_t kLeastRays = 64;
// Rays that meet brute force, where there are so many: together at places of up to 128 cells a side, and of more.
inline constexpr std::uint64_t kBruteRays = 1'200'000;
inline constexpr std::uint64_t kBruteRaysFine = 120'000;

struct CaseResult {
  HardCase hard;
  std::string place;
  int cells = 0;  // a side
  CaseTally tally;
};

// How many rays each case gets, and how many of them meet brute force.
struct CasePlan {
  std::uint64_t rays = 0;
  std::uint64_t brute_rays = 0;
};
std::vector<CasePlan> plan_rays(const std::vector<HardCase>& cases, std::uint64_t rays);

// The same rays and the same numbers for the same options, however many threads. Throws Interrupted when asked to stop.
std::vector<CaseResult> run_cases(const std::vector<HardCase>& cases, const TrialOptions& options, Progress& progress);

// One line a check that does not hold; empty = all hold.
std::vector<std::string> failures(const CaseResult& result);

}  // namespace probewalk::stability
