// The hard cases by name, at small counts: the same rays and checks as `probewalk stability`. And that the checks can
// fail: each planted fault is found.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "content/error.h"
#include "content/stability/agreement.h"
#include "content/stability/cases.h"
#include "content/stability/low_discrepancy.h"
#include "content/stability/results.h"
#include "content/stability/trial.h"
#include "render/walk_batch.h"

namespace probewalk::stability {
namespace {

using ::testing::HasSubstr;

std::vector<HardCase> cases_at(PlaceId place) {
  std::vector<HardCase> cases = hard_cases();
  std::erase_if(cases, [&](const HardCase& hard) { return hard.place != place; });
  return cases;
}

// The device as contender; places come one after the other.
Contender on(WalkBatch& batch) {
  return [&batch, last = std::string()](const Place& place, std::span<const Ray> rays) mutable {
    if (const std::string name = place.name + std::to_string(place.geometry.n); last != name) {
      batch.set_probe(place.device);
      last = name;
    }
    std::vector<WalkRay> words;
    for (const Ray& ray : rays)
      words.push_back({ray.origin_hi_m, ray.t_start, ray.origin_lo_m, 0.0f, ray.direction, 0.0f});
    std::vector<Answer> answers;
    for (const WalkEnd& end : batch.walk(words, kStartLevel)) {
      answers.push_back({end.status, end.t, end.t_safe, glm::dvec3(end.plane), end.lookups});
    }
    return answers;
  };
}

// A cell beyond the fold that such a ray touches says nothing, and nothing of it may stay: the first of these rays took
// the cuts of one for those of the next cell it looked at.
TEST(HardCases, ARayAlongTheFoldForgetsWhatLiesBeyondIt) {
  const std::unique_ptr<Place> place = make_place(PlaceId::kRoom);
  std::vector<std::pair<glm::dvec3, glm::dvec3>> rays{
      {{-0.06397001445293427, -0.4842566251754761, 0.0}, {1.0, 0.0, 0.0}}};
  for (std::uint32_t k = 0; k < 20000; ++k) {  // in the plane of the probe's horizon, half of them along an axis
    const double turn_rad = k % 2 == 0 ? 0.0 : 2.0 * std::numbers::pi * radical_inverse(k);
    rays.push_back({{3.0 * radical_inverse(k + 70000) - 1.5, 2.0 * radical_inverse(3 * k + 1) - 1.0, 0.0},
                    {std::cos(turn_rad), std::sin(turn_rad), 0.0}});
  }
  int hits = 0;
  for (const auto& [x, d] : rays) {
    const Answer flat = walk_in_double(place->record, x, d, 0.0, 0);
    const Answer pyramid = walk_in_double(place->record, x, d, 0.0, kStartLevel + kWithoutPlanes);
    EXPECT_TRUE(pyramid.same_bits(flat)) << class_name(flat.cls) << " at " << flat.t << ", " << class_name(pyramid.cls)
                                         << " at " << pyramid.t;
    hits += flat.cls == kClassHit;
  }
  const auto& [x, d] = rays.front();
  EXPECT_NEAR(walk_in_double(place->record, x, d, 0.0, 0).t, place->brute.trace(x, d).t, 1e-9);
  EXPECT_GT(hits, 5000);
}

TEST(HardCases, HoldOnTheDeviceAndInFloatAndInDouble) {
  const Device device({}, {});
  WalkBatch batch(device);
  TrialOptions options;
  options.rays = PROBEWALK_SANITIZED ? 12000 : 60000;
  options.device = on(batch);
  SilentProgress silent;
  const std::vector<CaseResult> results = run_cases(hard_cases(), options, silent);
  for (const CaseResult& result : results) {
    EXPECT_THAT(failures(result), ::testing::IsEmpty());
    EXPECT_EQ(result.tally.rays, result.tally.device_rays);
    if (!result.hard.hostile) {
      EXPECT_GE(result.tally.float_brute.rays, kLeastRays) << result.hard.name;
    }
    // Where nothing is torn or degenerate, rays have answers, and few are ties. Among leaves most begin behind one.
    if (result.hard.name == "random" && result.cells == 128) {
      EXPECT_LT(result.tally.float_brute.ties, result.tally.rays / 100) << result.place;
      EXPECT_GT(result.tally.classes[kClassHit] + result.tally.classes[kClassBehind], result.tally.rays / 4)
          << result.place;
    }
  }
}

TEST(HardCases, AnyPyramidLevelGivesTheSameBits) {
  for (const PlaceId id : {PlaceId::kRoom, PlaceId::kGrille, PlaceId::kLeaves, PlaceId::kTorn, PlaceId::kLeast}) {
    const std::unique_ptr<Place> place = make_place(id);
    for (const HardCase& hard : cases_at(id)) {
      Random random(11);
      const int count =
          hard.name == "random" ? (PROBEWALK_SANITIZED ? 3000 : 30000) : (PROBEWALK_SANITIZED ? 200 : 1500);
      for (int k = 0; k < count; ++k) {
        Ray ray = hard.ray(random, *place);
        if (k % 3 == 0) ray.t_start = static_cast<float>(random(0, 2));
        const Answer flat = walk_in_float(place->record, ray, 0);
        for (const int level : {1, 2, 3, kStartLevel, 7}) {
          ASSERT_TRUE(walk_in_float(place->record, ray, level + kWithoutPlanes).same_bits(flat))
              << place->name << ", " << hard.name << " ray " << k << " level " << level;
        }
      }
    }
  }
}

// Thesis 4.3: a ray that runs exactly straight away from a probe sees what the probe sees in its direction.
TEST(HardCases, ARayStraightAwayFromAProbeTakesOneLookupAndIsExact) {
  for (const PlaceId id : {PlaceId::kRoom, PlaceId::kGrille, PlaceId::kRoomFine}) {
    const std::unique_ptr<Place> place = make_place(id);
    const std::vector<HardCase> cases = cases_at(id);
    const auto radial = std::find_if(cases.begin(), cases.end(), [](const HardCase& hard) { return hard.one_lookup; });
    ASSERT_NE(radial, cases.end());
    Random random(5);
    int hits = 0;
    for (int k = 0; k < 20000; ++k) {
      const Ray ray = radial->ray(random, *place);
      const Answer answer = walk_in_float(place->record, ray, kStartLevel);
      ASSERT_EQ(answer.lookups, 1u);
      if (answer.cls != kClassHit) continue;
      ++hits;
      // The distance that the map's plane has in that direction; what the plane's own rounding makes of it grows as the
      // ray grazes the plane.
      const glm::dvec3 x = exact_origin(place->record, ray), d(ray.direction);
      const double exact = (1.0 - glm::dot(answer.plane, x)) / glm::dot(answer.plane, d);
      const double grazing = glm::length(answer.plane) / std::abs(glm::dot(answer.plane, d));
      ASSERT_NEAR(answer.t, exact, 2e-6 * grazing * (exact + glm::length(x)));
    }
    EXPECT_GT(hits, 5000) << place->name;
  }
}

TEST(HardCases, BruteForceLooksAtEveryPieceThatCounts) {
  for (const PlaceId id : {PlaceId::kTorn, PlaceId::kLeast, PlaceId::kTiny, PlaceId::kSolid, PlaceId::kSky}) {
    const std::unique_ptr<Place> place = make_place(id);
    const std::vector<HardCase> kinds = cases_at(PlaceId::kRoom);
    for (const HardCase& hard : kinds) {
      if (hard.hostile) continue;
      Random random(3);
      for (int k = 0; k < 12; ++k) {
        const Ray ray = hard.ray(random, *place);
        const glm::dvec3 x = exact_origin(place->record, ray), d(ray.direction);
        const BruteAnswer fast = place->brute.trace(x, d, ray.t_start);
        const BruteAnswer slow = place->brute.trace_every_piece(x, d, ray.t_start);
        ASSERT_EQ(static_cast<int>(fast.cls), static_cast<int>(slow.cls))
            << place->name << ", " << hard.name << " ray " << k;
        ASSERT_EQ(fast.t, slow.t) << place->name << ", " << hard.name << " ray " << k;
      }
    }
  }
}

// ---- The checks can fail

// C++ float with one answer in a hundred spoilt.
Contender spoilt(std::function<void(Answer&)> spoil) {
  return [spoil](const Place& place, std::span<const Ray> rays) {
    std::vector<Answer> answers;
    for (std::size_t k = 0; k < rays.size(); ++k) {
      answers.push_back(walk_in_float(place.record, rays[k], kStartLevel));
      if (k % 100 == 7) spoil(answers.back());
    }
    return answers;
  };
}

std::string first_failure(std::function<void(Answer&)> spoil) {
  std::vector<HardCase> cases = cases_at(PlaceId::kSteps);
  TrialOptions options;
  options.rays = 2000;
  options.device = spoilt(std::move(spoil));
  SilentProgress silent;
  const std::vector<std::string> lines = all_failures(run_cases(cases, options, silent));
  return lines.empty() ? "" : lines.front();
}

TEST(HardCases, PlantedFaultsAreFound) {
  EXPECT_EQ(first_failure([](Answer&) {}), "");
  EXPECT_THAT(first_failure([](Answer& a) { a.t *= 1.05; }), HasSubstr("beyond ties"));
  EXPECT_THAT(first_failure([](Answer& a) { a.cls = a.cls == kClassHit ? kClassMiss : kClassHit; }),
              HasSubstr("beyond ties"));
  EXPECT_THAT(first_failure([](Answer& a) { a.plane.x = std::numeric_limits<double>::quiet_NaN(); }), HasSubstr("NaN"));
  EXPECT_THAT(first_failure([](Answer& a) { a.lookups = 1u << 20; }), HasSubstr("more look-ups"));
}

TEST(HardCases, ANarrowerTieFails) {
  std::vector<HardCase> cases = cases_at(PlaceId::kGrille);
  TrialOptions options;
  options.rays = 20000;
  options.tie = 1e-15;
  SilentProgress silent;
  EXPECT_FALSE(all_failures(run_cases(cases, options, silent)).empty());
}

TEST(HardCases, TheNumbersDoNotDependOnThreads) {
  const std::vector<HardCase> cases = cases_at(PlaceId::kTorn);
  TrialOptions options;
  options.rays = 3000;
  SilentProgress silent;
  options.threads = 1;
  const TrialInfo info;
  const auto one = results_json(info, run_cases(cases, options, silent));
  options.threads = 0;
  EXPECT_EQ(one, results_json(info, run_cases(cases, options, silent)));
}

TEST(HardCases, StopsWhenAsked) {
  class Impatient final : public Progress {
   public:
    void begin(std::string_view, std::uint64_t, std::string_view) override {}
    void advance(std::uint64_t) override { ++advanced; }
    void note(std::string_view) override {}
    bool cancelled() const override { return advanced > 0; }
    int advanced = 0;
  } progress;
  TrialOptions options;
  options.rays = 1000;
  EXPECT_THROW(run_cases(hard_cases(), options, progress), Interrupted);
}

TEST(HardCases, EveryRayFindsItsCase) {
  std::uint64_t asked = 0, brute = 0, brute_fine = 0;
  const std::vector<HardCase> cases = hard_cases();
  const std::vector<CasePlan> plans = plan_rays(cases, 20'000'000);
  for (std::size_t k = 0; k < cases.size(); ++k) {
    asked += plans[k].rays;
    (place_cells(cases[k].place) > 128 ? brute_fine : brute) += plans[k].brute_rays;
    EXPECT_LE(plans[k].brute_rays, plans[k].rays);
  }
  EXPECT_NEAR(static_cast<double>(asked), 2e7, 1e4);
  EXPECT_GE(brute, 1'000'000u);
  EXPECT_GE(brute_fine, 100'000u);
}

// A reference whose way ends at t = 1, on something so long along the ray.
Reference ends_over(double length) {
  return [length](glm::dvec3, glm::dvec3, double t_start) {
    Answer answer;
    if (t_start <= 1.0) {
      answer.t = answer.t_safe = 1.0;
    } else if (t_start < 1.0 + length) {
      answer.cls = kClassBehind;
      answer.t = answer.t_safe = t_start;
    } else {
      answer.cls = kClassHit;
      answer.t = answer.t_safe = 2.0;
    }
    return answer;
  };
}

TEST(Tie, IsACornerThatIsCrossedOverLessThanRoundingKnows) {
  Answer beyond, elsewhere;
  beyond.cls = elsewhere.cls = kClassHit;
  beyond.t = 2.0;
  elsewhere.t = 3.0;
  const glm::dvec3 x(0.1, 0.2, 0.3), d(0.0, 0.0, 1.0);
  EXPECT_TRUE(is_tie(ends_over(1e-7), x, d, 0.0, beyond, 1.0));
  EXPECT_FALSE(is_tie(ends_over(1e-7), x, d, 0.0, elsewhere, 1.0)) << "nor does the reference say that";
  EXPECT_FALSE(is_tie(ends_over(1e-4), x, d, 0.0, beyond, 1.0)) << "more than a corner";
  EXPECT_FALSE(is_tie(ends_over(10.0), x, d, 0.0, beyond, 1.0)) << "a wall";
}

}  // namespace
}  // namespace probewalk::stability
