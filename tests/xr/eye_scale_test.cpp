// The controller of the eyes' resolution against invented devices.
#include "xr/eye_scale.h"

#include <gtest/gtest.h>

#include <cmath>

namespace probewalk {
namespace {

constexpr std::int64_t kPeriod_ns = 11'111'111;

// A device that takes `fixed_ms` and `rays_ms` at full scale; two frames are always under way.
struct Device {
  double fixed_ms = 1.0, rays_ms = 5.0;
  double noise = 0.0;  // of the whole, either way
  int frame = 0;
  int under_way[2] = {kEyeScaleSteps, kEyeScaleSteps};

  double busy_ms(double scale) const { return fixed_ms + rays_ms * scale * scale; }
  void run(EyeScale& eyes, int frames) {
    for (int k = 0; k < frames; ++k, ++frame) {
      const int drawn = under_way[frame % 2];
      under_way[frame % 2] = eyes.steps();
      const double shake = noise * (2.0 * std::fmod(frame * 0.6180339887498949, 1.0) - 1.0);
      const double ms = busy_ms(static_cast<double>(drawn) / kEyeScaleSteps) * (1.0 + shake);
      eyes.add(static_cast<std::int64_t>(ms * 1e6), kPeriod_ns, drawn);
    }
  }
};

TEST(EyeScale, StaysWholeWhereTheDeviceHasTime) {
  EyeScale eyes;
  Device device{.noise = 0.3};
  device.run(eyes, 2000);
  EXPECT_EQ(eyes.steps(), kEyeScaleSteps);
}

TEST(EyeScale, StepLoadIsMetWithinTwentyFrames) {
  EyeScale eyes;
  Device device;
  device.run(eyes, 200);
  device.rays_ms = 16.0;  // 17 ms of 11.1
  device.run(eyes, 20);
  EXPECT_LT(eyes.scale(), 1.0);
  device.run(eyes, 200);
  EXPECT_LE(device.busy_ms(eyes.scale()), 0.9 * kPeriod_ns * 1e-6);
  EXPECT_GT(eyes.scale(), 0.65) << "lower than the load asks for";
}

TEST(EyeScale, RecoversAStepAtATimeAndStopsInTime) {
  EyeScale eyes;
  Device device{.rays_ms = 16.0};
  device.run(eyes, 200);
  const int low = eyes.steps();
  device.rays_ms = 8.0;
  int before = low, rises = 0;
  for (int k = 0; k < 3000; ++k) {
    device.run(eyes, 1);
    EXPECT_LE(eyes.steps(), before + 1);
    rises += eyes.steps() > before ? 1 : 0;
    EXPECT_GE(eyes.steps(), before) << "frame " << k << ": up and down again";
    before = eyes.steps();
  }
  EXPECT_EQ(rises, eyes.steps() - low);
  EXPECT_GE(eyes.scale(), 0.9);
  EXPECT_LE(device.busy_ms(eyes.scale()), 0.9 * kPeriod_ns * 1e-6);
}

// Whatever load and noise: once it has settled it keeps still, within the budget unless that is out of reach.
TEST(EyeScale, SettlesUnderNoiseForEveryLoad) {
  for (int i = 0; i < 60; ++i) {
    Device device{.fixed_ms = 0.2 + 2.0 * std::fmod(i * 0.7548776662466927, 1.0),
                  .rays_ms = 1.0 + 29.0 * std::fmod(i * 0.5698402909980532, 1.0),
                  .noise = 0.12 * std::fmod(i * 0.6180339887498949, 1.0)};
    EyeScale eyes;
    device.run(eyes, 3000);
    const int settled = eyes.steps();
    int changes = 0;
    for (int k = 0, before = settled; k < 3000; ++k) {
      device.run(eyes, 1);
      changes += eyes.steps() != before ? 1 : 0;
      before = eyes.steps();
    }
    EXPECT_LE(changes, 1) << "load " << device.rays_ms << " ms, noise " << device.noise;
    EXPECT_GE(eyes.steps(), kLeastEyeScale_steps);
    if (eyes.steps() > kLeastEyeScale_steps) {
      EXPECT_LE(device.busy_ms(eyes.scale()), 0.95 * kPeriod_ns * 1e-6);
    }
  }
}

TEST(EyeScale, OneHitchChangesNothing) {
  EyeScale eyes;
  Device device{.rays_ms = 6.0};
  for (int k = 0; k < 50; ++k) {
    device.run(eyes, 40);
    eyes.add(80'000'000, kPeriod_ns, eyes.steps());
  }
  EXPECT_EQ(eyes.steps(), kEyeScaleSteps);
}

TEST(EyeScale, FramesOfAnotherScaleAndFramesWithoutTimesDoNotCount) {
  EyeScale eyes;
  for (int k = 0; k < 100; ++k) {
    eyes.add(50'000'000, kPeriod_ns, kEyeScaleSteps - 1);
    eyes.add(0, kPeriod_ns, kEyeScaleSteps);
    eyes.add(50'000'000, 0, kEyeScaleSteps);
  }
  EXPECT_EQ(eyes.steps(), kEyeScaleSteps);
}

}  // namespace
}  // namespace probewalk
