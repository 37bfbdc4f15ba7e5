// How far answers are from what is right. Three errors, kept apart: the tracer's (against exact intersection of the same
// probe data), the data's (against the triangles), and the picture's (as an eye sees it).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "content/image/image.h"
#include "content/probe/probe_set.h"
#include "shaders/shared/ray_batch.h"
#include "shaders/shared/selection_rules.h"
#include "tools/probewalk/bench/bench_row.h"
#include "tools/probewalk/bench/bench_views.h"

namespace probewalk::bench {

// A distance that is off by more is another surface, or the wrong place on it.
inline constexpr double kWrongDistance = 0.02;
// Beyond this two answers of the same data are looked at more closely: a tie, or a disagreement.
inline constexpr double kSameDistance = 1e-4;

// Look-ups, attribute reads, walks, holes, answers that are no numbers.
void fill_counts(BenchRow& row, std::span<const BatchAnswer> answers);
// truth_m: distance along each ray to the nearest triangle, infinity = none.
void fill_hit_errors(BenchRow& row, std::span<const BatchAnswer> answers, std::span<const float> truth_m);

// What exact arithmetic answers on the same probes by the same rules.
struct ExactAnswer {
  int cls = 0;
  double t_m = 0.0;
};

// The tracer in double, cell by cell, from the text that the device runs: the probes' reference (what judges that text is
// the brute force of `probewalk stability`).
class DoubleWalker {
 public:
  DoubleWalker(const ProbeSet& probes, const TraceConstants& dials, const SelectionRules& rules)
      : probes_(probes), dials_(dials), rules_(rules) {}
  static constexpr const char* kName = "double precision, cell by cell";

  ExactAnswer trace(const WorldRay& ray) const;
  std::vector<ExactAnswer> trace(std::span<const WorldRay> rays) const;
  // Whether the answer is right for a ray within rounding of this one: there the exact answer jumps.
  bool is_tie(const WorldRay& ray, const BatchAnswer& answer) const;

 private:
  ExactAnswer trace(glm::dvec3 origin_m, glm::dvec3 direction) const;

  const ProbeSet& probes_;
  TraceConstants dials_;
  SelectionRules rules_;
};

void fill_tracer_errors(BenchRow& row, std::span<const BatchAnswer> answers, std::span<const ExactAnswer> exact,
                        const DoubleWalker& walker, std::span<const WorldRay> rays);

// The pictures of all views, and their differences from the reference.
struct PictureError {
  std::vector<ImageRgb8> shown;            // a view each
  std::vector<float> flip;                 // mean, a view each
  std::vector<std::vector<float>> maps;    // FLIP a pixel, a view each
  double psnr_db = 0.0;                    // over all views; infinite for equal ones
  std::size_t worst = 0;                   // view with the highest FLIP

  double flip_mean() const;
};

PictureError picture_error(std::span<const BatchAnswer> answers, const ViewRays& rays,
                           const std::vector<ImageRgb8>& reference, float exposure_ev);

// How the answers of two settings to the same rays differ.
struct Identity {
  double identical_fraction = 0.0;      // same class, probe, and distance to the last bit
  std::uint64_t class_changes = 0;
  double worst_distance_change = 0.0;   // relative, over hits in both
  std::uint64_t distance_changes = 0;   // of those, by more than 1e-5
};
Identity identity_of(std::span<const BatchAnswer> a, std::span<const BatchAnswer> b);

}  // namespace probewalk::bench
