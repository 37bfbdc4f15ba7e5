#include "render/device.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "content/error.h"
#include "render/buffer.h"
#include "render/check.h"
#include "render/validation.h"

namespace probewalk {
namespace {

using testing::HasSubstr;

std::string error_of(const DeviceHooks& hooks, const DeviceOptions& options) {
  try {
    const Device device(hooks, options);
  } catch (const NoDevice& error) {
    return error.what();
  }
  return "";
}

TEST(DeviceList, NamesASuitableDevice) {
  const auto devices = Device::list();
  ASSERT_FALSE(devices.empty());
  EXPECT_TRUE(devices.front().suitable) << devices.front().missing;
  EXPECT_FALSE(devices.front().name.empty());
}

TEST(DeviceList, PutsSoftwareDevicesLast) {
  const auto devices = Device::list();
  for (std::size_t i = 1; i < devices.size(); ++i) EXPECT_LE(devices[i - 1].is_software, devices[i].is_software);
}

TEST(DeviceChoice, TakesAnIndexOrAPartOfTheName) {
  const std::string name = Device::list().front().name;
  EXPECT_EQ(Device({}, {.device = "0"}).info().name, name);
  EXPECT_EQ(Device({}, {.device = name.substr(1, 4)}).info().name, name);
}

TEST(DeviceChoice, RefusesWhatIsNotThereAndSaysWhatIs) {
  const std::string name = Device::list().front().name;
  EXPECT_THAT(error_of({}, {.device = "no such device"}), testing::AllOf(HasSubstr("no such device"), HasSubstr(name)));
  EXPECT_THAT(error_of({}, {.device = "99"}), HasSubstr(name));
}

TEST(DeviceChoice, SaysWhatEachDeviceLacks) {
  DeviceHooks hooks;
  hooks.device_extensions = {"VK_PROBEWALK_unheard_of"};
  EXPECT_THAT(error_of(hooks, {}), HasSubstr("VK_PROBEWALK_unheard_of"));
  hooks = {};
  hooks.can_present = [](VkInstance, VkPhysicalDevice, std::uint32_t) { return false; };
  EXPECT_THAT(error_of(hooks, {}), HasSubstr("presentation"));
}

TEST(DeviceHooks, CreateInstanceAndDevice) {
  int instances = 0, choices = 0, devices = 0;
  DeviceHooks hooks;
  hooks.create_instance = [&](PFN_vkGetInstanceProcAddr get, const VkInstanceCreateInfo& info, VkInstance* instance) {
    ++instances;
    return reinterpret_cast<PFN_vkCreateInstance>(get(VK_NULL_HANDLE, "vkCreateInstance"))(&info, nullptr, instance);
  };
  hooks.choose_physical_device = [&](VkInstance instance) {
    ++choices;
    std::uint32_t count = 1;
    VkPhysicalDevice device = VK_NULL_HANDLE;
    vkEnumeratePhysicalDevices(instance, &count, &device);
    return device;
  };
  hooks.create_device = [&](PFN_vkGetInstanceProcAddr, VkPhysicalDevice physical, const VkDeviceCreateInfo& info,
                            VkDevice* device) {
    ++devices;
    return vkCreateDevice(physical, &info, nullptr, device);
  };
  const Device device(hooks, {});
  EXPECT_EQ(instances, 1);
  EXPECT_EQ(choices, 1);
  EXPECT_EQ(devices, 1);
  EXPECT_NE(device.queue(), VK_NULL_HANDLE);
}

TEST(DeviceMemory, IsCountedAndGivenBack) {
  const Device device({}, {});
  const std::uint64_t before = device.allocated_bytes();
  {
    const Buffer buffer(device, 64u << 20, BufferMemory::kDevice);
    EXPECT_GE(device.allocated_bytes(), before + (64u << 20));
  }
  EXPECT_LE(device.allocated_bytes(), before + (32u << 20));
}

TEST(Validation, HearsAMistake) {
  const Device device({}, {.validation = true});
  EXPECT_EQ(device.validation_messages(), 0u);
  VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;  // of no bytes
  VkBuffer buffer = VK_NULL_HANDLE;
  vkCreateBuffer(device.handle(), &info, nullptr, &buffer);
  EXPECT_GT(device.validation_messages(), 0u);
  if (buffer != VK_NULL_HANDLE) vkDestroyBuffer(device.handle(), buffer, nullptr);
}

TEST(Check, ReturnsSuccessCodesAndThrowsErrors) {
  EXPECT_EQ(check(VK_NOT_READY, "vkSomething"), VK_NOT_READY);
  EXPECT_EQ(check(VK_SUBOPTIMAL_KHR, "vkSomething"), VK_SUBOPTIMAL_KHR);
  try {
    check(VK_ERROR_DEVICE_LOST, "vkSomething");
    FAIL();
  } catch (const VulkanError& error) {
    EXPECT_EQ(error.result, VK_ERROR_DEVICE_LOST);
    EXPECT_THAT(error.what(), testing::AllOf(HasSubstr("vkSomething"), HasSubstr("VK_ERROR_DEVICE_LOST"),
                                             HasSubstr("device_test.cpp:")));
  }
}

}  // namespace
}  // namespace probewalk
