// Pipelines and what they bind. All of ours read their constants through one device address in the push constants.
#pragma once

#include <volk.h>

#include <cstdint>
#include <initializer_list>
#include <span>
#include <utility>
#include <vector>

#include "render/device.h"

namespace probewalk {

// A set of storage images in VK_IMAGE_LAYOUT_GENERAL, bindings 0, 1, ... in the order given.
class StorageImageSet {
 public:
  StorageImageSet(const Device& device, VkShaderStageFlags stages, std::initializer_list<VkImageView> images);
  ~StorageImageSet();
  StorageImageSet(const StorageImageSet&) = delete;
  StorageImageSet& operator=(const StorageImageSet&) = delete;

  // Binds another image, like the one before. The device must be done with commands that read the set.
  void show(std::uint32_t binding, VkImageView image) const;

  VkDescriptorSetLayout layout() const { return layout_; }
  VkDescriptorSet set() const { return set_; }

 private:
  VkDevice device_;
  VkDescriptorSetLayout layout_ = VK_NULL_HANDLE;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
};

// What every shader of ours is given directly.
struct PushConstants {
  VkDeviceAddress constants = 0;  // where the rest lies
  std::uint32_t view = 0;         // that a draw is for
  std::uint32_t first = 0;        // of what a dispatch makes, where it makes a part
  VkDeviceAddress list = 0;  // what a pass has beside: pixels (shaders/shared/pixel_list.h), guides (guides.h)
  VkDeviceAddress openings = 0;  // what first probes are chosen from (shaders/openings.glsl)
  VkDeviceAddress surfaces = 0;  // what the first of two eyes has seen (shaders/first_eye.glsl), and how close what the
  VkDeviceAddress depths = 0;    // second one's tiles might meet is
};

// Owns a pipeline and its layout.
class Pipeline {
 public:
  // `constants` are the specialisation constants 0, 1, ...; those that the shader has not got are passed over.
  static Pipeline compute(const Device& device, const StorageImageSet* images, std::span<const std::uint32_t> spirv,
                          const std::vector<std::uint32_t>& constants);
  // A full-screen triangle onto one attachment: of colour, without blending, or of depth, without a test.
  static Pipeline full_screen(const Device& device, const StorageImageSet& images,
                              std::span<const std::uint32_t> vertex_spirv,
                              std::span<const std::uint32_t> fragment_spirv, VkFormat format);
  // Triangles that the vertex shader fetches by itself, laid over a colour attachment by their alpha. Both shaders see
  // the push constants, the fragment shader `images`, if any.
  static Pipeline blended(const Device& device, const StorageImageSet* images,
                          std::span<const std::uint32_t> vertex_spirv, std::span<const std::uint32_t> fragment_spirv,
                          VkFormat format);
  ~Pipeline();
  Pipeline(Pipeline&& other) noexcept;
  Pipeline& operator=(Pipeline&&) = delete;

  void bind(VkCommandBuffer commands, const StorageImageSet* images, const PushConstants& push) const;

 private:
  struct Spirv {
    std::span<const std::uint32_t> vertex, fragment;
  };
  static Pipeline graphics(const Device& device, const StorageImageSet* images, VkShaderStageFlags pushed_to,
                           const Spirv& spirv, VkFormat format, bool blends);
  Pipeline(const Device& device, const StorageImageSet* images, VkPipelineBindPoint bind_point,
           VkShaderStageFlags stages);

  VkDevice device_;
  VkPipelineBindPoint bind_point_;
  VkShaderStageFlags stages_;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
};

}  // namespace probewalk
