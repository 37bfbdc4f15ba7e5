// A device with the validation layer, which must stay silent through every test.
#pragma once

#include <gtest/gtest.h>

#include "render/device.h"
#include "render/frame_renderer.h"
#include "render/image.h"

namespace probewalk::test {

class GpuTest : public testing::Test {
 protected:
  void TearDown() override {
    device.wait_idle();
    EXPECT_EQ(device.validation_messages(), 0u);
  }
  const Device device{DeviceHooks{}, DeviceOptions{.device = "", .validation = true}};
};

// Both eyes' layers of an image, to be read back from.
inline FrameTarget frame_target(const Image& image, VkFormat format, VkExtent2D extent_px) {
  FrameTarget target;
  target.image = image.handle();
  target.format = format;
  target.extent = extent_px;
  target.layers = 2;
  target.final_layout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
  return target;
}

}  // namespace probewalk::test
