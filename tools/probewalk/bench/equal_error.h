// The product against the marches where both are equally wrong, and what the project set out to reach. Pure functions of
// the rows.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/probewalk/bench/scene_report.h"

namespace probewalk::bench {

// Which error is held equal.
enum class EqualBy {
  kMedian,  // hit_error_p50
  kFailed,  // wrong_surface_fraction + hole_fraction
};

// One march beside the product at an error that both reach.
struct EqualError {
  std::string march;
  EqualBy by = EqualBy::kFailed;
  double error = 0.0;        // that both have
  double speed_ratio = 0.0;  // the march's time over the product's: above 1 the product is faster
  // Whether the march gets as good as the product's default. If not, `error` is the march's own best, at `march_size`,
  // and the product's time is that of its cheapest settings that are at least as good.
  bool reached = false;
  int march_size = 0;  // of its largest maps measured
};

// Each march of the rows by each error; empty without triangles. Between measured sizes nothing is guessed beyond them.
std::vector<EqualError> equal_errors(const std::vector<BenchRow>& rows);
// The march that does best against the product by that error.
std::optional<EqualError> best_march(const std::vector<EqualError>& all, EqualBy by);

// Clutter is where the product needs more than 1.25 walks a ray although it asks only probes that see the current point.
bool is_clutter(const SceneReport& report);

enum class Verdict { kReached, kNotReached, kNotMeasured };

struct Goal {
  std::string scene;
  std::string aim;     // what was to be reached
  std::string result;  // what was
  Verdict verdict = Verdict::kNotMeasured;
};

std::vector<Goal> goals_of(const SceneReport& report);

}  // namespace probewalk::bench
