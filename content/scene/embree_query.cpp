#include "content/scene/embree_query.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>

#include "content/scene/embree_bvh.h"

namespace probewalk {
namespace {

constexpr std::size_t kPiece = 1024;  // rays that one thread takes at once: a multiple of a packet

void distances_by_one(RTCScene bvh, std::span<const TriangleRay> rays, std::span<float> t_m) {
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    RTCRayHit query{};
    const TriangleRay& ray = rays[i];
    query.ray.org_x = ray.origin_m.x;
    query.ray.org_y = ray.origin_m.y;
    query.ray.org_z = ray.origin_m.z;
    query.ray.dir_x = ray.unit_direction.x;
    query.ray.dir_y = ray.unit_direction.y;
    query.ray.dir_z = ray.unit_direction.z;
    query.ray.tfar = kTriangleMiss_m;
    query.ray.mask = ~0u;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(bvh, &query, &arguments);
    t_m[i] = query.ray.tfar;
  }
}

void distances_by_sixteen(RTCScene bvh, std::span<const TriangleRay> rays, std::span<float> t_m) {
  constexpr std::size_t kWidth = 16;
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  for (std::size_t first = 0; first < rays.size(); first += kWidth) {
    const std::size_t count = std::min(kWidth, rays.size() - first);
    alignas(64) int valid[kWidth];
    alignas(64) RTCRayHit16 packet;
    for (std::size_t k = 0; k < kWidth; ++k) {
      const TriangleRay& ray = rays[first + std::min(k, count - 1)];
      valid[k] = k < count ? -1 : 0;
      packet.ray.org_x[k] = ray.origin_m.x;
      packet.ray.org_y[k] = ray.origin_m.y;
      packet.ray.org_z[k] = ray.origin_m.z;
      packet.ray.dir_x[k] = ray.unit_direction.x;
      packet.ray.dir_y[k] = ray.unit_direction.y;
      packet.ray.dir_z[k] = ray.unit_direction.z;
      packet.ray.tnear[k] = 0.0f;
      packet.ray.tfar[k] = kTriangleMiss_m;
      packet.ray.time[k] = 0.0f;
      packet.ray.mask[k] = ~0u;
      packet.ray.id[k] = 0;
      packet.ray.flags[k] = 0;
      packet.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect16(valid, bvh, &packet, &arguments);
    std::copy_n(packet.ray.tfar, count, t_m.begin() + static_cast<std::ptrdiff_t>(first));
  }
}

}  // namespace

struct EmbreeQuery::Impl {
  EmbreeBvh triangles;
  std::int64_t build_ns = 0;

  explicit Impl(const Scene& scene)
      : triangles(scene, EmbreeOptions{.isa = "", .is_robust = false, .one_thread_builds = false}) {}
};

EmbreeQuery::EmbreeQuery(const Scene& scene) {
  const auto begin = std::chrono::steady_clock::now();
  impl_ = std::make_unique<Impl>(scene);
  impl_->build_ns = (std::chrono::steady_clock::now() - begin) / std::chrono::nanoseconds(1);
}
EmbreeQuery::~EmbreeQuery() = default;

std::int64_t EmbreeQuery::trace(RayWidth width, std::span<const TriangleRay> rays,
                                std::span<float> t_m) const {
  const auto distances = width == RayWidth::kOne ? distances_by_one : distances_by_sixteen;
  const std::size_t pieces = (rays.size() + kPiece - 1) / kPiece;
  const auto begin = std::chrono::steady_clock::now();
  tbb::parallel_for(std::size_t{0}, pieces, [&](std::size_t piece) {
    const std::size_t first = piece * kPiece, count = std::min(kPiece, rays.size() - first);
    distances(impl_->triangles.bvh.get(), rays.subspan(first, count), t_m.subspan(first, count));
  });
  return (std::chrono::steady_clock::now() - begin) / std::chrono::nanoseconds(1);
}

std::int64_t EmbreeQuery::build_ns() const {
  return impl_->build_ns;
}

}  // namespace probewalk
