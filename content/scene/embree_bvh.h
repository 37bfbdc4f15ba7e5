// Embree's hierarchy over a Scene, shared by what casts rays at it. Included by ray_scene.cpp and
// embree_query.cpp only: nothing else of the project sees Embree.
#pragma once

#include <embree4/rtcore.h>

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "content/scene/scene.h"

namespace probewalk {

struct ReleaseDevice {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct ReleaseScene {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
struct ReleaseGeometry {
  void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
struct ReleaseBuffer {
  void operator()(RTCBuffer buffer) const { rtcReleaseBuffer(buffer); }
};
template <typename Handle, typename Release>
using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Release>;

// Unit normal by the winding; zero for triangles without area or with non-finite corners, which no ray can
// hit.
glm::vec3 unit_normal(const Scene& scene, std::uint32_t triangle);

struct EmbreeOptions {
  std::string isa;        // "" = Embree's own choice
  bool is_robust = true;  // no ray slips between neighbours
  // The order of a parallel build's leaves, and so the winner among hits at one distance, depends on timing.
  bool one_thread_builds = true;
};

// Opaque triangles are one Embree geometry; those whose texture decides whether a point exists are another,
// so that only the second pays for the filter. The scene must outlive this.
struct EmbreeBvh {
  Owned<RTCDevice, ReleaseDevice> device;
  Owned<RTCScene, ReleaseScene> bvh;
  std::vector<std::uint32_t> triangles[2];  // Scene::triangles index of each primitive, by geometry
  const Scene* scene = nullptr;

  enum Geometry : unsigned { kOpaqueGeometry = 0, kTestedGeometry = 1 };

  EmbreeBvh(const Scene& source, const EmbreeOptions& options);
  EmbreeBvh(const EmbreeBvh&) = delete;
  EmbreeBvh& operator=(const EmbreeBvh&) = delete;

 private:
  void attach(Geometry id, RTCBuffer vertices);
  static void filter(const RTCFilterFunctionNArguments* arguments);
};

}  // namespace probewalk
