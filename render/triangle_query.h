// A scene's triangles as the device's own ray tracing sees them (VK_KHR_ray_query): what the tracer is
// measured beside.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>

#include "content/scene/scene.h"
#include "render/device.h"
#include "shaders/shared/triangle_query.h"

namespace probewalk {

// The same hooks, but the device that they create can query rays, where it has what that takes: acceleration
// structures and ray queries stay off unless asked for by this. Whether they are on is has_ray_query's to
// say.
DeviceHooks with_ray_query(DeviceHooks hooks = {});
bool has_ray_query(const Device& device);

class TriangleQuery {
 public:
  // Builds the acceleration structures, which may take seconds. The alpha test is that of RayScene.
  // Throws NoDevice where the device has no ray query or was created without with_ray_query.
  TriangleQuery(const Device& device, const Scene& scene);
  ~TriangleQuery();
  TriangleQuery(const TriangleQuery&) = delete;
  TriangleQuery& operator=(const TriangleQuery&) = delete;

  // Nearest distances, in the rays' order; kTriangleMiss_m of a miss. Blocks. `t_m` is as long as `rays`.
  // Returns the dispatches' time in ns, from submission to fence; copying in and out is not in it.
  std::int64_t trace(std::span<const TriangleRay> rays, std::span<float> t_m) const;

  std::int64_t build_ns() const;          // the acceleration structures', on the same clock
  std::uint64_t structure_bytes() const;  // theirs, without what they were built from

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace probewalk
