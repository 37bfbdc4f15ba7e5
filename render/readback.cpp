#include "render/readback.h"

#include <fmt/format.h>

#include <cstring>
#include <glm/gtc/packing.hpp>

#include "render/buffer.h"
#include "render/check.h"
#include "render/one_shot.h"

namespace probewalk {
namespace {

std::uint32_t texel_bytes(VkFormat format) {
  switch (format) {
    case VK_FORMAT_R8G8B8A8_SRGB:
    case VK_FORMAT_B8G8R8A8_SRGB:
    case VK_FORMAT_R8G8B8A8_UNORM:
    case VK_FORMAT_B8G8R8A8_UNORM:
    case VK_FORMAT_D32_SFLOAT:
    case VK_FORMAT_R32_SFLOAT: return 4;
    case VK_FORMAT_D16_UNORM: return 2;
    case VK_FORMAT_R16G16B16A16_SFLOAT: return 8;
    case VK_FORMAT_R32G32B32A32_UINT: return 16;
    default: throw std::logic_error(fmt::format("no read-back of VkFormat {}", static_cast<int>(format)));
  }
}

std::vector<std::byte> read_general(const Device& device, const Image& image) {
  const ImageOptions& options = image.options();
  return read_image(device, image.handle(), VK_IMAGE_LAYOUT_GENERAL, options.format, options.extent_px, options.layers);
}

std::size_t texels_per_layer(const Image& image) {
  return std::size_t{image.options().extent_px.width} * image.options().extent_px.height;
}

// Splits tightly packed layers into one vector of T each.
template <typename T>
std::vector<std::vector<T>> split_layers(const std::vector<std::byte>& bytes, std::size_t per_layer,
                                         std::uint32_t layers) {
  std::vector<std::vector<T>> result(layers, std::vector<T>(per_layer));
  for (std::uint32_t layer = 0; layer < layers; ++layer) {
    std::memcpy(result[layer].data(), bytes.data() + layer * per_layer * sizeof(T), per_layer * sizeof(T));
  }
  return result;
}

}  // namespace

std::vector<std::byte> read_image(const Device& device, VkImage image, VkImageLayout layout, VkFormat format,
                                  VkExtent2D extent, std::uint32_t layers) {
  const std::size_t size_bytes = std::size_t{extent.width} * extent.height * layers * texel_bytes(format);
  const Buffer buffer(device, size_bytes, BufferMemory::kReadback);
  run_commands(device, [&](VkCommandBuffer commands) {
    const bool is_copyable = layout == VK_IMAGE_LAYOUT_GENERAL || layout == VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    const VkImageLayout copy_layout = is_copyable ? layout : VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    const VkImageAspectFlags aspect = aspect_of(format);
    transition(commands, image, layout, copy_layout, aspect);
    VkBufferImageCopy region{};
    region.imageSubresource = {aspect, 0, 0, layers};
    region.imageExtent = {extent.width, extent.height, 1};
    vkCmdCopyImageToBuffer(commands, image, copy_layout, buffer.handle(), 1, &region);
    transition(commands, image, copy_layout, layout, aspect);
    make_visible_to_cpu(commands);
  });
  buffer.invalidate();
  return {buffer.mapped(), buffer.mapped() + size_bytes};
}

std::vector<ImageRgb8> read_pictures(const Device& device, VkImage image, VkImageLayout layout, VkFormat format,
                                     VkExtent2D extent, std::uint32_t layers) {
  const auto bytes = read_image(device, image, layout, format, extent, layers);
  const bool is_bgra = format == VK_FORMAT_B8G8R8A8_SRGB || format == VK_FORMAT_B8G8R8A8_UNORM;
  const std::size_t per_layer = std::size_t{extent.width} * extent.height;
  std::vector<ImageRgb8> pictures(layers);
  const std::byte* texel = bytes.data();
  for (ImageRgb8& picture : pictures) {
    picture.width_px = static_cast<int>(extent.width);
    picture.height_px = static_cast<int>(extent.height);
    picture.rgb.resize(3 * per_layer);
    for (std::size_t i = 0; i < per_layer; ++i, texel += 4) {
      picture.rgb[3 * i] = static_cast<std::uint8_t>(texel[is_bgra ? 2 : 0]);
      picture.rgb[3 * i + 1] = static_cast<std::uint8_t>(texel[1]);
      picture.rgb[3 * i + 2] = static_cast<std::uint8_t>(texel[is_bgra ? 0 : 2]);
    }
  }
  return pictures;
}

std::vector<ImageRgbF> read_radiance(const Device& device, const Image& image) {
  using Texel = glm::u16vec4;
  const auto layers =
      split_layers<Texel>(read_general(device, image), texels_per_layer(image), image.options().layers);
  std::vector<ImageRgbF> pictures;
  for (const auto& layer : layers) {
    ImageRgbF picture;
    picture.width_px = static_cast<int>(image.options().extent_px.width);
    picture.height_px = static_cast<int>(image.options().extent_px.height);
    picture.rgb.reserve(layer.size());
    for (const Texel& texel : layer) {
      picture.rgb.emplace_back(glm::unpackHalf1x16(texel.x), glm::unpackHalf1x16(texel.y), glm::unpackHalf1x16(texel.z));
    }
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

std::vector<std::vector<float>> read_floats(const Device& device, const Image& image) {
  return split_layers<float>(read_general(device, image), texels_per_layer(image), image.options().layers);
}

std::vector<std::vector<glm::uvec4>> read_uints(const Device& device, const Image& image) {
  return split_layers<glm::uvec4>(read_general(device, image), texels_per_layer(image), image.options().layers);
}

}  // namespace probewalk
