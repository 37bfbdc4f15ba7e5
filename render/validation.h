// The validation layer: how it is switched on, and who counts what it says.
#pragma once

#include <volk.h>

#include <atomic>
#include <cstdint>

namespace probewalk {

inline constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

// Counts and logs errors and warnings. Not movable: the layer holds its address.
class ValidationLog {
 public:
  ValidationLog();
  ValidationLog(const ValidationLog&) = delete;
  ValidationLog& operator=(const ValidationLog&) = delete;

  // Chains onto an instance's create info; includes synchronisation validation, which is off by default.
  const void* instance_chain() const { return &features_; }
  void attach(VkInstance instance);
  void detach(VkInstance instance);
  std::uint32_t messages() const { return messages_; }

 private:
  static VKAPI_ATTR VkBool32 VKAPI_CALL receive(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                VkDebugUtilsMessageTypeFlagsEXT type,
                                                const VkDebugUtilsMessengerCallbackDataEXT* data, void* self);

  VkValidationFeatureEnableEXT enabled_ = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
  VkDebugUtilsMessengerCreateInfoEXT messenger_info_{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
  VkValidationFeaturesEXT features_{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT};
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  std::atomic<std::uint32_t> messages_{0};
};

// Whether the layer is installed.
bool has_validation_layer();

}  // namespace probewalk
