// What walkers look at: eye positions in walkable space with directions, room by room, and what the triangles answer
// there. Drawn by low-discrepancy sequences; sets of different numbers share no eye, so that what was chosen by one is
// judged on another.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "content/bake/light_field.h"
#include "content/bake/placement/head_space.h"
#include "content/progress.h"
#include "content/scene/ray_scene.h"
#include "content/scene/space.h"

namespace probewalk {

// The density that pictures are compared at.
inline constexpr double kPlanPixelsPerDegree = 20.0;
// A picture's side: small, so that many directions are looked at.
inline constexpr int kPatchSide_px = 24;

struct EyeRay {
  glm::dvec3 origin_m{0.0};
  glm::vec3 direction{0.0f, 0.0f, -1.0f};  // unit
  std::uint32_t room = 0;                  // that the eye is in
  float truth_m = 0.0f;                    // distance to the nearest triangle; infinity = none
};

// A small square picture.
struct EyePatch {
  EyeRay middle;
  std::vector<float> truth_m;       // by pixel, rows from the top
  std::vector<glm::vec3> radiance;  // by pixel, cd/m^2

  glm::vec3 direction(int x, int y) const;  // unit
};

struct WalkerViews {
  std::vector<EyeRay> rays;
  std::vector<EyePatch> patches;
  std::vector<double> room_share;  // of the walkable floor
};

struct ViewCounts {
  int rays = 0, patches = 0;  // a room
};

// Rooms without floor get none. Throws Interrupted.
WalkerViews sample_views(const Space& space, const HeadSpace& heads, const RayScene& triangles, const LightField& light,
                         ViewCounts counts, std::uint32_t set, Progress& progress);

}  // namespace probewalk
