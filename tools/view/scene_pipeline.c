/* SPDX-License-Identifier: MIT
 *
 * How the triangles become texels. */
#include "scene_internal.h"

#include "scene.frag.h"
#include "scene.vert.h"

#include <vulkan/vulkan.h>

static VkShaderModule create_module(struct gpu *gpu, const uint32_t *code, size_t bytes,
                                    struct tool_error *err)
{
    VkShaderModule module = VK_NULL_HANDLE;
    VkResult result = vkCreateShaderModule(gpu->device,
                                           &(VkShaderModuleCreateInfo){
                                               .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                               .codeSize = bytes,
                                               .pCode = code,
                                           },
                                           NULL, &module);
    if (result == VK_SUCCESS)
        return module;
    gpu_ok(err, "vkCreateShaderModule", result);
    return VK_NULL_HANDLE;
}

static bool create_layout(struct live_scene *scene, struct tool_error *err)
{
    VkResult result =
        vkCreatePipelineLayout(scene->gpu->device,
                               &(VkPipelineLayoutCreateInfo){
                                   .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                   .pushConstantRangeCount = 1,
                                   .pPushConstantRanges =
                                       &(VkPushConstantRange){
                                           .stageFlags = VK_SHADER_STAGE_VERTEX_BIT,
                                           .size = sizeof(struct live_push),
                                       },
                               },
                               NULL, &scene->layout);
    if (result == VK_SUCCESS)
        return true;
    scene->layout = VK_NULL_HANDLE;
    return gpu_ok(err, "vkCreatePipelineLayout", result);
}

static const VkVertexInputAttributeDescription attributes[] = {
    {0, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(struct mesh_vertex, position)},
    {1, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(struct mesh_vertex, normal)},
    {2, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(struct mesh_vertex, albedo)},
};
static const VkPipelineVertexInputStateCreateInfo vertex_input = {
    .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
    .vertexBindingDescriptionCount = 1,
    .pVertexBindingDescriptions =
        &(VkVertexInputBindingDescription){
            .stride = sizeof(struct mesh_vertex),
            .inputRate = VK_VERTEX_INPUT_RATE_VERTEX,
        },
    .vertexAttributeDescriptionCount = sizeof attributes / sizeof attributes[0],
    .pVertexAttributeDescriptions = attributes,
};
static const VkPipelineInputAssemblyStateCreateInfo input_assembly = {
    .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
    .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST,
};
static const VkPipelineViewportStateCreateInfo viewport = {
    .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
    .viewportCount = 1,
    .scissorCount = 1,
};
static const VkPipelineRasterizationStateCreateInfo rasterization = {
    .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
    .polygonMode = VK_POLYGON_MODE_FILL,
    .cullMode = VK_CULL_MODE_BACK_BIT,
    .frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE,
    .lineWidth = 1.0f,
};
static const VkPipelineMultisampleStateCreateInfo multisample = {
    .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
    .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT,
};
static const VkPipelineDepthStencilStateCreateInfo depth_stencil = {
    .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
    .depthTestEnable = VK_TRUE,
    .depthWriteEnable = VK_TRUE,
    .depthCompareOp = VK_COMPARE_OP_GREATER, /* reversed */
};
static const VkPipelineDynamicStateCreateInfo dynamic = {
    .sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
    .dynamicStateCount = 2,
    .pDynamicStates = (const VkDynamicState[]){VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR},
};

static bool create_pipeline(struct live_scene *scene, VkShaderModule vertex,
                            VkShaderModule fragment, struct tool_error *err)
{
    VkPipelineColorBlendAttachmentState opaque[ATTACHMENT_COLORS];
    for (int i = 0; i < ATTACHMENT_COLORS; ++i)
        opaque[i] = (VkPipelineColorBlendAttachmentState){
            .colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT |
                              VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT,
        };
    const VkPipelineShaderStageCreateInfo stages[2] = {
        {
            .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
            .stage = VK_SHADER_STAGE_VERTEX_BIT,
            .module = vertex,
            .pName = "main",
        },
        {
            .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
            .stage = VK_SHADER_STAGE_FRAGMENT_BIT,
            .module = fragment,
            .pName = "main",
        },
    };
    const VkGraphicsPipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
        .stageCount = 2,
        .pStages = stages,
        .pVertexInputState = &vertex_input,
        .pInputAssemblyState = &input_assembly,
        .pViewportState = &viewport,
        .pRasterizationState = &rasterization,
        .pMultisampleState = &multisample,
        .pDepthStencilState = &depth_stencil,
        .pColorBlendState =
            &(VkPipelineColorBlendStateCreateInfo){
                .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
                .attachmentCount = ATTACHMENT_COLORS,
                .pAttachments = opaque,
            },
        .pDynamicState = &dynamic,
        .layout = scene->layout,
        .renderPass = scene->pass,
    };
    VkResult result = vkCreateGraphicsPipelines(scene->gpu->device, VK_NULL_HANDLE, 1, &info, NULL,
                                                &scene->pipeline);
    if (result == VK_SUCCESS)
        return true;
    scene->pipeline = VK_NULL_HANDLE;
    return gpu_ok(err, "vkCreateGraphicsPipelines", result);
}

bool live_pipeline_create(struct live_scene *scene, struct tool_error *err)
{
    VkDevice device = scene->gpu->device;
    VkShaderModule vertex = create_module(scene->gpu, scene_vert, sizeof scene_vert, err);
    VkShaderModule fragment = create_module(scene->gpu, scene_frag, sizeof scene_frag, err);
    bool ok = vertex && fragment && create_layout(scene, err) &&
              create_pipeline(scene, vertex, fragment, err);
    vkDestroyShaderModule(device, vertex, NULL);
    vkDestroyShaderModule(device, fragment, NULL);
    return ok;
}
