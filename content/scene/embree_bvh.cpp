#include "content/scene/embree_bvh.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string_view>

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
  if (isa == "avx512")
    return __builtin_cpu_supports("avx512vl") != 0 && __builtin_cpu_supports("avx512dq") != 0;
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

void check(RTCDevice device, const char* what) {
  if (rtcGetDeviceError(device) != RTC_ERROR_NONE) {
    throw NoDevice(fmt::format("Embree could not {}: {}", what, rtcGetDeviceLastErrorMessage(device)));
  }
}

}  // namespace

glm::vec3 unit_normal(const Scene& scene, std::uint32_t triangle) {
  const glm::uvec3 corner = scene.triangles[triangle];
  const glm::dvec3 a = scene.positions_m[corner.x];
  const glm::dvec3 normal =
      glm::cross(glm::dvec3(scene.positions_m[corner.y]) - a, glm::dvec3(scene.positions_m[corner.z]) - a);
  const double length = std::sqrt(glm::dot(normal, normal));
  if (!std::isfinite(length) || length <= 0.0) return glm::vec3(0.0f);
  return glm::vec3(normal / length);
}

EmbreeBvh::EmbreeBvh(const Scene& source, const EmbreeOptions& options) : scene(&source) {
  device.reset(rtcNewDevice(device_config(options.isa).c_str()));
  if (!device) throw NoDevice("Embree could not start on this processor");
  bvh.reset(rtcNewScene(device.get()));
  if (options.is_robust) rtcSetSceneFlags(bvh.get(), RTC_SCENE_FLAG_ROBUST);
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

  if (options.one_thread_builds) {
    // Joining makes Embree build in this arena and not in its own.
    tbb::task_arena one_thread(1);
    one_thread.execute([&] { rtcJoinCommitScene(bvh.get()); });
  } else {
    rtcCommitScene(bvh.get());
  }
  check(device.get(), "build its hierarchy");
}

void EmbreeBvh::attach(Geometry id, RTCBuffer vertices) {
  if (triangles[id].empty()) return;
  const Owned<RTCGeometry, ReleaseGeometry> geometry(
      rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
  rtcSetGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices, 0,
                       sizeof(glm::vec3), scene->positions_m.size());
  auto* corners = static_cast<glm::uvec3*>(rtcSetNewGeometryBuffer(
      geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(glm::uvec3), triangles[id].size()));
  check(device.get(), "allocate its triangles");
  for (std::size_t i = 0; i < triangles[id].size(); ++i) corners[i] = scene->triangles[triangles[id][i]];
  if (id == kTestedGeometry) {
    rtcSetGeometryUserData(geometry.get(), this);
    rtcSetGeometryIntersectFilterFunction(geometry.get(), &EmbreeBvh::filter);
    rtcSetGeometryOccludedFilterFunction(geometry.get(), &EmbreeBvh::filter);
  }
  rtcCommitGeometry(geometry.get());
  rtcAttachGeometryByID(bvh.get(), geometry.get(), id);
  check(device.get(), "take its triangles");
}

void EmbreeBvh::filter(const RTCFilterFunctionNArguments* arguments) {
  const auto* self = static_cast<const EmbreeBvh*>(arguments->geometryUserPtr);
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (arguments->valid[i] == 0) continue;
    const std::uint32_t triangle =
        self->triangles[kTestedGeometry][RTCHitN_primID(arguments->hit, arguments->N, i)];
    const glm::vec2 barycentric(RTCHitN_u(arguments->hit, arguments->N, i),
                                RTCHitN_v(arguments->hit, arguments->N, i));
    if (!point_exists(*self->scene, triangle, barycentric)) arguments->valid[i] = 0;
  }
}

}  // namespace probewalk
