#include "render/pipeline.h"

#include <array>
#include <vector>

#include "render/check.h"
#include "render/image.h"

namespace probewalk {
namespace {

class ShaderModule {
 public:
  ShaderModule(VkDevice device, std::span<const std::uint32_t> spirv) : device_(device) {
    VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    info.codeSize = spirv.size_bytes();
    info.pCode = spirv.data();
    check(vkCreateShaderModule(device, &info, nullptr, &module_), "vkCreateShaderModule");
  }
  ~ShaderModule() { vkDestroyShaderModule(device_, module_, nullptr); }
  ShaderModule(const ShaderModule&) = delete;
  ShaderModule& operator=(const ShaderModule&) = delete;

  VkPipelineShaderStageCreateInfo stage(VkShaderStageFlagBits bit) const {
    VkPipelineShaderStageCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
    info.stage = bit;
    info.module = module_;
    info.pName = "main";
    return info;
  }

 private:
  VkDevice device_;
  VkShaderModule module_ = VK_NULL_HANDLE;
};

}  // namespace

StorageImageSet::StorageImageSet(const Device& device, VkShaderStageFlags stages,
                                 std::initializer_list<VkImageView> images)
    : device_(device.handle()) {
  const auto count = static_cast<std::uint32_t>(images.size());
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  std::vector<VkDescriptorImageInfo> infos;
  for (VkImageView view : images) {
    bindings.push_back(
        {static_cast<std::uint32_t>(bindings.size()), VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, 1, stages, nullptr});
    infos.push_back({VK_NULL_HANDLE, view, VK_IMAGE_LAYOUT_GENERAL});
  }
  VkDescriptorSetLayoutCreateInfo layout_info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  layout_info.bindingCount = count;
  layout_info.pBindings = bindings.data();
  check(vkCreateDescriptorSetLayout(device_, &layout_info, nullptr, &layout_), "vkCreateDescriptorSetLayout");

  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, count};
  VkDescriptorPoolCreateInfo pool_info{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  pool_info.maxSets = 1;
  pool_info.poolSizeCount = 1;
  pool_info.pPoolSizes = &size;
  check(vkCreateDescriptorPool(device_, &pool_info, nullptr, &pool_), "vkCreateDescriptorPool");

  VkDescriptorSetAllocateInfo allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  allocate.descriptorPool = pool_;
  allocate.descriptorSetCount = 1;
  allocate.pSetLayouts = &layout_;
  check(vkAllocateDescriptorSets(device_, &allocate, &set_), "vkAllocateDescriptorSets");

  std::vector<VkWriteDescriptorSet> writes;
  for (std::uint32_t binding = 0; binding < count; ++binding) {
    VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
    write.dstSet = set_;
    write.dstBinding = binding;
    write.descriptorCount = 1;
    write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
    write.pImageInfo = &infos[binding];
    writes.push_back(write);
  }
  vkUpdateDescriptorSets(device_, count, writes.data(), 0, nullptr);
}

void StorageImageSet::show(std::uint32_t binding, VkImageView image) const {
  const VkDescriptorImageInfo info{VK_NULL_HANDLE, image, VK_IMAGE_LAYOUT_GENERAL};
  VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
  write.dstSet = set_;
  write.dstBinding = binding;
  write.descriptorCount = 1;
  write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
  write.pImageInfo = &info;
  vkUpdateDescriptorSets(device_, 1, &write, 0, nullptr);
}

StorageImageSet::~StorageImageSet() {
  vkDestroyDescriptorPool(device_, pool_, nullptr);
  vkDestroyDescriptorSetLayout(device_, layout_, nullptr);
}

Pipeline::Pipeline(const Device& device, const StorageImageSet* images, VkPipelineBindPoint bind_point,
                   VkShaderStageFlags stages)
    : device_(device.handle()), bind_point_(bind_point), stages_(stages) {
  const VkDescriptorSetLayout set_layout = images != nullptr ? images->layout() : VK_NULL_HANDLE;
  const VkPushConstantRange range{stages, 0, sizeof(PushConstants)};
  VkPipelineLayoutCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  info.setLayoutCount = images != nullptr ? 1 : 0;
  info.pSetLayouts = &set_layout;
  info.pushConstantRangeCount = 1;
  info.pPushConstantRanges = &range;
  check(vkCreatePipelineLayout(device_, &info, nullptr, &layout_), "vkCreatePipelineLayout");
}

Pipeline::~Pipeline() {
  vkDestroyPipeline(device_, pipeline_, nullptr);
  vkDestroyPipelineLayout(device_, layout_, nullptr);
}

Pipeline::Pipeline(Pipeline&& other) noexcept
    : device_(other.device_),
      bind_point_(other.bind_point_),
      stages_(other.stages_),
      layout_(std::exchange(other.layout_, VK_NULL_HANDLE)),
      pipeline_(std::exchange(other.pipeline_, VK_NULL_HANDLE)) {}

Pipeline Pipeline::compute(const Device& device, const StorageImageSet* images, std::span<const std::uint32_t> spirv,
                           const std::vector<std::uint32_t>& constants) {
  Pipeline result(device, images, VK_PIPELINE_BIND_POINT_COMPUTE, VK_SHADER_STAGE_COMPUTE_BIT);
  std::vector<VkSpecializationMapEntry> entries;
  for (std::uint32_t id = 0; id < constants.size(); ++id) {
    entries.push_back({id, static_cast<std::uint32_t>(id * sizeof(std::uint32_t)), sizeof(std::uint32_t)});
  }
  const VkSpecializationInfo specialisation{static_cast<std::uint32_t>(entries.size()), entries.data(),
                                            constants.size() * sizeof(std::uint32_t), constants.data()};
  const ShaderModule module(device.handle(), spirv);
  VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
  info.stage = module.stage(VK_SHADER_STAGE_COMPUTE_BIT);
  info.stage.pSpecializationInfo = &specialisation;
  info.layout = result.layout_;
  check(vkCreateComputePipelines(device.handle(), VK_NULL_HANDLE, 1, &info, nullptr, &result.pipeline_),
        "vkCreateComputePipelines");
  device.count_pipeline();
  return result;
}

Pipeline Pipeline::full_screen(const Device& device, const StorageImageSet& images,
                               std::span<const std::uint32_t> vertex_spirv,
                               std::span<const std::uint32_t> fragment_spirv, VkFormat format) {
  return graphics(device, &images, VK_SHADER_STAGE_FRAGMENT_BIT, {vertex_spirv, fragment_spirv}, format, false);
}

Pipeline Pipeline::blended(const Device& device, const StorageImageSet* images,
                           std::span<const std::uint32_t> vertex_spirv, std::span<const std::uint32_t> fragment_spirv,
                           VkFormat format) {
  return graphics(device, images, VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT,
                  {vertex_spirv, fragment_spirv}, format, true);
}

Pipeline Pipeline::graphics(const Device& device, const StorageImageSet* images, VkShaderStageFlags pushed_to,
                            const Spirv& spirv, VkFormat format, bool blends) {
  Pipeline result(device, images, VK_PIPELINE_BIND_POINT_GRAPHICS, pushed_to);
  const ShaderModule vertex(device.handle(), spirv.vertex);
  const ShaderModule fragment(device.handle(), spirv.fragment);
  const std::array stages{vertex.stage(VK_SHADER_STAGE_VERTEX_BIT), fragment.stage(VK_SHADER_STAGE_FRAGMENT_BIT)};

  const VkPipelineVertexInputStateCreateInfo vertex_input{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
  VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
  viewport.viewportCount = 1;
  viewport.scissorCount = 1;
  VkPipelineRasterizationStateCreateInfo raster{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
  raster.lineWidth = 1.0f;
  VkPipelineMultisampleStateCreateInfo multisample{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
  multisample.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
  VkPipelineColorBlendAttachmentState attachment{};
  attachment.colorWriteMask =
      VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
  attachment.blendEnable = blends ? VK_TRUE : VK_FALSE;
  attachment.srcColorBlendFactor = VK_BLEND_FACTOR_SRC_ALPHA;
  attachment.dstColorBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
  attachment.srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE;
  attachment.dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
  VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
  const bool is_depth = aspect_of(format) == VK_IMAGE_ASPECT_DEPTH_BIT;
  blend.attachmentCount = is_depth ? 0 : 1;
  blend.pAttachments = &attachment;
  // Depth is written only where the test is on, so it is on and passes always.
  VkPipelineDepthStencilStateCreateInfo depth{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
  depth.depthTestEnable = VK_TRUE;
  depth.depthWriteEnable = VK_TRUE;
  depth.depthCompareOp = VK_COMPARE_OP_ALWAYS;
  const std::array dynamic_states{VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  VkPipelineDynamicStateCreateInfo dynamic{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
  dynamic.dynamicStateCount = static_cast<std::uint32_t>(dynamic_states.size());
  dynamic.pDynamicStates = dynamic_states.data();
  VkPipelineRenderingCreateInfo rendering{VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO};
  rendering.colorAttachmentCount = is_depth ? 0 : 1;
  rendering.pColorAttachmentFormats = &format;
  rendering.depthAttachmentFormat = is_depth ? format : VK_FORMAT_UNDEFINED;

  VkGraphicsPipelineCreateInfo info{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO};
  info.pNext = &rendering;
  info.stageCount = static_cast<std::uint32_t>(stages.size());
  info.pStages = stages.data();
  info.pVertexInputState = &vertex_input;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &viewport;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &multisample;
  info.pDepthStencilState = is_depth ? &depth : nullptr;
  info.pColorBlendState = &blend;
  info.pDynamicState = &dynamic;
  info.layout = result.layout_;
  check(vkCreateGraphicsPipelines(device.handle(), VK_NULL_HANDLE, 1, &info, nullptr, &result.pipeline_),
        "vkCreateGraphicsPipelines");
  device.count_pipeline();
  return result;
}

void Pipeline::bind(VkCommandBuffer commands, const StorageImageSet* images, const PushConstants& push) const {
  vkCmdBindPipeline(commands, bind_point_, pipeline_);
  if (images != nullptr) {
    const VkDescriptorSet set = images->set();
    vkCmdBindDescriptorSets(commands, bind_point_, layout_, 0, 1, &set, 0, nullptr);
  }
  vkCmdPushConstants(commands, layout_, stages_, 0, sizeof(push), &push);
}

}  // namespace probewalk
