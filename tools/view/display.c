/* SPDX-License-Identifier: MIT */
#include "display.h"

#include "display.frag.h"
#include "display.vert.h"

#include <string.h>
#include <vulkan/vulkan.h>

_Static_assert(sizeof(struct display_block) == 64, "as GLSL lays it out");

static bool create_layouts(struct display *d, struct tool_error *err)
{
    VkDescriptorSetLayoutBinding bindings[DISPLAY_BINDINGS];
    for (uint32_t i = 0; i < DISPLAY_BINDINGS; i++)
        bindings[i] = (VkDescriptorSetLayoutBinding){
            .binding = i,
            .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
            .descriptorCount = 1,
            .stageFlags = VK_SHADER_STAGE_FRAGMENT_BIT,
        };
    VkResult result = vkCreateDescriptorSetLayout(
        d->gpu->device,
        &(VkDescriptorSetLayoutCreateInfo){
            .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
            .bindingCount = DISPLAY_BINDINGS,
            .pBindings = bindings,
        },
        NULL, &d->set_layout);
    if (!gpu_ok(err, "vkCreateDescriptorSetLayout", result))
        return false;
    result = vkCreatePipelineLayout(d->gpu->device,
                                    &(VkPipelineLayoutCreateInfo){
                                        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                        .setLayoutCount = 1,
                                        .pSetLayouts = &d->set_layout,
                                        .pushConstantRangeCount = 1,
                                        .pPushConstantRanges =
                                            &(VkPushConstantRange){
                                                .stageFlags = VK_SHADER_STAGE_FRAGMENT_BIT,
                                                .size = sizeof(struct display_block),
                                            },
                                    },
                                    NULL, &d->pipeline_layout);
    return gpu_ok(err, "vkCreatePipelineLayout", result);
}

static bool create_sets(struct display *d, struct tool_error *err)
{
    VkDescriptorSetLayout layouts[FRAMES_IN_FLIGHT];
    for (uint32_t i = 0; i < FRAMES_IN_FLIGHT; i++)
        layouts[i] = d->set_layout;
    VkResult result = vkCreateDescriptorPool(
        d->gpu->device,
        &(VkDescriptorPoolCreateInfo){
            .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
            .maxSets = FRAMES_IN_FLIGHT,
            .poolSizeCount = 1,
            .pPoolSizes = &(VkDescriptorPoolSize){VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                                  FRAMES_IN_FLIGHT * DISPLAY_BINDINGS},
        },
        NULL, &d->pool);
    if (!gpu_ok(err, "vkCreateDescriptorPool", result))
        return false;
    result = vkAllocateDescriptorSets(d->gpu->device,
                                      &(VkDescriptorSetAllocateInfo){
                                          .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                          .descriptorPool = d->pool,
                                          .descriptorSetCount = FRAMES_IN_FLIGHT,
                                          .pSetLayouts = layouts,
                                      },
                                      d->sets);
    if (!gpu_ok(err, "vkAllocateDescriptorSets", result))
        return false;
    result = vkCreateSampler(d->gpu->device,
                             &(VkSamplerCreateInfo){
                                 .sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                 .magFilter = VK_FILTER_NEAREST,
                                 .minFilter = VK_FILTER_NEAREST,
                                 .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                 .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                 .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                             },
                             NULL, &d->sampler);
    return gpu_ok(err, "vkCreateSampler", result) &&
           gpu_image_create(d->gpu, VK_FORMAT_R32_SFLOAT, (VkExtent2D){1, 1},
                            VK_IMAGE_USAGE_SAMPLED_BIT, &d->nothing, err);
}

static VkShaderModule create_shader(struct display *d, const uint32_t *code, size_t bytes,
                                    struct tool_error *err)
{
    VkShaderModule module = VK_NULL_HANDLE;
    VkResult result = vkCreateShaderModule(d->gpu->device,
                                           &(VkShaderModuleCreateInfo){
                                               .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                               .codeSize = bytes,
                                               .pCode = code,
                                           },
                                           NULL, &module);
    gpu_ok(err, "vkCreateShaderModule", result);
    return result == VK_SUCCESS ? module : VK_NULL_HANDLE;
}

static VkPipelineShaderStageCreateInfo shader_stage(VkShaderStageFlagBits stage,
                                                    VkShaderModule module)
{
    return (VkPipelineShaderStageCreateInfo){
        .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
        .stage = stage,
        .module = module,
        .pName = "main",
    };
}

static VkResult create_pipeline(struct display *d, VkRenderPass pass, VkShaderModule vertex,
                                VkShaderModule fragment)
{
    const VkPipelineShaderStageCreateInfo stages[] = {
        shader_stage(VK_SHADER_STAGE_VERTEX_BIT, vertex),
        shader_stage(VK_SHADER_STAGE_FRAGMENT_BIT, fragment),
    };
    const VkDynamicState dynamic[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    const VkGraphicsPipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
        .stageCount = 2,
        .pStages = stages,
        .pVertexInputState =
            &(VkPipelineVertexInputStateCreateInfo){
                .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO},
        .pInputAssemblyState =
            &(VkPipelineInputAssemblyStateCreateInfo){
                .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
                .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST},
        .pViewportState =
            &(VkPipelineViewportStateCreateInfo){
                .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
                .viewportCount = 1,
                .scissorCount = 1},
        .pRasterizationState =
            &(VkPipelineRasterizationStateCreateInfo){
                .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
                .polygonMode = VK_POLYGON_MODE_FILL,
                .lineWidth = 1.0f},
        .pMultisampleState =
            &(VkPipelineMultisampleStateCreateInfo){
                .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
                .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT},
        .pColorBlendState =
            &(VkPipelineColorBlendStateCreateInfo){
                .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
                .attachmentCount = 1,
                .pAttachments = &(VkPipelineColorBlendAttachmentState){.colorWriteMask = 0xf}},
        .pDynamicState =
            &(VkPipelineDynamicStateCreateInfo){
                .sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
                .dynamicStateCount = 2,
                .pDynamicStates = dynamic},
        .layout = d->pipeline_layout,
        .renderPass = pass,
    };
    return vkCreateGraphicsPipelines(d->gpu->device, VK_NULL_HANDLE, 1, &info, NULL, &d->pipeline);
}

bool display_create(struct gpu *gpu, VkRenderPass pass, struct display *display,
                    struct tool_error *err)
{
    *display = (struct display){.gpu = gpu};
    display_forget(display);
    bool ok = create_layouts(display, err) && create_sets(display, err);
    VkShaderModule vertex =
        ok ? create_shader(display, display_vert, sizeof display_vert, err) : VK_NULL_HANDLE;
    VkShaderModule fragment =
        ok ? create_shader(display, display_frag, sizeof display_frag, err) : VK_NULL_HANDLE;
    ok = ok && vertex && fragment &&
         gpu_ok(err, "vkCreateGraphicsPipelines", create_pipeline(display, pass, vertex, fragment));
    vkDestroyShaderModule(gpu->device, vertex, NULL);
    vkDestroyShaderModule(gpu->device, fragment, NULL);
    if (!ok)
        display_destroy(display);
    return ok;
}

void display_destroy(struct display *display)
{
    struct display *d = display;
    if (!d->gpu)
        return;
    VkDevice device = d->gpu->device;
    vkDestroyPipeline(device, d->pipeline, NULL);
    vkDestroyPipelineLayout(device, d->pipeline_layout, NULL);
    vkDestroyDescriptorPool(device, d->pool, NULL);
    vkDestroyDescriptorSetLayout(device, d->set_layout, NULL);
    vkDestroySampler(device, d->sampler, NULL);
    gpu_image_destroy(d->gpu, &d->nothing);
    *d = (struct display){0};
}

void display_bind(struct display *display, uint32_t frame, const struct display_images *images)
{
    VkDescriptorImageInfo infos[DISPLAY_BINDINGS];
    if (memcmp(&display->bound[frame], images, sizeof *images) == 0)
        return;
    display->bound[frame] = *images;
    for (size_t i = 0; i < DISPLAY_BINDINGS; i++)
        infos[i] = (VkDescriptorImageInfo){
            .sampler = display->sampler,
            .imageView = images->bindings[i] ? images->bindings[i] : display->nothing.view,
            .imageLayout = VK_IMAGE_LAYOUT_GENERAL,
        };
    VkWriteDescriptorSet writes[DISPLAY_BINDINGS];
    for (uint32_t i = 0; i < DISPLAY_BINDINGS; i++)
        writes[i] = (VkWriteDescriptorSet){
            .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
            .dstSet = display->sets[frame],
            .dstBinding = i,
            .descriptorCount = 1,
            .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
            .pImageInfo = &infos[i],
        };
    vkUpdateDescriptorSets(display->gpu->device, DISPLAY_BINDINGS, writes, 0, NULL);
}

void display_forget(struct display *display)
{
    /* No image has this handle, so that the next display_bind writes the set. */
    memset(display->bound, 0xff, sizeof display->bound);
}

void display_draw(const struct display *display, VkCommandBuffer cmd, uint32_t frame,
                  const struct display_block *block)
{
    vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, display->pipeline);
    vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, display->pipeline_layout, 0, 1,
                            &display->sets[frame], 0, NULL);
    vkCmdPushConstants(cmd, display->pipeline_layout, VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                       sizeof *block, block);
    vkCmdDraw(cmd, 3, 1, 0, 0);
}
