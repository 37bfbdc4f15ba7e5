// What light arrives at a place, by unbiased paths that share no light sampling with the baker: points of emissive
// triangles, picked by power, and hits of them, weighted by the balance heuristic; punctual lights and the sun's disc
// as they are; nothing clamped. Judges the bake.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <random>
#include <vector>

#include "content/scene/ray_scene.h"
#include "content/scene/scene.h"

namespace probewalk::bench {

// Irradiance (lux) of one path, by where it came from; right on average.
struct ArrivingLight {
  glm::vec3 lights{0.0f};     // punctual lights, directly
  glm::vec3 marked{0.0f};     // marked emissive triangles, directly
  glm::vec3 unmarked{0.0f};   // other emissive triangles and the sky, directly
  glm::vec3 reflected{0.0f};  // all that met a surface on its way
  glm::vec3 sum() const { return lights + marked + unmarked + reflected; }
};

class ReferenceLight {
 public:
  enum class Sampling { kBoth, kHits, kAreas };  // of emissive triangles

  // marked: by triangle, or empty. lamp_radii_m: by light, or empty; nothing nearer to the light than that casts its
  // shadow. Scene and rays must outlive this object.
  ReferenceLight(const Scene& scene, const RayScene& rays, std::vector<bool> marked = {},
                 std::vector<float> lamp_radii_m = {}, Sampling sampling = Sampling::kBoth);

  // Unit normals on the side that receives. Thread-safe with a generator a thread.
  ArrivingLight path(glm::vec3 position_m, glm::vec3 geometric_normal, glm::vec3 normal, std::mt19937& random) const;

 private:
  struct Place {
    glm::vec3 origin_m{0.0f}, geometric_normal{0.0f}, normal{0.0f};
    float cosine(glm::vec3 direction) const;
  };
  glm::vec3 punctual(const Place& at, std::mt19937& random) const;
  glm::vec3 emissive(const Place& at, std::mt19937& random, bool& is_marked) const;
  float area_density(const SurfaceHit& hit, glm::vec3 direction) const;  // a steradian

  const Scene& scene_;
  const RayScene& rays_;
  std::vector<bool> marked_;
  std::vector<float> lamp_radii_m_;
  Sampling sampling_;
  std::vector<std::uint32_t> triangles_;  // those that shine
  std::vector<double> sums_;              // of their power, up to and with each
  std::vector<float> per_m2_;             // by triangle of the scene: density of the points picked; 0 = never
};

}  // namespace probewalk::bench
