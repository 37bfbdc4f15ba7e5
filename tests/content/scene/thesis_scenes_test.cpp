// The scenes after the thesis's figures show what they are for: who sees what.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "content/bake/placement.h"
#include "content/bake/placement/probe_sites.h"
#include "content/scene/procedural/thesis_places.h"
#include "content/scene/ray_scene.h"
#include "content/scene/space.h"
#include "support/low_discrepancy.h"
#include "support/procedural_scene.h"

namespace probewalk {
namespace {

using namespace procedural;

class Figure {
 public:
  explicit Figure(const std::string& name) : scene_(test::load_procedural(name)), rays_(scene_) {}

  // Is nothing between the points? The last millimetre is left out: `b` may lie on a surface.
  bool sees(glm::dvec3 a, glm::dvec3 b) const {
    const double length = glm::distance(a, b);
    return !rays_.occluded(glm::vec3(a), glm::vec3(glm::normalize(b - a)), 0.0f,
                           static_cast<float>(length - 1e-3));
  }
  glm::dvec3 hit(glm::dvec3 origin, glm::dvec3 direction) const {
    const SurfaceHit found = rays_.closest(glm::vec3(origin), glm::vec3(direction));
    EXPECT_TRUE(found.hit);
    return origin + static_cast<double>(found.t) * direction;
  }
  // Share of the way from a to b that `probe` sees, and whether that is its beginning, its end.
  struct Seen {
    double share = 0.0;
    bool first = false, last = false;
  };
  Seen seen(glm::dvec3 probe, glm::dvec3 a, glm::dvec3 b) const {
    constexpr int kSteps = 400;
    Seen result;
    for (int i = 0; i <= kSteps; ++i) {
      const bool visible = sees(probe, glm::mix(a, b, (i + 0.0) / kSteps));
      result.share += visible ? 1.0 / (kSteps + 1) : 0.0;
      if (i == 0) result.first = visible;
      if (i == kSteps) result.last = visible;
    }
    return result;
  }

  const Scene& scene() const { return scene_; }
  const RayScene& rays() const { return rays_; }

 private:
  Scene scene_;
  RayScene rays_;
};

TEST(ThesisScenes, EveryRayOfACellIsKnownToItsOwnProbeOnly) {
  const Figure figure("closed-cells");
  const int count = cells::kColumns * cells::kRows;
  test::Random random(3);
  for (int k = 0; k < 2000; ++k) {
    const int cell = k % count;
    const glm::dvec3 offset(random(-1.1, 1.1), random(-1.2, 1.2), random(-1.1, 1.1));
    const glm::dvec3 origin = cells::middle_m(cell) + offset;
    for (int probe = 0; probe < count; ++probe) {
      if (probe != cell) {
        EXPECT_FALSE(figure.sees(cells::middle_m(probe), origin)) << cell << " from " << probe;
      }
    }
    const glm::dvec3 end = figure.hit(origin, random.direction());
    EXPECT_LT(std::abs(end.x - cells::middle_m(cell).x), 0.5 * cells::kCell_m + 1e-4);
    EXPECT_LT(std::abs(end.z - cells::middle_m(cell).z), 0.5 * cells::kCell_m + 1e-4);
  }
}

TEST(ThesisScenes, OnlyTheParallelProbeKeepsTheRayDownTheCorridor) {
  const Figure figure("corridor");
  EXPECT_GT(figure.seen(corridor::kBehind_m, corridor::kOrigin_m, corridor::kTarget_m).share, 0.999);
  for (const glm::dvec3 probe : {corridor::kLeft_m, corridor::kRight_m}) {
    const Figure::Seen seen = figure.seen(probe, corridor::kOrigin_m, corridor::kTarget_m);
    EXPECT_TRUE(seen.first);
    EXPECT_FALSE(seen.last);
    EXPECT_LT(seen.share, 0.4);
    EXPECT_LE(glm::distance(probe, corridor::kOrigin_m),
              glm::distance(corridor::kBehind_m, corridor::kOrigin_m) + 1e-9);
  }
}

TEST(ThesisScenes, TheStarIsSeenFromItsMiddleAndNotFromItsPoints) {
  const Figure figure("star-room");
  // Points on the walls, above what stands in the star's points.
  std::vector<glm::dvec3> walls;
  for (int i = 0; i < 500; ++i) {
    const double angle = 2.0 * 3.14159265358979 * (i + 0.5) / 500;
    walls.push_back(figure.hit({0, 2.0, 0}, {std::cos(angle), 0.2 * std::sin(7.0 * angle), std::sin(angle)}));
  }
  double farthest = 0.0;
  int hidden = 0, pairs = 0;
  for (std::size_t i = 0; i < walls.size(); ++i) {
    EXPECT_TRUE(figure.sees({0, 2.0, 0}, walls[i]));
    farthest = std::max(farthest, glm::length(glm::dvec2(walls[i].x, walls[i].z)));
    for (std::size_t j = 0; j < i; j += 7, ++pairs)
      hidden += !figure.sees(glm::mix(walls[i], {0, 2.0, 0}, 0.05), walls[j]);
  }
  EXPECT_GT(farthest, 0.9 * star::kOuterRadius_m);
  EXPECT_GT(hidden, pairs / 4);
}

TEST(ThesisScenes, NeitherProbeSeesTheRayThatBothTogetherSee) {
  const Figure figure("hand-over");
  EXPECT_TRUE(figure.sees(hand_over::kOrigin_m, hand_over::kTarget_m));
  const Figure::Seen first = figure.seen(hand_over::kFirst_m, hand_over::kOrigin_m, hand_over::kTarget_m);
  const Figure::Seen second = figure.seen(hand_over::kSecond_m, hand_over::kOrigin_m, hand_over::kTarget_m);
  EXPECT_TRUE(first.first);
  EXPECT_FALSE(first.last);
  EXPECT_FALSE(second.first);
  EXPECT_TRUE(second.last);
  EXPECT_GT(first.share + second.share, 1.05);  // they meet
}

TEST(ThesisScenes, ProbesLeaveTheBoxesAroundTheirLattice) {
  const Figure figure("boxed-lattice");
  for (const glm::dvec3& point : boxes::points_m()) {
    EXPECT_LT(clearance_m(figure.rays(), point, 1.0), boxes::kHalfBox_m);
    // What a probe at the point itself would see is its box, but for slits.
    int outside = 0;
    for (int i = 0; i < 500; ++i)
      outside += glm::distance(figure.hit(point, test::hammersley_direction(i, 500)), point) >
                 2.0 * boxes::kHalfBox_m;
    EXPECT_LT(outside, 75);
  }
  SilentProgress progress;
  const Space space = find_space(figure.scene(), figure.rays(), {}, progress);
  PlacementOptions options;
  options.spacing_m = boxes::kSpacing_m;
  const Placement placement = place_probes(figure.scene(), figure.rays(), space, options);
  ASSERT_GE(placement.sites.size(), 8u);
  for (const ProbeSite& site : placement.sites) {
    for (const glm::dvec3& point : boxes::points_m()) {
      const glm::dvec3 off = glm::abs(site.position_m - point);
      EXPECT_GT(std::max({off.x, off.y, off.z}), boxes::kHalfBox_m);
    }
  }
}

TEST(ThesisScenes, TheHolodeckIsSeenFromItsMiddle) {
  const Figure figure("holodeck");
  const glm::dvec3 middle(0.0, 1.6, 0.0);
  int hidden = 0;
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 there = figure.hit({1.2, 1.5, 1.3}, test::hammersley_direction(i, 20000));
    hidden += !figure.sees(middle, there);
  }
  EXPECT_LE(hidden, 20);  // trims stand 5 mm proud of their walls
}

// tools/views/NAME.txt: NAME x,y,z,yaw,pitch of each view of a scene.
TEST(ThesisScenes, NamedViewsStandInFreeAir) {
  const std::map<std::string, std::string> whole_names{{"fractal", "fractal-3"},
                                                       {"triangles", "triangles-1e4"}};
  int views = 0;
  for (const auto& entry : std::filesystem::directory_iterator(PROBEWALK_SOURCE_DIR "/tools/views")) {
    const std::string stem = entry.path().stem().string();
    const auto whole = whole_names.find(stem);
    const Figure figure(whole != whole_names.end() ? whole->second : stem);
    std::ifstream file(entry.path());
    for (std::string line; std::getline(file, line);) {
      if (line.empty() || line.front() == '#') continue;
      std::replace(line.begin(), line.end(), ',', ' ');
      std::istringstream words(line);
      std::string name;
      double yaw = 0.0, pitch = 0.0;
      glm::dvec3 eye;
      ASSERT_TRUE(words >> name >> eye.x >> eye.y >> eye.z >> yaw >> pitch) << entry.path() << ": " << line;
      EXPECT_GT(clearance_m(figure.rays(), eye, 1.0), 0.1) << stem << ' ' << name;
      // Something is to be seen: the middle of the view is not right before the eye.
      const double turn = glm::radians(yaw), rise = glm::radians(pitch);
      const glm::vec3 ahead(-std::sin(turn) * std::cos(rise), std::sin(rise),
                            -std::cos(turn) * std::cos(rise));
      EXPECT_FALSE(figure.rays().occluded(glm::vec3(eye), ahead, 0.0f, 0.4f)) << stem << ' ' << name;
      ++views;
    }
  }
  EXPECT_GE(views, 30);
}

TEST(ThesisScenes, AFractalHasTheFacesOfItsLevel) {
  // 2 * 20^n + 4 * 8^n squares, beside a room of 6 and a plinth of 6.
  int twenties = 1, eights = 1;
  for (int level = 1; level <= 3; ++level) {
    twenties *= 20, eights *= 8;
    const Scene scene = test::load_procedural("fractal-" + std::to_string(level));
    EXPECT_EQ(scene.triangles.size(), static_cast<std::size_t>(2 * (2 * twenties + 4 * eights + 12)));
  }
}

TEST(ThesisScenes, TheRoomOfSoManyTrianglesHasThemAndLooksTheSame) {
  const Figure coarse("triangles-1e3"), fine("triangles-1e5");
  EXPECT_NEAR(static_cast<double>(coarse.scene().triangles.size()), 1e3, 100.0);
  EXPECT_NEAR(static_cast<double>(fine.scene().triangles.size()), 1e5, 1e4);
  // Seen from the same place most of it is where it was, but nothing is exactly there: the relief is real.
  int near = 0, same = 0, rays = 4000;
  for (int i = 0; i < rays; ++i) {
    const glm::dvec3 origin(-0.5, 1.5, 1.0), direction = test::hammersley_direction(i, rays);
    const double off = glm::distance(coarse.hit(origin, direction), fine.hit(origin, direction));
    near += off < 0.02;
    same += off < 1e-6;
  }
  EXPECT_GT(near, rays * 85 / 100);
  EXPECT_LT(same, rays / 10);
}

}  // namespace
}  // namespace probewalk
