// A Vulkan layer for tests: between the application and a real driver it lets vkAllocateMemory fail on order, with the
// result that a full device gives. Everything else passes.
//
// PROBEWALK_TEST_MEMORY="key=value;..." in the environment:
//   log=FILE        a line for each allocation: its bytes, and 1 if it was refused
//   after=N         the first N allocations are left alone (default 0)
//   at_least=B      only those of B bytes or more are refused (default 0)
//   refuse=N        so many of them are refused (default: all)
#include <vulkan/vk_layer.h>
#include <vulkan/vulkan.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <mutex>
#include <sstream>
#include <string>

namespace {

struct Layer {
  std::mutex mutex;
  std::map<std::string, std::string> settings;
  std::ofstream log;
  std::uint64_t asked = 0, refused = 0;
  PFN_vkGetInstanceProcAddr next_instance_proc = nullptr;
  PFN_vkGetDeviceProcAddr next_device_proc = nullptr;
  VkInstance instance = VK_NULL_HANDLE;
  PFN_vkAllocateMemory allocate = nullptr;

  std::uint64_t number(const char* key, std::uint64_t otherwise) const {
    const auto found = settings.find(key);
    return found == settings.end() ? otherwise : std::strtoull(found->second.c_str(), nullptr, 10);
  }
};
Layer layer;

void read_settings() {
  const char* text = std::getenv("PROBEWALK_TEST_MEMORY");
  std::istringstream all(text != nullptr ? text : "");
  for (std::string entry; std::getline(all, entry, ';');) {
    const std::size_t at = entry.find('=');
    if (at != std::string::npos) layer.settings[entry.substr(0, at)] = entry.substr(at + 1);
  }
  if (layer.settings.contains("log")) layer.log.open(layer.settings["log"], std::ios::app);
}

VKAPI_ATTR VkResult VKAPI_CALL allocate_memory(VkDevice device, const VkMemoryAllocateInfo* info,
                                               const VkAllocationCallbacks* callbacks, VkDeviceMemory* memory) {
  constexpr std::uint64_t kAlways = std::numeric_limits<std::uint64_t>::max();
  {
    const std::lock_guard lock(layer.mutex);
    const std::uint64_t bytes = info->allocationSize;
    const bool is_meant = layer.asked++ >= layer.number("after", 0) && bytes >= layer.number("at_least", 0);
    const bool refuses = is_meant && layer.refused < layer.number("refuse", kAlways);
    layer.log << bytes << (refuses ? " 1" : " 0") << std::endl;
    if (refuses) {
      ++layer.refused;
      return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    }
  }
  return layer.allocate(device, info, callbacks, memory);
}

// The loader's link to the next layer or driver, in a chain of structures.
template <typename Info>
Info* link_of(const void* chain, VkStructureType type) {
  auto* each = reinterpret_cast<Info*>(const_cast<void*>(chain));
  while (each != nullptr && !(each->sType == type && each->function == VK_LAYER_LINK_INFO)) {
    each = reinterpret_cast<Info*>(const_cast<void*>(each->pNext));
  }
  return each;
}

VKAPI_ATTR VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* callbacks,
                                               VkInstance* instance) {
  auto* link = link_of<VkLayerInstanceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO);
  if (link == nullptr) return VK_ERROR_INITIALIZATION_FAILED;
  layer.next_instance_proc = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  const auto create =
      reinterpret_cast<PFN_vkCreateInstance>(layer.next_instance_proc(VK_NULL_HANDLE, "vkCreateInstance"));
  const VkResult result = create(info, callbacks, instance);
  if (result == VK_SUCCESS) layer.instance = *instance;
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL create_device(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                                             const VkAllocationCallbacks* callbacks, VkDevice* device) {
  auto* link = link_of<VkLayerDeviceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
  if (link == nullptr) return VK_ERROR_INITIALIZATION_FAILED;
  const PFN_vkGetInstanceProcAddr instance_proc = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  layer.next_device_proc = link->u.pLayerInfo->pfnNextGetDeviceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  const auto create = reinterpret_cast<PFN_vkCreateDevice>(instance_proc(layer.instance, "vkCreateDevice"));
  const VkResult result = create(physical, info, callbacks, device);
  if (result != VK_SUCCESS) return result;
  const std::lock_guard lock(layer.mutex);
  if (layer.settings.empty()) read_settings();
  layer.allocate = reinterpret_cast<PFN_vkAllocateMemory>(layer.next_device_proc(*device, "vkAllocateMemory"));
  return result;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL device_proc(VkDevice device, const char* name);

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL instance_proc(VkInstance instance, const char* name) {
  const auto is = [&](const char* other) { return std::strcmp(name, other) == 0; };
  if (is("vkGetInstanceProcAddr")) return reinterpret_cast<PFN_vkVoidFunction>(&instance_proc);
  if (is("vkCreateInstance")) return reinterpret_cast<PFN_vkVoidFunction>(&create_instance);
  if (is("vkCreateDevice")) return reinterpret_cast<PFN_vkVoidFunction>(&create_device);
  if (is("vkGetDeviceProcAddr")) return reinterpret_cast<PFN_vkVoidFunction>(&device_proc);
  if (is("vkAllocateMemory")) return reinterpret_cast<PFN_vkVoidFunction>(&allocate_memory);
  return layer.next_instance_proc == nullptr ? nullptr : layer.next_instance_proc(instance, name);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL device_proc(VkDevice device, const char* name) {
  if (std::strcmp(name, "vkGetDeviceProcAddr") == 0) return reinterpret_cast<PFN_vkVoidFunction>(&device_proc);
  if (std::strcmp(name, "vkAllocateMemory") == 0) return reinterpret_cast<PFN_vkVoidFunction>(&allocate_memory);
  return layer.next_device_proc(device, name);
}

}  // namespace

extern "C" VKAPI_ATTR VkResult VKAPI_CALL vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* version) {
  if (version->sType != LAYER_NEGOTIATE_INTERFACE_STRUCT || version->loaderLayerInterfaceVersion < 2) {
    return VK_ERROR_INITIALIZATION_FAILED;
  }
  version->loaderLayerInterfaceVersion = 2;
  version->pfnGetInstanceProcAddr = &instance_proc;
  version->pfnGetDeviceProcAddr = &device_proc;
  version->pfnGetPhysicalDeviceProcAddr = nullptr;
  return VK_SUCCESS;
}
