// A list of pixels on the device that one pass fills and another one's indirect dispatch takes from
// (shaders/shared/pixel_list.h).
#pragma once

#include <volk.h>

#include "render/buffer.h"

namespace probewalk {

// Whether the list can name the pixels of pictures this large.
bool can_be_listed(VkExtent2D extent_px);
// With so many entries at most. Throws as Buffer does.
Buffer make_pixel_list(const Device& device, VkDeviceSize entry_bytes, VkDeviceSize entries);
// Empties it, after what took from it last; what compute shaders have written before is seen by those that follow.
void empty_pixel_list(VkCommandBuffer commands, const Buffer& list);
// Runs the compute pipeline that is bound over what was listed.
void dispatch_pixel_list(VkCommandBuffer commands, const Buffer& list);

}  // namespace probewalk
