// Emissive surfaces that are no patches (large ones, and more than patches are made of): points of them, picked by
// power, whose light the gathering over the hemisphere adds to what its rays happen to hit. Weighted by the balance
// heuristic (Veach and Guibas 1995), so that neither small far lamps nor large near ones are noisy.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "content/bake/emitters.h"
#include "content/scene/ray_scene.h"
#include "content/scene/scene.h"

namespace probewalk {

class GatheredEmitters {
 public:
  // All must outlive this.
  GatheredEmitters(const Scene& scene, const RayScene& rays, const Emitters& emitters);

  bool empty() const { return triangles_.empty(); }

  struct Sample {
    glm::vec3 direction{0.0f};  // unit
    glm::vec3 radiance{0.0f};   // cd/m^2; black where something stands between, or light is behind
    float density = 0.0f;       // a steradian
  };
  // The point that choice, in [0, 1), and `square`, in [0, 1)^2, pick, from a place. Must not be empty.
  Sample pick(glm::vec3 origin_m, glm::vec3 normal, float choice, glm::vec2 square, std::uint64_t& rays_cast) const;
  // The density, a steradian, with which pick() would have picked what a ray hit.
  float density(const SurfaceHit& hit, glm::vec3 unit_direction) const;

 private:
  const Scene& scene_;
  const RayScene& rays_;
  std::vector<std::uint32_t> triangles_;
  std::vector<double> sums_;   // of their power, up to and with each
  std::vector<float> per_m2_;  // by triangle of the scene: density of the points picked; empty where none are
};

}  // namespace probewalk
