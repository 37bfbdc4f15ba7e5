// Embree on a list of rays with all threads, distances only: what the tracer is measured beside on a
// processor.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "content/scene/scene.h"
#include "shaders/shared/triangle_query.h"

namespace probewalk {

enum class RayWidth {
  kOne,      // rtcIntersect1
  kSixteen,  // rtcIntersect16, told that the rays of a packet start and head alike
};

class EmbreeQuery {
 public:
  // Builds a hierarchy of high quality, which may take seconds. The alpha test is that of RayScene; other
  // than there, rays may slip between neighbours (Embree's default, its fastest). The scene must outlive this
  // object.
  explicit EmbreeQuery(const Scene& scene);
  ~EmbreeQuery();
  EmbreeQuery(const EmbreeQuery&) = delete;
  EmbreeQuery& operator=(const EmbreeQuery&) = delete;

  // Nearest distances, in the rays' order; kTriangleMiss_m of a miss. `t_m` is as long as `rays`; sixteen
  // rays in a row are a packet. Returns the time that it took in ns.
  std::int64_t trace(RayWidth width, std::span<const TriangleRay> rays, std::span<float> t_m) const;

  std::int64_t build_ns() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace probewalk
