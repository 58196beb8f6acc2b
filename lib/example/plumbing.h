/* SPDX-License-Identifier: MIT
 *
 * What every engine has and vkao knows nothing of: memory, images, a pipeline, command buffers. */
#ifndef PLUMBING_H_
#define PLUMBING_H_

#include <stdio.h>
#include <stdlib.h>
#include <vulkan/vulkan.h>

#include "box_frag.h"
#include "box_vert.h"

enum { WIDTH = 320, HEIGHT = 180, IN_FLIGHT = 2 };
/* A VkResult or a vkao_result: success is 0 in both. */
#define CHECK(call) check(call, #call)

static VkPhysicalDevice physical_device;
static VkDevice device;

static void check(int result, const char *call)
{
    if (result) {
        fprintf(stderr, "%s: %d\n", call, result);
        exit(EXIT_FAILURE);
    }
}

static VkDeviceMemory allocate(VkMemoryRequirements need, VkMemoryPropertyFlags flags)
{
    VkPhysicalDeviceMemoryProperties memory;
    vkGetPhysicalDeviceMemoryProperties(physical_device, &memory);
    uint32_t type = 0;
    while (!(need.memoryTypeBits >> type & 1u) ||
           (memory.memoryTypes[type].propertyFlags & flags) != flags)
        ++type;
    VkDeviceMemory out;
    CHECK(vkAllocateMemory(device,
                           &(VkMemoryAllocateInfo){VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                                   .allocationSize = need.size,
                                                   .memoryTypeIndex = type},
                           NULL, &out));
    return out;
}

struct image {
    VkImage image;
    VkImageView view;
    VkDeviceMemory memory;
};

static struct image create_image(VkFormat format, VkImageUsageFlags usage,
                                 VkImageAspectFlags aspect)
{
    struct image out;
    VkMemoryRequirements need;
    CHECK(vkCreateImage(
        device,
        &(VkImageCreateInfo){VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO, .imageType = VK_IMAGE_TYPE_2D,
                             .format = format, .extent = {WIDTH, HEIGHT, 1}, .mipLevels = 1,
                             .arrayLayers = 1, .usage = usage, .samples = VK_SAMPLE_COUNT_1_BIT},
        NULL, &out.image));
    vkGetImageMemoryRequirements(device, out.image, &need);
    out.memory = allocate(need, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
    CHECK(vkBindImageMemory(device, out.image, out.memory, 0));
    CHECK(vkCreateImageView(device,
                            &(VkImageViewCreateInfo){VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                                     .image = out.image, .format = format,
                                                     .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                                     .subresourceRange = {aspect, 0, 1, 0, 1}},
                            NULL, &out.view));
    return out;
}

static void destroy_image(struct image image)
{
    vkDestroyImageView(device, image.view, NULL);
    vkDestroyImage(device, image.image, NULL);
    vkFreeMemory(device, image.memory, NULL);
}

static VkShaderModule create_shader(const uint32_t *code, size_t bytes)
{
    VkShaderModule out;
    CHECK(
        vkCreateShaderModule(device,
                             &(VkShaderModuleCreateInfo){
                                 VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, NULL, 0, bytes, code},
                             NULL, &out));
    return out;
}

static VkPipeline create_pipeline(VkRenderPass pass, VkPipelineLayout layout)
{
    const VkPipelineShaderStageCreateInfo stages[] = {
        {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO, .pName = "main",
         .stage = VK_SHADER_STAGE_VERTEX_BIT, .module = create_shader(box_vert, sizeof box_vert)},
        {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO, .pName = "main",
         .stage = VK_SHADER_STAGE_FRAGMENT_BIT, .module = create_shader(box_frag, sizeof box_frag)},
    };
    const VkPipelineVertexInputStateCreateInfo vertices = {
        VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    const VkPipelineInputAssemblyStateCreateInfo assembly = {
        VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
    const VkPipelineViewportStateCreateInfo viewport = {
        VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO, .viewportCount = 1,
        .pViewports = &(VkViewport){0, 0, WIDTH, HEIGHT, 0, 1}, .scissorCount = 1,
        .pScissors = &(VkRect2D){{0, 0}, {WIDTH, HEIGHT}}};
    const VkPipelineRasterizationStateCreateInfo raster = {
        VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO, .lineWidth = 1};
    const VkPipelineMultisampleStateCreateInfo samples = {
        VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
    const VkPipelineDepthStencilStateCreateInfo depth = {
        VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO, .depthTestEnable = VK_TRUE,
        .depthWriteEnable = VK_TRUE, .depthCompareOp = VK_COMPARE_OP_GREATER};
    const VkPipelineColorBlendStateCreateInfo blend = {
        VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO, .attachmentCount = 1,
        .pAttachments = &(VkPipelineColorBlendAttachmentState){.colorWriteMask = 0xf}};
    VkPipeline out;
    CHECK(vkCreateGraphicsPipelines(
        device, VK_NULL_HANDLE, 1,
        &(VkGraphicsPipelineCreateInfo){
            VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO, .stageCount = 2, .pStages = stages,
            .pVertexInputState = &vertices, .pInputAssemblyState = &assembly,
            .pViewportState = &viewport, .pRasterizationState = &raster,
            .pMultisampleState = &samples, .pDepthStencilState = &depth, .pColorBlendState = &blend,
            .layout = layout, .renderPass = pass},
        NULL, &out));
    for (int i = 0; i < 2; ++i)
        vkDestroyShaderModule(device, stages[i].module, NULL);
    return out;
}

/* Memory that the device copies to and the host reads. */
struct buffer {
    VkBuffer buffer;
    VkDeviceMemory memory;
    void *mapped;
};

static struct buffer create_buffer(VkDeviceSize bytes)
{
    struct buffer out;
    VkMemoryRequirements need;
    CHECK(vkCreateBuffer(device,
                         &(VkBufferCreateInfo){VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = bytes,
                                               .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT},
                         NULL, &out.buffer));
    vkGetBufferMemoryRequirements(device, out.buffer, &need);
    out.memory =
        allocate(need, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    CHECK(vkBindBufferMemory(device, out.buffer, out.memory, 0));
    CHECK(vkMapMemory(device, out.memory, 0, VK_WHOLE_SIZE, 0, &out.mapped));
    return out;
}

static void destroy_buffer(struct buffer buffer)
{
    vkDestroyBuffer(device, buffer.buffer, NULL);
    vkFreeMemory(device, buffer.memory, NULL);
}

/* A queue, and a command buffer and its fence for each frame in flight. */
struct commands {
    VkQueue queue;
    VkCommandPool pool;
    VkCommandBuffer cmds[IN_FLIGHT];
    VkFence fences[IN_FLIGHT];
};

static struct commands create_commands(void)
{
    struct commands out;
    vkGetDeviceQueue(device, 0, 0, &out.queue);
    CHECK(vkCreateCommandPool(
        device,
        &(VkCommandPoolCreateInfo){VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                   .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT},
        NULL, &out.pool));
    CHECK(vkAllocateCommandBuffers(
        device,
        &(VkCommandBufferAllocateInfo){VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, NULL,
                                       out.pool, VK_COMMAND_BUFFER_LEVEL_PRIMARY, IN_FLIGHT},
        out.cmds));
    for (int i = 0; i < IN_FLIGHT; ++i)
        CHECK(vkCreateFence(device,
                            &(VkFenceCreateInfo){VK_STRUCTURE_TYPE_FENCE_CREATE_INFO,
                                                 .flags = VK_FENCE_CREATE_SIGNALED_BIT},
                            NULL, &out.fences[i]));
    return out;
}

/* Waits until the command buffer is not in use. */
static VkCommandBuffer begin(const struct commands *c, int i)
{
    CHECK(vkWaitForFences(device, 1, &c->fences[i], VK_TRUE, UINT64_MAX));
    CHECK(vkResetFences(device, 1, &c->fences[i]));
    CHECK(vkBeginCommandBuffer(
        c->cmds[i], &(VkCommandBufferBeginInfo){VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO}));
    return c->cmds[i];
}

static void submit(const struct commands *c, int i)
{
    CHECK(vkEndCommandBuffer(c->cmds[i]));
    CHECK(vkQueueSubmit(c->queue, 1,
                        &(VkSubmitInfo){VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1,
                                        .pCommandBuffers = &c->cmds[i]},
                        c->fences[i]));
}

static void destroy_commands(struct commands c)
{
    for (int i = 0; i < IN_FLIGHT; ++i)
        vkDestroyFence(device, c.fences[i], NULL);
    vkDestroyCommandPool(device, c.pool, NULL);
}

#endif
