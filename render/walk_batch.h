// Walks a list of rays through one probe's map on the device, as walk_probe does on the host: for checks.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "content/probe/device_probe.h"
#include "render/buffer.h"
#include "render/device.h"
#include "render/pipeline.h"
#include "render/probe_blocks.h"
#include "shaders/shared/walk_batch.h"

namespace probewalk {

class WalkBatch {
 public:
  explicit WalkBatch(const Device& device);

  // Puts the probe on the device, in place of the one before.
  void set_probe(const DeviceProbe& probe);
  // Blocks until all rays are walked, in their order. A probe must have been set.
  std::vector<WalkEnd> walk(std::span<const WalkRay> rays, int start_level);

 private:
  const Device& device_;
  Pipeline pipeline_;
  ProbeArena arena_;
  std::optional<ProbeBlocks> blocks_;
  ProbeRecord record_{};
  Buffer constants_, rays_, ends_;
};

}  // namespace probewalk
