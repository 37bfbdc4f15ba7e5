#include "xr/overlay/panel_place.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>

#include "xr/press.h"

namespace probewalk {
namespace {

glm::dquat turned(double yaw_rad, double pitch_rad = 0.0) {
  return glm::angleAxis(yaw_rad, glm::dvec3(0, 1, 0)) * glm::angleAxis(pitch_rad, glm::dvec3(1, 0, 0));
}

TEST(PanelPlace, HangsBesideWhereTheHeadLooksAndFacesIt) {
  for (int i = 0; i < 64; ++i) {
    const double yaw_rad = 2.0 * std::numbers::pi * i / 64.0, pitch_rad = 3.0 * (i % 16 / 15.0 - 0.5);
    const glm::dvec3 head_m(0.3 * i, 1.6, -0.1 * i);
    PanelPlace place;
    place.follow(head_m, turned(yaw_rad, pitch_rad));
    const glm::dvec3 way = place.position_m() - head_m;
    EXPECT_NEAR(glm::length(way), PanelPlace::kDistance_m, 1e-9);
    EXPECT_LT(way.y, 0.0);
    // As far to the left of where the head looks as it should be, at whatever pitch.
    const double aside_rad = std::remainder(std::atan2(-way.x, -way.z) - yaw_rad, 2.0 * std::numbers::pi);
    EXPECT_NEAR(aside_rad, PanelPlace::kLeft_rad, 1e-9) << i;
    const glm::dvec3 face = place.orientation() * glm::dvec3(0, 0, 1);
    EXPECT_NEAR(glm::dot(face, glm::normalize(-way)), 1.0, 1e-9);
    EXPECT_NEAR((place.orientation() * glm::dvec3(1, 0, 0)).y, 0.0, 1e-9) << "upright";
  }
}

TEST(PanelPlace, StaysInTheRoomUntilTheHeadHasLeftIt) {
  PanelPlace place;
  place.follow({0, 1.6, 0}, turned(0.0));
  const glm::dvec3 first_m = place.position_m();
  for (const double yaw_rad : {0.4, -0.4, 1.0}) place.follow({0.1, 1.5, 0.1}, turned(yaw_rad, 0.3));
  EXPECT_EQ(place.position_m(), first_m);
  place.follow({0, 1.6, 0}, turned(-0.9));
  EXPECT_NE(place.position_m(), first_m) << "turned away";
  const glm::dvec3 second_m = place.position_m();
  place.follow({0, 1.6, 3.0}, turned(-0.9));
  EXPECT_NE(place.position_m(), second_m) << "gone away";
  place.forget();
  place.follow({0, 1.6, 0}, turned(0.3));
  EXPECT_NE(place.position_m(), first_m) << "shown anew";
}

TEST(PressButton, TellsAShortPressFromOneThatIsHeld) {
  constexpr std::int64_t kFrame_ns = 50'000'000;
  const auto press = [&](int frames_down) {
    PressButton button;
    std::string told;
    for (int i = 0; i < frames_down + 4; ++i) {
      switch (button.advance(i < frames_down, 1 + i * kFrame_ns)) {
        case Press::kShort:
          told += "short";
          break;
        case Press::kHeld:
          told += "held";
          break;
        case Press::kNone:
          break;
      }
    }
    return told;
  };
  EXPECT_EQ(press(0), "");
  EXPECT_EQ(press(1), "short");
  EXPECT_EQ(press(16), "short");
  EXPECT_EQ(press(17), "held");
  EXPECT_EQ(press(100), "held");
}

}  // namespace
}  // namespace probewalk
