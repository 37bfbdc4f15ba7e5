#include "render/validation.h"

#include <spdlog/spdlog.h>

#include <cstring>
#include <vector>

#include "render/check.h"

namespace probewalk {

ValidationLog::ValidationLog() {
  messenger_info_.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  messenger_info_.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT |
                                VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT |
                                VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
  messenger_info_.pfnUserCallback = receive;
  messenger_info_.pUserData = this;
  // The chained messenger hears what happens while the instance is created and destroyed.
  features_.pNext = &messenger_info_;
  features_.enabledValidationFeatureCount = 1;
  features_.pEnabledValidationFeatures = &enabled_;
}

void ValidationLog::attach(VkInstance instance) {
  check(vkCreateDebugUtilsMessengerEXT(instance, &messenger_info_, nullptr, &messenger_),
        "vkCreateDebugUtilsMessengerEXT");
}

void ValidationLog::detach(VkInstance instance) {
  if (messenger_ != VK_NULL_HANDLE) vkDestroyDebugUtilsMessengerEXT(instance, messenger_, nullptr);
  messenger_ = VK_NULL_HANDLE;
}

VkBool32 ValidationLog::receive(VkDebugUtilsMessageSeverityFlagBitsEXT severity, VkDebugUtilsMessageTypeFlagsEXT,
                                const VkDebugUtilsMessengerCallbackDataEXT* data, void* self) {
  ++static_cast<ValidationLog*>(self)->messages_;
  const bool is_error = severity == VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  spdlog::log(is_error ? spdlog::level::err : spdlog::level::warn, "Vulkan validation: {}", data->pMessage);
  return VK_FALSE;
}

bool has_validation_layer() {
  std::uint32_t count = 0;
  check(vkEnumerateInstanceLayerProperties(&count, nullptr), "vkEnumerateInstanceLayerProperties");
  std::vector<VkLayerProperties> layers(count);
  check(vkEnumerateInstanceLayerProperties(&count, layers.data()), "vkEnumerateInstanceLayerProperties");
  for (const VkLayerProperties& layer : layers) {
    if (std::strcmp(layer.layerName, kValidationLayer) == 0) return true;
  }
  return false;
}

}  // namespace probewalk
