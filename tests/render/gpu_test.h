// A device with the validation layer, which must stay silent through every test.
#pragma once

#include <gtest/gtest.h>

#include "render/device.h"

namespace probewalk::test {

class GpuTest : public testing::Test {
 protected:
  void TearDown() override {
    device.wait_idle();
    EXPECT_EQ(device.validation_messages(), 0u);
  }
  const Device device{DeviceHooks{}, DeviceOptions{.device = "", .validation = true}};
};

}  // namespace probewalk::test
