// Traces a list of rays on the device: for tools and tests.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "render/device.h"
#include "render/probe_store.h"
#include "shaders/shared/ray_batch.h"

namespace probewalk {

struct Ray {
  glm::dvec3 origin_m{0.0};
  glm::dvec3 direction{0.0, 0.0, -1.0};  // need not be unit length; must not be 0
};

class RayBatch {
 public:
  explicit RayBatch(const Device& device);
  ~RayBatch();
  RayBatch(const RayBatch&) = delete;
  RayBatch& operator=(const RayBatch&) = delete;

  // Blocks until all rays are answered, in their order. The store must be idle and its slot 0 written (see
  // make_resident). `spread_rad` is each ray's angular width, for filtering.
  std::vector<BatchAnswer> trace(const ProbeStore& store, const TraceConstants& dials, std::span<const Ray> rays,
                                 float spread_rad) const;

 private:
  const Device& device_;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
};

// Blocks until everything handed to the store is on the device and in the tables of all slots: for batch work, where no
// frame loop does it bit by bit.
void make_resident(const Device& device, ProbeStore& store);

}  // namespace probewalk
