// What light is sampled directly: punctual lights, and emissive surfaces small enough to be worth shadow rays, as patches
// of fixed sample points. Everything else that shines (sky, large glowing surfaces) is gathered by the irradiance cache.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "content/scene/ray_scene.h"
#include "content/scene/scene.h"

namespace probewalk {

inline constexpr int kPatchSamples = 16;

// A small emissive surface: up to a metre or two across, of one object and material.
struct EmissivePatch {
  struct Sample {
    glm::vec3 position_m{0.0f};
    glm::vec3 normal{0.0f};
    glm::vec3 weight{0.0f};  // radiance * area that the sample stands for (cd)
    bool front_open = true;  // whether light that leaves this side gets anywhere: false inside a bulb, against a ceiling
    bool back_open = true;
  };
  std::array<Sample, kPatchSamples> samples;  // any first k of them spread well over the patch
  // What it consists of, where that is little and shines evenly: near by, points do not stand for it well.
  struct Face {
    std::array<glm::vec3, 3> corners_m;
    glm::vec3 normal{0.0f};
    glm::vec3 radiance{0.0f};
    bool front_open = true, back_open = true;
  };
  std::vector<Face> faces;  // empty = not known
  glm::vec3 centre_m{0.0f};
  float radius_m = 0.0f;
  float sample_area_m2 = 0.0f;
  float power_cd = 0.0f;  // luminance of the weights' sum
};

// A punctual light, and how near to it geometry is taken for its own lamp and casts no shadow: a light inside a closed
// bulb or lantern would else light nothing.
struct PunctualEmitter {
  Light light;
  float lamp_radius_m = 0.0f;
};

struct Emitters {
  std::vector<PunctualEmitter> lights;
  std::vector<EmissivePatch> patches;
  // By triangle: its emission is sampled directly, so whoever gathers light must not count it again.
  std::vector<bool> is_patch;
};

Emitters find_emitters(const Scene& scene, const RayScene& rays);

// Of each, first the lights, then the patches: all that decides what it sends, its number and name not counted.
std::vector<std::uint64_t> emitter_hashes(const Emitters& emitters);

}  // namespace probewalk
