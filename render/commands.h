// Where commands are recorded, and what counts the submits that have finished.
#pragma once

#include <volk.h>

#include <cstdint>
#include <span>

#include "render/device.h"

namespace probewalk {

// For commands of one submit, recorded anew each time; reset as a whole unless `flags` say otherwise.
VkCommandPool make_command_pool(const Device& device, std::uint32_t family, VkCommandPoolCreateFlags flags = 0);
// Fills `commands` with primary ones, which go with the pool.
void allocate_commands(const Device& device, VkCommandPool pool, std::span<VkCommandBuffer> commands);
void begin_commands(VkCommandBuffer commands);
// What was `written` in stages `before` is seen by what is `used` in stages `after`.
void memory_barrier(VkCommandBuffer commands, VkPipelineStageFlags2 before, VkAccessFlags2 written,
                    VkPipelineStageFlags2 after, VkAccessFlags2 used);
// Begins to draw into a colour attachment in VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, with all of `extent` for viewport
// and scissor. Cleared is to nothing, alpha included. vkCmdEndRendering ends it.
void begin_drawing(VkCommandBuffer commands, VkImageView attachment, VkExtent2D extent, VkAttachmentLoadOp load);

VkSemaphore make_timeline(const Device& device);
VkSemaphoreSubmitInfo semaphore_info(VkSemaphore semaphore, std::uint64_t value, VkPipelineStageFlags2 stages);
// The result of waiting until the timeline has come to `value`.
VkResult wait_for_timeline(const Device& device, VkSemaphore timeline, std::uint64_t value);

}  // namespace probewalk
