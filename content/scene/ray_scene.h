// Rays against the triangles of a Scene (Embree 4). The only file that includes Embree is ray_scene.cpp.
// A point of a MASK or BLEND triangle whose alpha fails the cut-off does not exist for any ray.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <memory>

#include "content/scene/scene.h"

namespace probewalk {

struct SurfaceHit {
  bool hit = false;
  float t = std::numeric_limits<float>::infinity();  // in units of the ray direction's length
  std::uint32_t triangle = 0;                        // index into Scene::triangles
  glm::vec2 barycentric{0.0f};                       // weights of vertices 1 and 2
  glm::vec3 geometric_normal{0.0f};                  // unit, not flipped towards the ray
};

// Is told of every ray, from any thread. What a ray's answer depends on is the surfaces along the way that it names.
class RayListener {
 public:
  virtual ~RayListener() = default;
  // A ray whose first hit is at t_end, or that met nothing up to there (infinity: nothing at all).
  virtual void passed(glm::vec3 origin_m, glm::vec3 direction, float t_end) = 0;
  // A ray that asked whether it is occluded: by the surface at this place, and perhaps by others, which is all the
  // same.
  virtual void blocked(glm::vec3 at_m) = 0;
};

class RayScene {
 public:
  // `isa` pins Embree's instruction set ("" = its own choice). The scene must outlive this object.
  explicit RayScene(const Scene& scene, const std::string& isa = "");
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  // Thread-safe. The direction need not be unit length. t in [t_near, t_far].
  SurfaceHit closest(glm::vec3 origin_m, glm::vec3 direction, float t_near = 0.0f,
                     float t_far = std::numeric_limits<float>::infinity()) const;
  bool occluded(glm::vec3 origin_m, glm::vec3 direction, float t_near, float t_far) const;

  const Scene& scene() const { return scene_; }

  // Whom to tell of rays from now on; null = nobody. Not while rays are cast.
  void tell(RayListener* listener) const { listener_ = listener; }

 private:
  struct Impl;
  const Scene& scene_;
  mutable RayListener* listener_ = nullptr;
  std::unique_ptr<Impl> impl_;
};

}  // namespace probewalk
