#include "content/bake/plan/planner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "content/bake/bake_job.h"
#include "content/bake/plan/plan_report.h"
#include "content/error.h"
#include "content/pack/file_io.h"
#include "content/pack/pack_io.h"
#include "content/probe/probe_set.h"
#include "content/probe/tracer_f32.h"
#include "content/scene/procedural/procedural.h"
#include "support/low_discrepancy.h"
#include "support/test_bake.h"

namespace probewalk {
namespace {

namespace fs = std::filesystem;
using test::bake_quietly;
using test::files_below;

class Planner : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::path(PROBEWALK_TEST_OUTPUT_DIR) / "planner" / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }

  BakeOptions options(const std::string& scene, const std::string& pack, double error) const {
    BakeOptions o;
    o.scene_file = folder_ / (scene + ".glb");
    if (!fs::exists(o.scene_file)) write_file_whole(o.scene_file, make_procedural_glb(scene));
    o.pack = folder_ / (pack + ".probes");
    o.target.error = error;
    o.target.effort = 0.3;
    o.light.samples = 8;
    o.light.bounces = 1;
    return o;
  }

  // Share of rays wrong or holes, from eyes along the tour in all directions: counted here, not by the planner.
  static double lost_rays(const BakeOptions& o) {
    const Pack pack = Pack::open(o.pack);
    const Scene scene = load_scene(o.scene_file);
    const RayScene triangles(scene);
    const ProbeSet probes = ProbeSet::read(pack);
    const TraceConstants dials = default_dials(pack.manifest().radiance_scale);
    constexpr int kRays = 6000;
    int lost = 0;
    for (int k = 0; k < kRays; ++k) {
      const std::vector<Pose>& tour = pack.manifest().tour;
      const glm::vec3 eye(tour[std::size_t(k) * 31 % tour.size()].position_m);
      const glm::vec3 direction(test::hammersley_direction(k, kRays));
      const SurfaceHit truth = triangles.closest(eye, direction);
      const f32::RayAnswer answer = f32::trace_ray(probes.grid(), dials, eye, glm::vec3(0.0f), direction, kStartLevel);
      const bool right = truth.hit ? answer.cls == kClassHit && std::abs(answer.t - truth.t) <= 0.02f * truth.t
                                   : answer.cls == kClassMiss;
      lost += !right;
    }
    return double(lost) / kRays;
  }

  fs::path folder_;
};

TEST_F(Planner, GivesAPlainRoomTwoSmallProbesAtMost) {
  const BakeOptions o = options("box-room", "a", 0.08);
  const BakeReport report = bake_quietly(o);
  ASSERT_TRUE(report.planned.has_value());
  EXPECT_TRUE(report.planned->kept);
  EXPECT_LE(report.planned->held_back.flip, 0.08);
  EXPECT_LE(report.planned->held_back.lost(), 0.08);
  EXPECT_GT(report.planned->held_back_rays, 300u);
  EXPECT_LE(report.probes, 2u);
  EXPECT_LT(report.bytes_disk, 300'000u);
  SilentProgress progress;
  EXPECT_TRUE(Pack::open(o.pack).verify(progress).empty());
  EXPECT_LE(lost_rays(o), 0.08 * 1.25) << "other eyes and directions than the planner's see much the same";
}

TEST_F(Planner, PaysForALowerErrorWithBytes) {
  const BakeReport coarse = bake_quietly(options("two-rooms", "coarse", 0.15));
  const BakeReport fine = bake_quietly(options("two-rooms", "fine", 0.06));
  EXPECT_LT(coarse.bytes_disk, fine.bytes_disk);
  EXPECT_GT(coarse.planned->held_back.worst(), fine.planned->held_back.worst());
  for (const PlannedRoom& room : fine.planned->rooms) EXPECT_FALSE(room.probes_m.empty()) << room.id;
}

TEST_F(Planner, GivesEveryRoomAProbeBeforeAnyHasTwo) {
  BakeOptions few = options("two-rooms", "few", 0.02);
  few.target.most_geometry = few.target.most_radiance = 32;
  few.target.most_probes = 2;
  const BakeReport two = bake_quietly(few);
  EXPECT_EQ(two.probes, 2u);
  for (const PlannedRoom& room : two.planned->rooms) EXPECT_EQ(room.probes_m.size(), 1u) << room.id;
  BakeOptions fewest = few;
  fewest.pack = folder_ / "fewest.probes";
  fewest.target.most_probes = 1;
  bake_quietly(fewest);
  const std::vector<std::string> warnings = Pack::open(fewest.pack).manifest().warnings;
  const auto named = std::count_if(warnings.begin(), warnings.end(), [](const std::string& warning) {
    return warning.find("1 of 2 rooms with floor have no probe") != std::string::npos;
  });
  EXPECT_EQ(named, 1);
}

TEST_F(Planner, KeepsToABudget) {
  BakeOptions little = options("two-rooms", "little", 0.0), more = options("two-rooms", "more", 0.0);
  little.target.budget_bytes = 60'000;
  more.target.budget_bytes = 400'000;
  const BakeReport least = bake_quietly(little), most = bake_quietly(more);
  EXPECT_LE(least.bytes_disk, little.target.budget_bytes);
  EXPECT_LE(most.bytes_disk, more.target.budget_bytes);
  EXPECT_LT(most.planned->held_back.worst(), least.planned->held_back.worst());
}

TEST_F(Planner, MakesTheSameBytesWhateverTheThreads) {
  BakeOptions one = options("two-rooms", "one", 0.12), two = options("two-rooms", "two", 0.12);
  one.light.threads = 1;
  two.light.threads = 2;
  bake_quietly(one);
  bake_quietly(two);
  EXPECT_EQ(files_below(one.pack), files_below(two.pack));
}

TEST_F(Planner, SaysWhatItChoseAndWhatCoarserWouldHaveCost) {
  const BakeOptions o = options("box-room", "a", 0.08);
  const BakeReport report = bake_quietly(o);
  std::ifstream file(report.plan_file);
  const nlohmann::json json = nlohmann::json::parse(file);
  EXPECT_EQ(json.at("target_error"), 0.08);
  ASSERT_EQ(json.at("rooms").size(), 1u);
  const nlohmann::json& room = json.at("rooms")[0];
  EXPECT_EQ(room.at("probes"), report.probes);
  ASSERT_FALSE(room.at("next_coarser").empty());
  for (const nlohmann::json& choice : room.at("next_coarser")) {
    const double flip = choice.at("error").at("flip"), wrong = choice.at("error").at("wrong"),
                 hole = choice.at("error").at("hole");
    const double error = std::max(flip, wrong + hole);
    EXPECT_GT(error, report.planned->rooms[0].chosen_on.worst()) << choice.at("what") << " is no worse";
    EXPECT_LT(choice.at("bytes_disk"), room.at("bytes_disk"));
  }
  EXPECT_NE(plan_table(*report.planned).find("kept"), std::string::npos);
  // A later bake without a target leaves no plan that is not its own.
  BakeOptions plain = o;
  plain.target = {};
  plain.resolution = 32;
  plain.coarse_resolution = 16;
  plain.placement.max_probes = 2;
  bake_quietly(plain);
  EXPECT_FALSE(fs::exists(report.plan_file));
}

TEST_F(Planner, StatesWhatItCannotKeep) {
  BakeOptions o = options("grove", "a", 0.004);
  o.target.most_geometry = 64;
  o.target.most_radiance = 32;
  o.target.most_probes = 3;
  const BakeReport report = bake_quietly(o);
  EXPECT_FALSE(report.planned->kept);
  const std::vector<std::string> sentences = shortfalls(*report.planned);
  ASSERT_GE(sentences.size(), 2u);
  EXPECT_NE(sentences[0].find("0.004 is not kept"), std::string::npos) << sentences[0];
  EXPECT_NE(sentences[1].find("finest"), std::string::npos) << sentences[1];
  EXPECT_FALSE(Pack::open(o.pack).manifest().warnings.empty());
}

// 0.0936 +- 0.0049 may well be more than 0.1.
TEST(PlanReport, TellsAnErrorThatMayBeKeptFromOneThatIsNot) {
  Plan plan;
  plan.target.error = 0.1;
  plan.held_back.measured = true;
  plan.held_back.flip = 0.0936;
  plan.held_back.flip_deviation = 0.0049;
  EXPECT_NE(plan_table(plan).find("NOT kept for certain (up to 0.1017)"), std::string::npos) << plan_table(plan);
  ASSERT_EQ(shortfalls(plan).size(), 1u);
  EXPECT_NE(shortfalls(plan)[0].find("0.1 is not kept for certain"), std::string::npos) << shortfalls(plan)[0];
  plan.held_back.flip = 0.104;
  EXPECT_EQ(plan_table(plan).find("for certain"), std::string::npos) << plan_table(plan);
  EXPECT_NE(shortfalls(plan)[0].find("0.1 is not kept: "), std::string::npos) << shortfalls(plan)[0];
}

TEST_F(Planner, RefusesWhatItCannotPromise) {
  BakeOptions both = options("box-room", "a", 0.05);
  both.target.budget_bytes = 1000;
  EXPECT_THROW(bake_quietly(both), BadUsage);
  EXPECT_THROW(bake_quietly(options("box-room", "a", 1.5)), BadUsage);
  EXPECT_THROW(bake_quietly(options("box-room", "a", NAN)), BadUsage);
  BakeOptions spaced = options("box-room", "a", 0.05);
  spaced.placement.spacing_m = 2.0;
  EXPECT_THROW(bake_quietly(spaced), BadUsage);
}

}  // namespace
}  // namespace probewalk
