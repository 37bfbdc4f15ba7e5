#include "content/stability/trial.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "content/error.h"

namespace probewalk::stability {

namespace {

// Rays that are in memory at once; a chunk's rays follow from its number alone.
constexpr std::uint64_t kChunk = 1u << 13;

// FNV-1a.
std::uint64_t hash_of(const std::string& text) {
  std::uint64_t hash = 0xcbf29ce484222325ull;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
  return hash;
}

// Compares one ray's answers.
class Judge {
 public:
  Judge(const HardCase& hard, const Place& place, double tie) : hard_(hard), place_(place), tie_(tie) {}

  void judge(const Ray& ray, std::uint64_t index, const Answer* device, bool brute, CaseTally& tally) const {
    const ProbeRecord& record = place_.record;
    const glm::dvec3 x = exact_origin(record, ray), d(ray.direction);
    const double t_start = ray.t_start;
    const Answer single = walk_in_float(record, ray, kStartLevel);
    const Answer flat = walk_in_float(record, ray, 0);
    const Answer skipping = walk_in_float(record, ray, kStartLevel + kWithoutPlanes);
    ++tally.rays;
    ++tally.classes[static_cast<std::size_t>(single.cls) % kClasses];
    tally.hierarchical_differs += !skipping.same_bits(flat);
    tally.lookups += single.lookups;
    tally.lookups_max = std::max(tally.lookups_max, single.lookups);
    tally.more_than_one += hard_.one_lookup && single.lookups > 1;
    count_soundness(single, kStartLevel, tally);
    count_soundness(flat, 0, tally);
    count_soundness(skipping, kStartLevel, tally);
    if (device) {
      count_soundness(*device, kStartLevel, tally);
      ++tally.device_rays;
      tally.device_same_bits += device->same_bits(single) && device->lookups == single.lookups;
    }

    const Answer twice = walk_in_double(record, x, d, t_start, 0);
    const Reference double_walk = [&](glm::dvec3 at, glm::dvec3 towards, double from) {
      return walk_in_double(record, at, towards, from, 0);
    };
    const bool as_single = device && device->same_bits(single);
    // What the device answers as C++ float does is not asked twice.
    std::optional<bool> single_ties;
    const auto against = [&](const Reference& reference, const Answer& answer) {
      return [&] {
        if (hard_.hostile) return false;
        if (&answer != &single && !(as_single && &answer == device))
          return is_tie(reference, x, d, t_start, answer, place_.scale_m, tie_);
        if (!single_ties) single_ties = is_tie(reference, x, d, t_start, single, place_.scale_m, tie_);
        return *single_ties;
      };
    };
    tally.float_double.add(ray, index, single, twice, place_.scale_m, against(double_walk, single));
    tally.float_flat.add(ray, index, single, flat, place_.scale_m, against(double_walk, single));
    const Answer twice_by_planes = walk_in_double(record, x, d, t_start, kStartLevel);
    tally.double_planes.add(ray, index, twice_by_planes, twice, place_.scale_m, against(double_walk, twice_by_planes));
    if (device) {
      tally.device_double.add(ray, index, *device, twice, place_.scale_m, against(double_walk, *device));
      // A tie here: double, too, may answer as the device does.
      tally.device_float.add(ray, index, *device, single, place_.scale_m, against(double_walk, *device));
    }
    if (!brute || hard_.hostile) return;
    const Reference by_force = [&](glm::dvec3 at, glm::dvec3 towards, double from) {
      return from_brute_force(place_.brute.trace(at, towards, from));
    };
    const Answer truth = by_force(x, d, t_start);
    single_ties.reset();
    tally.float_brute.add(ray, index, single, truth, place_.scale_m, against(by_force, single));
    if (device) tally.device_brute.add(ray, index, *device, truth, place_.scale_m, against(by_force, *device));
    tally.double_brute.add(ray, index, twice, truth, place_.scale_m, against(by_force, twice));
  }

 private:
  void count_soundness(const Answer& answer, int start_level, CaseTally& tally) const {
    tally.not_finite += !answer.is_finite();
    tally.endless += answer.lookups > most_lookups(place_.record, start_level);
  }

  const HardCase& hard_;
  const Place& place_;
  double tie_;
};

// Rays first .. first + count of a case. Those that meet brute force are spread evenly over the case, so that the time
// left can be told.
CaseTally judge_chunk(const HardCase& hard, const Place& place, const TrialOptions& options, const CasePlan& plan,
                      std::uint64_t first, std::uint64_t count, std::uint64_t seed, Progress& progress) {
  const auto meets_brute_force = [&](std::uint64_t index) {
    return (index + 1) * plan.brute_rays / plan.rays != index * plan.brute_rays / plan.rays;
  };
  Random random(seed);
  std::vector<Ray> rays;
  rays.reserve(count);
  for (std::uint64_t k = 0; k < count; ++k) rays.push_back(hard.ray(random, place));
  std::vector<Answer> device;
  if (options.device) device = options.device(place, rays);
  const Judge judge(hard, place, options.tie);
  return tbb::parallel_reduce(
      tbb::blocked_range<std::uint64_t>(0, count, 64), CaseTally{},
      [&](const tbb::blocked_range<std::uint64_t>& range, CaseTally tally) {
        if (progress.cancelled()) return tally;  // a chunk half done is thrown away
        for (std::uint64_t k = range.begin(); k < range.end(); ++k) {
          judge.judge(rays[k], first + k, options.device ? &device.at(k) : nullptr, meets_brute_force(first + k),
                      tally);
        }
        progress.advance(range.size());
        return tally;
      },
      [](CaseTally a, const CaseTally& b) {
        a.merge(b);
        return a;
      });
}

}  // namespace

std::vector<CasePlan> plan_rays(const std::vector<HardCase>& cases, std::uint64_t rays) {
  double weight = 0.0, weight_brute[2] = {0.0, 0.0};
  for (const HardCase& hard : cases) {
    weight += hard.weight;
    if (!hard.hostile) weight_brute[place_cells(hard.place) > 128] += hard.weight;
  }
  std::vector<CasePlan> plans;
  for (const HardCase& hard : cases) {
    const bool fine = place_cells(hard.place) > 128;
    CasePlan plan;
    plan.rays = std::max(kLeastRays, static_cast<std::uint64_t>(static_cast<double>(rays) * hard.weight / weight));
    const double brute = static_cast<double>(fine ? kBruteRaysFine : kBruteRays) * hard.weight / weight_brute[fine];
    if (!hard.hostile) plan.brute_rays = std::min(plan.rays, static_cast<std::uint64_t>(brute));
    plans.push_back(plan);
  }
  return plans;
}

std::vector<CaseResult> run_cases(const std::vector<HardCase>& cases, const TrialOptions& options, Progress& progress) {
  std::optional<tbb::global_control> limit;
  if (options.threads > 0) {
    limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(options.threads));
  }
  const std::vector<CasePlan> plans = plan_rays(cases, options.rays);
  std::uint64_t total = 0;
  for (const CasePlan& plan : plans) total += plan.rays;
  progress.begin("hard cases", total, "rays");
  std::vector<CaseResult> results;
  std::unique_ptr<Place> place;
  for (std::size_t c = 0; c < cases.size(); ++c) {
    if (c == 0 || cases[c].place != cases[c - 1].place) {
      place.reset();
      place = make_place(cases[c].place);
    }
    if (options.started) options.started(cases[c]);
    CaseResult result{cases[c], place->name, place->geometry.n, {}};
    for (std::uint64_t first = 0; first < plans[c].rays; first += kChunk) {
      const std::uint64_t count = std::min(kChunk, plans[c].rays - first);
      // Seeded by the case's name, so that other cases added or left out change nothing.
      const std::uint64_t seed =
          hash_of(fmt::format("{} {} {}", cases[c].name, place->name, place->geometry.n)) + first / kChunk;
      result.tally.merge(judge_chunk(cases[c], *place, options, plans[c], first, count, seed, progress));
      if (progress.cancelled()) throw Interrupted("interrupted; nothing has been written");
    }
    result.tally.lookups_bound = most_lookups(place->record, kStartLevel);
    results.push_back(std::move(result));
  }
  return results;
}

std::vector<std::string> failures(const CaseResult& result) {
  std::vector<std::string> lines;
  const CaseTally& tally = result.tally;
  const std::string where = fmt::format("{} at {} ({} cells a side)", result.hard.name, result.place, result.cells);
  const auto fail = [&](std::uint64_t count, const std::string& what) {
    if (count > 0) lines.push_back(fmt::format("{}: {} {}", where, count, what));
  };
  const auto beyond = [&](const Comparison& comparison, const char* contender, const char* reference) {
    fail(comparison.beyond_ties(), fmt::format("rays of {} disagree with {} beyond ties", contender, reference));
  };
  fail(tally.not_finite, "answers hold a NaN or an infinity");
  fail(tally.endless, "walks took more look-ups than there can be");
  fail(tally.hierarchical_differs, "answers change with the pyramid, its planes left aside");
  fail(tally.more_than_one, "rays straight away from the probe took more than one look-up");
  beyond(tally.float_double, "float", "the double walk");
  beyond(tally.float_flat, "float by pyramid and planes", "float cell by cell");
  beyond(tally.double_planes, "double by pyramid and planes", "double cell by cell");
  if (tally.double_planes.errors.max() > double{kPlaneError} * 1.001) {
    lines.push_back(fmt::format("{}: planes change a distance by {:.1e}, more than the {:.0e} allowed", where,
                                tally.double_planes.errors.max(), kPlaneError));
  }
  beyond(tally.device_double, "the device", "the double walk");
  beyond(tally.device_float, "the device", "C++ float");
  beyond(tally.float_brute, "float", "brute force");
  beyond(tally.device_brute, "the device", "brute force");
  beyond(tally.double_brute, "double", "brute force");
  if (result.hard.hostile) {
    fail(tally.rays - tally.classes[kClassUnknown], "answers claim to know something of a ray that is none");
  }
  return lines;
}

}  // namespace probewalk::stability
