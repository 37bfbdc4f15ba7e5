#include "xr/vignette.h"

#include <gtest/gtest.h>

#include "content/error.h"
#include "support/floors.h"
#include "xr/desktop_head.h"
#include "xr/locomotion.h"

namespace probewalk {
namespace {

using test::eye_at;
using test::make_floor;

TEST(Vignette, IsOpenAtRestClosesQuicklyAndOpensAgain) {
  const double clear_rad = vignette_clear_rad("medium");
  Vignette vignette(clear_rad);
  for (int i = 0; i < 100; ++i) vignette.advance(0.0, 0.01);
  EXPECT_FALSE(vignette.shape());
  double last_rad = 1.5;
  for (int i = 0; i < 20; ++i) {
    vignette.advance(1.0, 0.01);
    ASSERT_TRUE(vignette.shape());
    EXPECT_LE(vignette.shape()->clear_rad, last_rad);
    EXPECT_GT(vignette.shape()->black_rad, vignette.shape()->clear_rad);
    EXPECT_LT(vignette.shape()->black_rad, 1.5);
    last_rad = vignette.shape()->clear_rad;
  }
  EXPECT_NEAR(last_rad, clear_rad, 1e-6);
  for (int i = 0; i < 30; ++i) vignette.advance(0.0, 0.01);
  EXPECT_TRUE(vignette.shape()) << "it opens more slowly than it closes";
  for (int i = 0; i < 20; ++i) vignette.advance(0.0, 0.01);
  EXPECT_FALSE(vignette.shape());
}

TEST(Vignette, ClosesAsFarAsTheMotionIsFast) {
  double last_rad = 0.0;
  for (const double motion : {1.0, 0.6, 0.3, 0.1}) {
    Vignette vignette(vignette_clear_rad("low"));
    for (int i = 0; i < 100; ++i) vignette.advance(motion, 0.01);
    EXPECT_GT(vignette.shape().value().clear_rad, last_rad);
    last_rad = vignette.shape()->clear_rad;
  }
  Vignette runs(vignette_clear_rad("low"));
  for (int i = 0; i < 100; ++i) runs.advance(2.5, 0.01);
  EXPECT_NEAR(runs.shape().value().clear_rad, vignette_clear_rad("low"), 1e-6);
}

TEST(Vignette, OffNeverCloses) {
  Vignette vignette(vignette_clear_rad("off"));
  for (int i = 0; i < 100; ++i) vignette.advance(1.0, 0.01);
  EXPECT_FALSE(vignette.shape());
  EXPECT_THROW(vignette_clear_rad("dark"), BadInput);
}

TEST(Vignette, HigherLevelsLeaveLessClear) {
  double last_rad = 1.5;
  for (const VignetteLevel& level : vignette_levels()) {
    if (level.clear_rad == 0.0) continue;
    EXPECT_LT(level.clear_rad, last_rad) << level.name;
    last_rad = level.clear_rad;
  }
}

struct Walker {
  explicit Walker(const FloorMap& floor, TurnStyle turn = TurnStyle::kSmooth, const char* level = "medium")
      : locomotion(floor, options(turn, level)), head(kEyeHeight_m, 0.0) {
    locomotion.place(eye_at(2, 3), head.pose(), {});
  }
  static LocomotionOptions options(TurnStyle turn, const char* level) {
    LocomotionOptions options;
    options.turn = turn;
    options.vignette_clear_rad = vignette_clear_rad(level);
    return options;
  }
  bool narrowed_by(const MoveInput& input, double seconds = 0.5) {
    for (double t = 0; t < seconds; t += 0.01) locomotion.advance(head.pose(), input, 0.01);
    return locomotion.vignette().has_value();
  }
  Locomotion locomotion;
  DesktopHead head;
};

TEST(LocomotionVignette, ClosesWhileSticksWalkOrTurnTheView) {
  const FloorMap floor = make_floor({8, 8}, [](double, double) { return 0.0; });
  MoveInput walk, turn;
  walk.wish = {0, 1};
  turn.turn = -1.0;
  for (const MoveInput& moved : {walk, turn}) {
    Walker person(floor);
    EXPECT_FALSE(person.narrowed_by({}));
    EXPECT_TRUE(person.narrowed_by(moved));
    EXPECT_FALSE(person.narrowed_by({}));
    EXPECT_FALSE(Walker(floor, TurnStyle::kSmooth, "off").narrowed_by(moved));
  }
}

TEST(LocomotionVignette, StaysOpenForWhatMovesNoView) {
  const FloorMap floor = make_floor({8, 8}, [](double, double) { return 0.0; });
  MoveInput snap;
  snap.turn = 1.0;
  EXPECT_FALSE(Walker(floor, TurnStyle::kSnap).narrowed_by(snap));
  MoveInput teleport;
  teleport.aim = AimRay{{0, 1.6, 0}, {0, -1, -1}};
  teleport.teleport = true;
  EXPECT_FALSE(Walker(floor).narrowed_by(teleport));
  MoveInput barely;
  barely.wish = {0.1, 0.0};  // within the dead zone
  EXPECT_FALSE(Walker(floor).narrowed_by(barely));
  // Straight into a wall: nothing moves any more.
  Walker at_wall(floor);
  MoveInput ahead;
  ahead.wish = {0, 1};
  at_wall.narrowed_by(ahead, 10.0);
  EXPECT_FALSE(at_wall.narrowed_by(ahead));
  // The wearer's own steps.
  Walker on_foot(floor);
  for (int i = 0; i < 50; ++i) on_foot.locomotion.advance({{0.01 * i, 1.6, 0.0}, 0.02 * i}, {}, 0.01);
  EXPECT_FALSE(on_foot.locomotion.vignette());
}

}  // namespace
}  // namespace probewalk
