// Commands that run at once while the caller waits: set-up, batches, read-back.
#pragma once

#include <volk.h>

#include <functional>

#include "render/device.h"

namespace probewalk {

// Records, submits and waits for the commands to finish.
void run_commands(const Device& device, const std::function<void(VkCommandBuffer)>& record);

// What the commands so far have written can be read through mapped memory once they have finished.
void make_visible_to_cpu(VkCommandBuffer commands);

}  // namespace probewalk
