#include "render/triangle_query.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <vector>

#include "content/scene/alpha_test.h"
#include "render/buffer.h"
#include "render/check.h"
#include "render/device_requirements.h"
#include "render/one_shot.h"
#include "render/pipeline.h"
#include "render/spirv.h"

namespace probewalk {
namespace {

constexpr std::uint32_t kGroup = 64;  // local size of trace_triangles.comp
constexpr std::size_t kRaysPerDispatch = std::size_t{1} << 20;
constexpr VkBufferUsageFlags kBuildInput =
    VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR;

static_assert(kWrapRepeat == static_cast<pw_uint>(WrapMode::kRepeat));
static_assert(kWrapMirrored == static_cast<pw_uint>(WrapMode::kMirroredRepeat));
static_assert(kWrapClamp == static_cast<pw_uint>(WrapMode::kClampToEdge));

constexpr std::array kExtensions{VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME,
                                 VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
                                 VK_KHR_RAY_QUERY_EXTENSION_NAME};

// The features of ray queries, chained from `queries`; what follows `structures` is the caller's to fill. Not
// movable.
struct RayQueryFeatures {
  VkPhysicalDeviceAccelerationStructureFeaturesKHR structures{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR, nullptr, VK_TRUE};
  VkPhysicalDeviceRayQueryFeaturesKHR queries{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR,
                                              &structures, VK_TRUE};

  RayQueryFeatures() = default;
  RayQueryFeatures(const RayQueryFeatures&) = delete;
  RayQueryFeatures& operator=(const RayQueryFeatures&) = delete;
};

bool supports_ray_query(VkPhysicalDevice device) {
  for (const char* extension : kExtensions) {
    if (!has_extension(device, extension)) return false;
  }
  RayQueryFeatures has;
  VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &has.queries};
  vkGetPhysicalDeviceFeatures2(device, &features);
  return has.structures.accelerationStructure && has.queries.rayQuery;
}

std::int64_t now_ns() {
  return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
}

// Empty vectors get a buffer as well: every address is one.
template <typename T>
Buffer upload(const Device& device, const std::vector<T>& values, VkBufferUsageFlags usage = 0) {
  Buffer buffer(device, std::max<std::size_t>(16, values.size() * sizeof(T)), BufferMemory::kShared, usage);
  if (!values.empty()) std::memcpy(buffer.mapped(), values.data(), values.size() * sizeof(T));
  buffer.flush();
  return buffer;
}

// Triangles without area or with a corner that is not finite are hit by no ray.
bool can_be_hit(const Scene& scene, glm::uvec3 corner) {
  const glm::dvec3 a = scene.positions_m[corner.x];
  const glm::dvec3 normal =
      glm::cross(glm::dvec3(scene.positions_m[corner.y]) - a, glm::dvec3(scene.positions_m[corner.z]) - a);
  const double length = glm::dot(normal, normal);
  return std::isfinite(length) && length > 0.0;
}

// An acceleration structure with the memory it lies in.
class Structure {
 public:
  Structure(const Device& device, VkAccelerationStructureTypeKHR type, VkDeviceSize bytes)
      : device_(device.handle()),
        memory_(device, bytes, BufferMemory::kDevice,
                VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR) {
    VkAccelerationStructureCreateInfoKHR info{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_CREATE_INFO_KHR};
    info.buffer = memory_.handle();
    info.size = bytes;
    info.type = type;
    check(vkCreateAccelerationStructureKHR(device_, &info, nullptr, &handle_),
          "vkCreateAccelerationStructureKHR");
    VkAccelerationStructureDeviceAddressInfoKHR address_info{
        VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR};
    address_info.accelerationStructure = handle_;
    address_ = vkGetAccelerationStructureDeviceAddressKHR(device_, &address_info);
  }
  ~Structure() { vkDestroyAccelerationStructureKHR(device_, handle_, nullptr); }
  Structure(const Structure&) = delete;
  Structure& operator=(const Structure&) = delete;

  VkAccelerationStructureKHR handle() const { return handle_; }
  VkDeviceAddress address() const { return address_; }
  std::uint64_t bytes() const { return memory_.size_bytes(); }

 private:
  VkDevice device_;
  Buffer memory_;
  VkAccelerationStructureKHR handle_ = VK_NULL_HANDLE;
  VkDeviceAddress address_ = 0;
};

VkDeviceSize scratch_alignment(const Device& device) {
  VkPhysicalDeviceAccelerationStructurePropertiesKHR structures{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_PROPERTIES_KHR};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &structures};
  vkGetPhysicalDeviceProperties2(device.physical(), &properties);
  return std::max<VkDeviceSize>(1, structures.minAccelerationStructureScratchOffsetAlignment);
}

std::unique_ptr<Structure> build(const Device& device, VkAccelerationStructureTypeKHR type,
                                 std::span<const VkAccelerationStructureGeometryKHR> geometries,
                                 std::span<const std::uint32_t> primitives) {
  VkAccelerationStructureBuildGeometryInfoKHR info{
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR};
  info.type = type;
  info.flags = VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_TRACE_BIT_KHR;
  info.mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR;
  info.geometryCount = static_cast<std::uint32_t>(geometries.size());
  info.pGeometries = geometries.data();
  VkAccelerationStructureBuildSizesInfoKHR sizes{
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR};
  vkGetAccelerationStructureBuildSizesKHR(device.handle(), VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR,
                                          &info, primitives.data(), &sizes);
  auto structure = std::make_unique<Structure>(device, type, sizes.accelerationStructureSize);
  const VkDeviceSize alignment = scratch_alignment(device);
  const Buffer scratch(device, sizes.buildScratchSize + alignment, BufferMemory::kDevice);
  info.dstAccelerationStructure = structure->handle();
  info.scratchData.deviceAddress = (scratch.address() + alignment - 1) / alignment * alignment;
  std::vector<VkAccelerationStructureBuildRangeInfoKHR> ranges;
  for (const std::uint32_t count : primitives) ranges.push_back({count, 0, 0, 0});
  const VkAccelerationStructureBuildRangeInfoKHR* first = ranges.data();
  run_commands(device, [&](VkCommandBuffer commands) {
    vkCmdBuildAccelerationStructuresKHR(commands, 1, &info, &first);
  });
  return structure;
}

// What decides whether points of the tested triangles exist.
struct AlphaData {
  std::vector<Buffer> texels;  // by texture
  Buffer textures, triangles;

  AlphaData(const Device& device, const Scene& scene, const std::vector<std::uint32_t>& tested) {
    std::vector<AlphaTexture> list;
    std::vector<AlphaTriangle> of_triangles;
    std::vector<int> place(scene.textures.size(), -1);
    of_triangles.reserve(tested.size());
    for (const std::uint32_t triangle : tested) {
      const Material& material = scene.materials[scene.triangle_material[triangle]];
      const auto source = static_cast<std::size_t>(material.base_color.texture);
      if (place[source] < 0) {
        place[source] = static_cast<int>(list.size());
        list.push_back(add_texture(device, scene.textures[source]));
      }
      const int set = material.base_color.uv_set;
      of_triangles.push_back(
          {interpolate_uv(scene, triangle, {0, 0}, set), interpolate_uv(scene, triangle, {1, 0}, set),
           interpolate_uv(scene, triangle, {0, 1}, set), static_cast<pw_uint>(place[source]),
           material.base_color_factor.a, alpha_threshold(material)});
    }
    textures = upload(device, list);
    triangles = upload(device, of_triangles);
  }

 private:
  AlphaTexture add_texture(const Device& device, const Texture& texture) {
    const Texture::Level& level = texture.levels.front();
    std::vector<std::uint8_t> alpha(level.rgba.size() / 4);
    for (std::size_t i = 0; i < alpha.size(); ++i) alpha[i] = level.rgba[4 * i + 3];
    alpha.resize((alpha.size() + 3) & ~std::size_t{3});
    texels.push_back(upload(device, alpha));
    return {address_words(texels.back().address()), static_cast<pw_uint>(level.width_px),
            static_cast<pw_uint>(level.height_px), static_cast<pw_uint>(texture.wrap_u),
            static_cast<pw_uint>(texture.wrap_v)};
  }
};

}  // namespace

struct TriangleQuery::Impl {
  const Device& device;
  Pipeline pipeline;
  std::vector<std::uint32_t> triangles[2];  // by geometry
  AlphaData alpha;
  std::unique_ptr<Structure> bottom, top;
  std::int64_t build_ns = 0;

  Impl(const Device& owner, const Scene& scene)
      : device(owner),
        pipeline(Pipeline::compute(owner, nullptr, spirv::k_trace_triangles_comp, {})),
        triangles{split(scene, false), split(scene, true)},
        alpha(owner, scene, triangles[kTestedGeometry]) {
    const std::int64_t begin_ns = now_ns();
    build_bottom(scene);
    build_top();
    build_ns = now_ns() - begin_ns;
  }

  static std::vector<std::uint32_t> split(const Scene& scene, bool tested) {
    const std::vector<AlphaClass> classes = classify_alpha(scene);
    std::vector<std::uint32_t> list;
    for (std::uint32_t i = 0; i < scene.triangles.size(); ++i) {
      const AlphaClass wanted = tested ? AlphaClass::kTested : AlphaClass::kAlways;
      if (classes[scene.triangle_material[i]] == wanted && can_be_hit(scene, scene.triangles[i]))
        list.push_back(i);
    }
    return list;
  }

  void build_bottom(const Scene& scene) {
    const Buffer vertices = upload(device, scene.positions_m, kBuildInput);
    std::array<Buffer, 2> indices;
    std::vector<VkAccelerationStructureGeometryKHR> geometries;
    std::vector<std::uint32_t> counts;
    for (const pw_uint id : {kOpaqueGeometry, kTestedGeometry}) {
      std::vector<glm::uvec3> corners;
      corners.reserve(triangles[id].size());
      for (const std::uint32_t triangle : triangles[id]) corners.push_back(scene.triangles[triangle]);
      indices[id] = upload(device, corners, kBuildInput);
      VkAccelerationStructureGeometryKHR geometry{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR};
      geometry.geometryType = VK_GEOMETRY_TYPE_TRIANGLES_KHR;
      geometry.flags = id == kOpaqueGeometry ? VK_GEOMETRY_OPAQUE_BIT_KHR
                                             : VK_GEOMETRY_NO_DUPLICATE_ANY_HIT_INVOCATION_BIT_KHR;
      VkAccelerationStructureGeometryTrianglesDataKHR& data = geometry.geometry.triangles;
      data = {VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_TRIANGLES_DATA_KHR};
      data.vertexFormat = VK_FORMAT_R32G32B32_SFLOAT;
      data.vertexData.deviceAddress = vertices.address();
      data.vertexStride = sizeof(glm::vec3);
      data.maxVertex = static_cast<std::uint32_t>(std::max<std::size_t>(1, scene.positions_m.size())) - 1;
      data.indexType = VK_INDEX_TYPE_UINT32;
      data.indexData.deviceAddress = indices[id].address();
      geometries.push_back(geometry);
      counts.push_back(static_cast<std::uint32_t>(triangles[id].size()));
    }
    bottom = build(device, VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, geometries, counts);
  }

  void build_top() {
    VkAccelerationStructureInstanceKHR instance{};
    for (int axis = 0; axis < 3; ++axis) instance.transform.matrix[axis][axis] = 1.0f;
    instance.mask = 0xFF;
    instance.flags = VK_GEOMETRY_INSTANCE_TRIANGLE_FACING_CULL_DISABLE_BIT_KHR;
    instance.accelerationStructureReference = bottom->address();
    const Buffer instances =
        upload(device, std::vector<VkAccelerationStructureInstanceKHR>{instance}, kBuildInput);
    VkAccelerationStructureGeometryKHR geometry{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR};
    geometry.geometryType = VK_GEOMETRY_TYPE_INSTANCES_KHR;
    geometry.geometry.instances = {VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_INSTANCES_DATA_KHR};
    geometry.geometry.instances.data.deviceAddress = instances.address();
    const std::uint32_t count = 1;
    top = build(device, VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR, {&geometry, 1}, {&count, 1});
  }

  std::int64_t trace(std::span<const TriangleRay> rays, std::span<float> t_m) const;
};

std::int64_t TriangleQuery::Impl::trace(std::span<const TriangleRay> rays, std::span<float> t_m) const {
  const std::size_t largest = std::min(rays.size(), kRaysPerDispatch);
  if (largest == 0) return 0;
  const Buffer constants(device, sizeof(TriangleQueryConstants), BufferMemory::kShared);
  const Buffer ray_buffer(device, largest * sizeof(TriangleRay), BufferMemory::kShared);
  const Buffer distances(device, largest * sizeof(float), BufferMemory::kReadback);
  std::int64_t sum_ns = 0;
  for (std::size_t first = 0; first < rays.size(); first += largest) {
    const auto part = rays.subspan(first, std::min(largest, rays.size() - first));
    std::copy(part.begin(), part.end(), ray_buffer.mapped_as<TriangleRay>().begin());
    ray_buffer.flush();
    TriangleQueryConstants query{};
    query.structure_address = address_words(top->address());
    query.rays_address = address_words(ray_buffer.address());
    query.distances_address = address_words(distances.address());
    query.alpha_triangles_address = address_words(alpha.triangles.address());
    query.alpha_textures_address = address_words(alpha.textures.address());
    query.ray_count = static_cast<pw_uint>(part.size());
    std::memcpy(constants.mapped(), &query, sizeof(query));
    constants.flush();
    const std::int64_t begin_ns = now_ns();
    run_commands(device, [&](VkCommandBuffer commands) {
      pipeline.bind(commands, nullptr, {constants.address()});
      vkCmdDispatch(commands, (query.ray_count + kGroup - 1) / kGroup, 1, 1);
      make_visible_to_cpu(commands);
    });
    sum_ns += now_ns() - begin_ns;
    distances.invalidate();
    const auto done = distances.mapped_as<float>().first(part.size());
    std::copy(done.begin(), done.end(), t_m.begin() + static_cast<std::ptrdiff_t>(first));
  }
  return sum_ns;
}

DeviceHooks with_ray_query(DeviceHooks hooks) {
  const auto create_device = hooks.create_device;
  hooks.create_device = [create_device](PFN_vkGetInstanceProcAddr get_proc, VkPhysicalDevice physical,
                                        const VkDeviceCreateInfo& wanted, VkDevice* device) {
    VkDeviceCreateInfo info = wanted;
    RayQueryFeatures features;
    std::vector<const char*> extensions(wanted.ppEnabledExtensionNames,
                                        wanted.ppEnabledExtensionNames + wanted.enabledExtensionCount);
    if (supports_ray_query(physical)) {
      features.structures.pNext = const_cast<void*>(wanted.pNext);
      info.pNext = &features.queries;
      extensions.insert(extensions.end(), kExtensions.begin(), kExtensions.end());
      info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
      info.ppEnabledExtensionNames = extensions.data();
    }
    return create_device ? create_device(get_proc, physical, info, device)
                         : vkCreateDevice(physical, &info, nullptr, device);
  };
  return hooks;
}

bool has_ray_query(const Device& device) {
  // Known only where its extension was switched on, which with_ray_query does together with the queries'.
  return vkGetDeviceProcAddr(device.handle(), "vkCreateAccelerationStructureKHR") != nullptr;
}

TriangleQuery::TriangleQuery(const Device& device, const Scene& scene) {
  if (!has_ray_query(device)) {
    throw NoDevice(
        fmt::format("Vulkan device {} was opened without ray queries, or has none (VK_KHR_ray_query)",
                    device.info().name));
  }
  impl_ = std::make_unique<Impl>(device, scene);
}

TriangleQuery::~TriangleQuery() = default;

std::int64_t TriangleQuery::trace(std::span<const TriangleRay> rays, std::span<float> t_m) const {
  return impl_->trace(rays, t_m);
}
std::int64_t TriangleQuery::build_ns() const {
  return impl_->build_ns;
}
std::uint64_t TriangleQuery::structure_bytes() const {
  return impl_->bottom->bytes() + impl_->top->bytes();
}

}  // namespace probewalk
