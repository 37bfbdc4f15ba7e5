#include "render/device.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <mutex>

#include "render/check.h"
#include "render/device_requirements.h"
#include "render/validation.h"
#include "render/vma.h"

namespace probewalk {
namespace {

constexpr const char* kNoLoader =
    "no Vulkan loader found; install libvulkan1 and a driver (Debian: mesa-vulkan-drivers), or use commands that need no "
    "device";

void load_vulkan() {
  if (volkInitialize() != VK_SUCCESS) throw NoDevice(kNoLoader);
}

std::vector<const char*> c_strings(const std::vector<std::string>& texts) {
  std::vector<const char*> pointers;
  for (const std::string& text : texts) pointers.push_back(text.c_str());
  return pointers;
}

VkInstance create_instance(const DeviceHooks& hooks, const ValidationLog* validation) {
  VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
  application.pApplicationName = "Probewalk";
  application.apiVersion = VK_API_VERSION_1_3;
  auto extensions = c_strings(hooks.instance_extensions);
  VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
  info.pApplicationInfo = &application;
  if (validation != nullptr) {
    extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    info.pNext = validation->instance_chain();
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &kValidationLayer;
  }
  info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  VkInstance instance = VK_NULL_HANDLE;
  const VkResult result = hooks.create_instance ? hooks.create_instance(vkGetInstanceProcAddr, info, &instance)
                                                : vkCreateInstance(&info, nullptr, &instance);
  if (result == VK_ERROR_INCOMPATIBLE_DRIVER) {
    throw NoDevice("no Vulkan driver found; install one (Debian: mesa-vulkan-drivers)");
  }
  check(result, "vkCreateInstance");
  return instance;
}

// The best device first; equal ones in the loader's order.
std::vector<VkPhysicalDevice> physical_devices(VkInstance instance) {
  std::uint32_t count = 0;
  check(vkEnumeratePhysicalDevices(instance, &count, nullptr), "vkEnumeratePhysicalDevices");
  std::vector<VkPhysicalDevice> devices(count);
  check(vkEnumeratePhysicalDevices(instance, &count, devices.data()), "vkEnumeratePhysicalDevices");
  devices.resize(count);
  std::stable_sort(devices.begin(), devices.end(),
                   [](VkPhysicalDevice a, VkPhysicalDevice b) { return device_rank(a) < device_rank(b); });
  return devices;
}

std::string list_text(const std::vector<DeviceInfo>& infos) {
  std::string text;
  for (std::size_t i = 0; i < infos.size(); ++i) {
    text += fmt::format("{}{} {}{}", i == 0 ? "" : "; ", i, infos[i].name,
                        infos[i].suitable ? "" : " (lacks " + infos[i].missing + ")");
  }
  return text.empty() ? "none" : text;
}

// Index of the device that `wanted` names, or the first suitable one.
std::size_t choose(const std::vector<DeviceInfo>& infos, const std::string& wanted) {
  std::size_t index = infos.size();
  if (wanted.empty()) {
    const auto found = std::find_if(infos.begin(), infos.end(), [](const DeviceInfo& info) { return info.suitable; });
    if (found == infos.end()) {
      throw NoDevice(fmt::format("no suitable Vulkan device; seen: {}; install a Vulkan 1.3 driver (Debian: "
                                 "mesa-vulkan-drivers)", list_text(infos)));
    }
    return static_cast<std::size_t>(found - infos.begin());
  }
  const auto parsed = std::from_chars(wanted.data(), wanted.data() + wanted.size(), index);
  if (parsed.ec != std::errc{} || parsed.ptr != wanted.data() + wanted.size()) {
    const auto found = std::find_if(infos.begin(), infos.end(), [&](const DeviceInfo& info) {
      return info.name.find(wanted) != std::string::npos;
    });
    index = static_cast<std::size_t>(found - infos.begin());
  }
  if (index >= infos.size()) {
    throw NoDevice(fmt::format("no Vulkan device matches --device {}; seen: {}", wanted, list_text(infos)));
  }
  if (!infos[index].suitable) {
    throw NoDevice(fmt::format("Vulkan device {} is not suitable: it lacks {}; seen: {}", infos[index].name,
                               infos[index].missing, list_text(infos)));
  }
  return index;
}

}  // namespace

struct Device::Impl {
  ValidationLog validation;
  bool is_validating = false;
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  std::uint32_t family = 0, copy_family = 0;
  VkQueue queue = VK_NULL_HANDLE, copy_queue = VK_NULL_HANDLE, mirror_queue = VK_NULL_HANDLE;
  VmaAllocator allocator = VK_NULL_HANDLE;
  DeviceInfo info;
  bool has_memory_budget = false;
  bool has_calibrated_timestamps = false;
  float timestamp_period_ns = 1.0f;
  std::atomic<std::uint64_t> allocated_bytes{0};
  std::atomic<std::uint32_t> pipelines_built{0};
  std::mutex queue_mutex, copy_mutex, mirror_mutex;

  // Nobody may submit meanwhile.
  VkResult wait_idle() {
    const std::scoped_lock lock(queue_mutex, copy_mutex, mirror_mutex);
    return vkDeviceWaitIdle(device);
  }

  ~Impl() {
    if (device != VK_NULL_HANDLE) wait_idle();
    if (allocator != VK_NULL_HANDLE) vmaDestroyAllocator(allocator);
    if (device != VK_NULL_HANDLE) vkDestroyDevice(device, nullptr);
    if (instance == VK_NULL_HANDLE) return;
    validation.detach(instance);
    vkDestroyInstance(instance, nullptr);
  }

  void choose_physical(const DeviceHooks& hooks, const DeviceOptions& options);
  void create_device(const DeviceHooks& hooks);
  void create_allocator();
};

void Device::Impl::choose_physical(const DeviceHooks& hooks, const DeviceOptions& options) {
  const auto can_present = [&](VkPhysicalDevice candidate) -> CanPresent {
    if (!hooks.can_present) return {};
    return [&hooks, candidate, this](std::uint32_t f) { return hooks.can_present(instance, candidate, f); };
  };
  const auto devices = physical_devices(instance);
  std::vector<DeviceInfo> infos;
  for (VkPhysicalDevice candidate : devices) {
    infos.push_back(describe_device(candidate, hooks.device_extensions, can_present(candidate)));
  }
  std::size_t index = infos.size();
  if (hooks.choose_physical_device) {
    // The runtime's headset hangs on one device: there is nothing to choose, only to refuse.
    const VkPhysicalDevice given = hooks.choose_physical_device(instance);
    index = static_cast<std::size_t>(std::find(devices.begin(), devices.end(), given) - devices.begin());
    if (index == devices.size()) throw NoDevice("the runtime names no Vulkan device; is the headset connected?");
    choose(infos, std::to_string(index));
    if (!options.device.empty() && choose(infos, options.device) != index) {
      throw NoDevice(fmt::format("--device {} is not the device that the headset needs ({}); leave --device away",
                                 options.device, infos[index].name));
    }
  } else {
    index = choose(infos, options.device);
  }
  physical = devices[index];
  info = infos[index];
  family = find_queue_family(physical, can_present(physical)).value();
  copy_family = find_copy_queue_family(physical).value_or(family);
}

void Device::Impl::create_device(const DeviceHooks& hooks) {
  auto extensions = c_strings(hooks.device_extensions);
  has_memory_budget = has_extension(physical, VK_EXT_MEMORY_BUDGET_EXTENSION_NAME);
  if (has_memory_budget) extensions.push_back(VK_EXT_MEMORY_BUDGET_EXTENSION_NAME);
  has_calibrated_timestamps = has_extension(physical, VK_EXT_CALIBRATED_TIMESTAMPS_EXTENSION_NAME);
  if (has_calibrated_timestamps) extensions.push_back(VK_EXT_CALIBRATED_TIMESTAMPS_EXTENSION_NAME);
  const RequiredFeatures features;
  constexpr std::array priorities{1.0f, 0.5f};
  const std::uint32_t family_queues = queue_count(physical, family) > 1 ? 2 : 1;
  std::vector<VkDeviceQueueCreateInfo> queues;
  for (const std::uint32_t each : {family, copy_family}) {
    if (!queues.empty() && each == family) continue;
    VkDeviceQueueCreateInfo& queue_info = queues.emplace_back();
    queue_info.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
    queue_info.queueFamilyIndex = each;
    queue_info.queueCount = each == family ? family_queues : 1;
    queue_info.pQueuePriorities = priorities.data();
  }
  VkDeviceCreateInfo device_info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
  device_info.pNext = &features.head;
  device_info.queueCreateInfoCount = static_cast<std::uint32_t>(queues.size());
  device_info.pQueueCreateInfos = queues.data();
  device_info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
  device_info.ppEnabledExtensionNames = extensions.data();
  check(hooks.create_device ? hooks.create_device(vkGetInstanceProcAddr, physical, device_info, &device)
                            : vkCreateDevice(physical, &device_info, nullptr, &device),
        "vkCreateDevice");
  volkLoadDevice(device);
  vkGetDeviceQueue(device, family, 0, &queue);
  vkGetDeviceQueue(device, copy_family, 0, &copy_queue);
  vkGetDeviceQueue(device, family, family_queues - 1, &mirror_queue);
  VkPhysicalDeviceProperties properties{};
  vkGetPhysicalDeviceProperties(physical, &properties);
  timestamp_period_ns = properties.limits.timestampPeriod;
}

void Device::Impl::create_allocator() {
  // VK_EXT_memory_budget may count the whole machine's memory: what this process holds is counted here.
  VmaDeviceMemoryCallbacks callbacks{};
  callbacks.pfnAllocate = [](VmaAllocator, std::uint32_t, VkDeviceMemory, VkDeviceSize size, void* count) {
    *static_cast<std::atomic<std::uint64_t>*>(count) += size;
  };
  callbacks.pfnFree = [](VmaAllocator, std::uint32_t, VkDeviceMemory, VkDeviceSize size, void* count) {
    *static_cast<std::atomic<std::uint64_t>*>(count) -= size;
  };
  callbacks.pUserData = &allocated_bytes;
  VmaVulkanFunctions functions{};
  functions.vkGetInstanceProcAddr = vkGetInstanceProcAddr;
  functions.vkGetDeviceProcAddr = vkGetDeviceProcAddr;
  VmaAllocatorCreateInfo allocator_info{};
  allocator_info.flags = VMA_ALLOCATOR_CREATE_BUFFER_DEVICE_ADDRESS_BIT;
  if (has_memory_budget) allocator_info.flags |= VMA_ALLOCATOR_CREATE_EXT_MEMORY_BUDGET_BIT;
  allocator_info.physicalDevice = physical;
  allocator_info.device = device;
  allocator_info.instance = instance;
  allocator_info.vulkanApiVersion = VK_API_VERSION_1_3;
  // Small blocks, so that what a few rooms take is close to what is counted.
  allocator_info.preferredLargeHeapBlockSize = VkDeviceSize{32} << 20;
  allocator_info.pDeviceMemoryCallbacks = &callbacks;
  allocator_info.pVulkanFunctions = &functions;
  check(vmaCreateAllocator(&allocator_info, &allocator), "vmaCreateAllocator");
}

Device::Device(const DeviceHooks& hooks, const DeviceOptions& options) : impl_(std::make_unique<Impl>()) {
  load_vulkan();
  impl_->is_validating = options.validation && has_validation_layer();
  if (options.validation && !impl_->is_validating) {
    throw NoDevice("the Vulkan validation layer is not installed (Debian: vulkan-validationlayers)");
  }
  impl_->instance = create_instance(hooks, impl_->is_validating ? &impl_->validation : nullptr);
  volkLoadInstance(impl_->instance);
  if (impl_->is_validating) impl_->validation.attach(impl_->instance);
  impl_->choose_physical(hooks, options);
  impl_->create_device(hooks);
  impl_->create_allocator();
}

Device::~Device() = default;

std::vector<DeviceInfo> Device::list() {
  load_vulkan();
  const VkInstance instance = create_instance({}, nullptr);
  volkLoadInstanceOnly(instance);
  std::vector<DeviceInfo> infos;
  for (VkPhysicalDevice device : physical_devices(instance)) infos.push_back(describe_device(device, {}, {}));
  vkDestroyInstance(instance, nullptr);
  return infos;
}

VkInstance Device::instance() const { return impl_->instance; }
VkPhysicalDevice Device::physical() const { return impl_->physical; }
VkDevice Device::handle() const { return impl_->device; }
VkQueue Device::queue() const { return impl_->queue; }
std::uint32_t Device::queue_family() const { return impl_->family; }
std::uint32_t Device::copy_queue_family() const { return impl_->copy_family; }
VmaAllocator_T* Device::allocator() const { return impl_->allocator; }
const DeviceInfo& Device::info() const { return impl_->info; }
bool Device::has_calibrated_timestamps() const { return impl_->has_calibrated_timestamps; }
float Device::timestamp_period_ns() const { return impl_->timestamp_period_ns; }
std::uint32_t Device::validation_messages() const { return impl_->validation.messages(); }
std::uint64_t Device::allocated_bytes() const { return impl_->allocated_bytes; }

std::uint64_t Device::free_bytes() const {
  std::array<VmaBudget, VK_MAX_MEMORY_HEAPS> budgets{};
  vmaGetHeapBudgets(impl_->allocator, budgets.data());
  const VkPhysicalDeviceMemoryProperties* memory = nullptr;
  vmaGetMemoryProperties(impl_->allocator, &memory);
  std::uint64_t most = 0;
  for (std::uint32_t heap = 0; heap < memory->memoryHeapCount; ++heap) {
    if ((memory->memoryHeaps[heap].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) == 0) continue;
    most = std::max(most, budgets[heap].budget - std::min(budgets[heap].usage, budgets[heap].budget));
  }
  return most;
}

std::uint32_t Device::pipelines_built() const { return impl_->pipelines_built; }

void Device::count_pipeline() const { ++impl_->pipelines_built; }

std::unique_lock<std::mutex> Device::lock_queue() const { return std::unique_lock(impl_->queue_mutex); }

void Device::submit(const VkSubmitInfo2& info, VkFence fence) const {
  const std::lock_guard lock(impl_->queue_mutex);
  check(vkQueueSubmit2(impl_->queue, 1, &info, fence), "vkQueueSubmit2");
}

void Device::submit_copies(const VkSubmitInfo2& info) const {
  if (!has_copy_queue()) return submit(info, VK_NULL_HANDLE);
  const std::lock_guard lock(impl_->copy_mutex);
  check(vkQueueSubmit2(impl_->copy_queue, 1, &info, VK_NULL_HANDLE), "vkQueueSubmit2");
}

VkResult Device::present(const VkPresentInfoKHR& info) const {
  const std::lock_guard lock(impl_->mirror_queue == impl_->queue ? impl_->queue_mutex : impl_->mirror_mutex);
  return vkQueuePresentKHR(impl_->mirror_queue, &info);
}

void Device::wait_idle() const {
  check(impl_->wait_idle(), "vkDeviceWaitIdle");
}

void Device::wait_idle_or_lost() const noexcept {
  impl_->wait_idle();
}

}  // namespace probewalk
