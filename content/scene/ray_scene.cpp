#include "content/scene/ray_scene.h"

#include <embree4/rtcore.h>
#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string_view>
#include <type_traits>
#include <vector>

#include "content/error.h"
#include "content/scene/alpha_test.h"

namespace probewalk {
namespace {

constexpr std::array<std::string_view, 5> kInstructionSets{"sse2", "sse4.2", "avx", "avx2", "avx512"};

bool processor_has(std::string_view isa) {
#if defined(__x86_64__)
  if (isa == "sse4.2") return __builtin_cpu_supports("sse4.2") != 0;
  if (isa == "avx") return __builtin_cpu_supports("avx") != 0;
  if (isa == "avx2") return __builtin_cpu_supports("avx2") != 0;
  if (isa == "avx512") return __builtin_cpu_supports("avx512vl") != 0 && __builtin_cpu_supports("avx512dq") != 0;
#endif
  return isa == "sse2";
}

std::string device_config(const std::string& isa) {
  if (isa.empty()) return "";
  if (std::find(kInstructionSets.begin(), kInstructionSets.end(), isa) == kInstructionSets.end()) {
    throw BadUsage(
        fmt::format("instruction set '{}' is unknown; known are {}", isa, fmt::join(kInstructionSets, ", ")));
  }
  if (!processor_has(isa)) {
    throw BadUsage(fmt::format("this processor has no instruction set '{}'; choose a lesser one of {}", isa,
                               fmt::join(kInstructionSets, ", ")));
  }
  return "isa=" + isa;
}

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

void check(RTCDevice device, const char* what) {
  if (rtcGetDeviceError(device) != RTC_ERROR_NONE) {
    throw NoDevice(fmt::format("Embree could not {}: {}", what, rtcGetDeviceLastErrorMessage(device)));
  }
}

// Unit normal by the winding; zero for triangles without area or with non-finite corners, which no ray can hit.
glm::vec3 unit_normal(const Scene& scene, std::uint32_t triangle) {
  const glm::uvec3 corner = scene.triangles[triangle];
  const glm::dvec3 a = scene.positions_m[corner.x];
  const glm::dvec3 normal =
      glm::cross(glm::dvec3(scene.positions_m[corner.y]) - a, glm::dvec3(scene.positions_m[corner.z]) - a);
  const double length = std::sqrt(glm::dot(normal, normal));
  if (!std::isfinite(length) || length <= 0.0) return glm::vec3(0.0f);
  return glm::vec3(normal / length);
}

}  // namespace

// Opaque triangles are one Embree geometry; those whose texture decides whether a point exists are another, so that
// only the second pays for the filter.
struct RayScene::Impl {
  Owned<RTCDevice, ReleaseDevice> device;
  Owned<RTCScene, ReleaseScene> bvh;
  std::vector<std::uint32_t> triangles[2];  // Scene::triangles index of each primitive, by geometry
  const Scene* scene = nullptr;

  enum Geometry : unsigned { kOpaqueGeometry = 0, kTestedGeometry = 1 };

  Impl(const Scene& source, const std::string& isa);
  void attach(Geometry id, RTCBuffer vertices);
  static void filter(const RTCFilterFunctionNArguments* arguments);
};

RayScene::Impl::Impl(const Scene& source, const std::string& isa) : scene(&source) {
  device.reset(rtcNewDevice(device_config(isa).c_str()));
  if (!device) throw NoDevice("Embree could not start on this processor");
  bvh.reset(rtcNewScene(device.get()));
  rtcSetSceneFlags(bvh.get(), RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(bvh.get(), RTC_BUILD_QUALITY_HIGH);

  const std::vector<AlphaClass> classes = classify_alpha(source);
  for (std::uint32_t i = 0; i < source.triangles.size(); ++i) {
    const AlphaClass alpha = classes[source.triangle_material[i]];
    if (alpha == AlphaClass::kNever || unit_normal(source, i) == glm::vec3(0.0f)) continue;
    triangles[alpha == AlphaClass::kTested ? kTestedGeometry : kOpaqueGeometry].push_back(i);
  }
  // Embree reads 16 bytes at the last vertex, hence a buffer of its own with room behind.
  const std::size_t bytes = source.positions_m.size() * sizeof(glm::vec3);
  const Owned<RTCBuffer, ReleaseBuffer> vertices(rtcNewBuffer(device.get(), bytes + 16));
  check(device.get(), "allocate its vertices");
  if (bytes > 0) std::memcpy(rtcGetBufferData(vertices.get()), source.positions_m.data(), bytes);
  attach(kOpaqueGeometry, vertices.get());
  attach(kTestedGeometry, vertices.get());

  // One thread builds: the order of a parallel build's leaves, and so the winner among hits at one distance, would
  // depend on timing. Joining makes Embree build in this arena and not in its own.
  tbb::task_arena one_thread(1);
  one_thread.execute([&] { rtcJoinCommitScene(bvh.get()); });
  check(device.get(), "build its hierarchy");
}

void RayScene::Impl::attach(Geometry id, RTCBuffer vertices) {
  if (triangles[id].empty()) return;
  const Owned<RTCGeometry, ReleaseGeometry> geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
  rtcSetGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices, 0, sizeof(glm::vec3),
                       scene->positions_m.size());
  auto* corners = static_cast<glm::uvec3*>(rtcSetNewGeometryBuffer(
      geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(glm::uvec3), triangles[id].size()));
  check(device.get(), "allocate its triangles");
  for (std::size_t i = 0; i < triangles[id].size(); ++i) corners[i] = scene->triangles[triangles[id][i]];
  if (id == kTestedGeometry) {
    rtcSetGeometryUserData(geometry.get(), this);
    rtcSetGeometryIntersectFilterFunction(geometry.get(), &Impl::filter);
    rtcSetGeometryOccludedFilterFunction(geometry.get(), &Impl::filter);
  }
  rtcCommitGeometry(geometry.get());
  rtcAttachGeometryByID(bvh.get(), geometry.get(), id);
  check(device.get(), "take its triangles");
}

void RayScene::Impl::filter(const RTCFilterFunctionNArguments* arguments) {
  const auto* self = static_cast<const Impl*>(arguments->geometryUserPtr);
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (arguments->valid[i] == 0) continue;
    const std::uint32_t triangle = self->triangles[kTestedGeometry][RTCHitN_primID(arguments->hit, arguments->N, i)];
    const glm::vec2 barycentric(RTCHitN_u(arguments->hit, arguments->N, i), RTCHitN_v(arguments->hit, arguments->N, i));
    if (!point_exists(*self->scene, triangle, barycentric)) arguments->valid[i] = 0;
  }
}

namespace {

RTCRay make_ray(glm::vec3 origin, glm::vec3 direction, float t_near, float t_far) {
  RTCRay ray{};
  ray.org_x = origin.x;
  ray.org_y = origin.y;
  ray.org_z = origin.z;
  ray.tnear = t_near;
  ray.dir_x = direction.x;
  ray.dir_y = direction.y;
  ray.dir_z = direction.z;
  ray.tfar = t_far;
  ray.mask = ~0u;
  return ray;
}

}  // namespace

RayScene::RayScene(const Scene& scene, const std::string& isa)
    : scene_(scene), impl_(std::make_unique<Impl>(scene, isa)) {}

RayScene::~RayScene() = default;

SurfaceHit RayScene::closest(glm::vec3 origin_m, glm::vec3 direction, float t_near, float t_far) const {
  RTCRayHit query{};
  query.ray = make_ray(origin_m, direction, t_near, t_far);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(impl_->bvh.get(), &query);
  SurfaceHit result;
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return result;
  result.hit = true;
  result.t = query.ray.tfar;
  result.triangle = impl_->triangles[query.hit.geomID][query.hit.primID];
  result.barycentric = {query.hit.u, query.hit.v};
  result.geometric_normal = unit_normal(scene_, result.triangle);
  return result;
}

bool RayScene::occluded(glm::vec3 origin_m, glm::vec3 direction, float t_near, float t_far) const {
  RTCRay ray = make_ray(origin_m, direction, t_near, t_far);
  rtcOccluded1(impl_->bvh.get(), &ray);
  return ray.tfar < 0.0f;
}

}  // namespace probewalk
