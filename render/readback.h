// Images from the device to the CPU: blocking, for stills, screenshots and tests.
#pragma once

#include <volk.h>

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "content/image/image.h"
#include "render/device.h"
#include "render/image.h"

namespace probewalk {

// Texels of all layers, layer by layer, rows from the top, tightly packed. The image must have been created with
// VK_IMAGE_USAGE_TRANSFER_SRC_BIT, is in `layout` and is left in it; all work on it has been submitted.
std::vector<std::byte> read_image(const Device& device, VkImage image, VkImageLayout layout, VkFormat format,
                                  VkExtent2D extent, std::uint32_t layers);

// One picture a layer. Format: 8-bit RGBA or BGRA, whose bytes are taken as they are.
std::vector<ImageRgb8> read_pictures(const Device& device, VkImage image, VkImageLayout layout, VkFormat format,
                                     VkExtent2D extent, std::uint32_t layers);

// One picture a layer of an RGBA16F image in VK_IMAGE_LAYOUT_GENERAL; alpha is dropped.
std::vector<ImageRgbF> read_radiance(const Device& device, const Image& image);

// One map a layer of an R32F image in VK_IMAGE_LAYOUT_GENERAL.
std::vector<std::vector<float>> read_floats(const Device& device, const Image& image);

// One map a layer of an RGBA32UI image in VK_IMAGE_LAYOUT_GENERAL.
std::vector<std::vector<glm::uvec4>> read_uints(const Device& device, const Image& image);

}  // namespace probewalk
