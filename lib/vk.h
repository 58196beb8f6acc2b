/* SPDX-License-Identifier: MIT
 *
 * All Vulkan plumbing: the function table through which every call goes, result mapping, formats,
 * memory types. */
#ifndef VKAO_VK_H_
#define VKAO_VK_H_

#include "vkao.h"

#include <stdbool.h>

#define VKAO_INSTANCE_FUNCTIONS(X)                                                                 \
    X(GetPhysicalDeviceProperties)                                                                 \
    X(GetPhysicalDeviceMemoryProperties)                                                           \
    X(GetPhysicalDeviceFormatProperties)

#define VKAO_DEVICE_FUNCTIONS(X)                                                                   \
    X(CreateShaderModule)                                                                          \
    X(DestroyShaderModule)                                                                         \
    X(CreateDescriptorSetLayout)                                                                   \
    X(DestroyDescriptorSetLayout)                                                                  \
    X(CreateSampler)                                                                               \
    X(DestroySampler)                                                                              \
    X(CreatePipelineLayout)                                                                        \
    X(DestroyPipelineLayout)                                                                       \
    X(CreateComputePipelines)                                                                      \
    X(DestroyPipeline)                                                                             \
    X(CreateDescriptorPool)                                                                        \
    X(DestroyDescriptorPool)                                                                       \
    X(AllocateDescriptorSets)                                                                      \
    X(UpdateDescriptorSets)                                                                        \
    X(CreateImage)                                                                                 \
    X(DestroyImage)                                                                                \
    X(GetImageMemoryRequirements)                                                                  \
    X(AllocateMemory)                                                                              \
    X(FreeMemory)                                                                                  \
    X(BindImageMemory)                                                                             \
    X(CreateImageView)                                                                             \
    X(DestroyImageView)                                                                            \
    X(CreateBuffer)                                                                                \
    X(DestroyBuffer)                                                                               \
    X(GetBufferMemoryRequirements)                                                                 \
    X(BindBufferMemory)                                                                            \
    X(CreateBufferView)                                                                            \
    X(DestroyBufferView)                                                                           \
    X(CmdPipelineBarrier)                                                                          \
    X(CmdBindPipeline)                                                                             \
    X(CmdBindDescriptorSets)                                                                       \
    X(CmdPushConstants)                                                                            \
    X(CmdUpdateBuffer)                                                                             \
    X(CmdDispatchIndirect)                                                                         \
    X(CmdDispatch)                                                                                 \
    X(CmdCopyBufferToImage)

/* Present only where VK_EXT_debug_utils is enabled; NULL otherwise. */
#define VKAO_DEBUG_FUNCTIONS(X)                                                                    \
    X(SetDebugUtilsObjectNameEXT)                                                                  \
    X(CmdBeginDebugUtilsLabelEXT)                                                                  \
    X(CmdEndDebugUtilsLabelEXT)

struct vk_table {
#define VKAO_DECLARE(name) PFN_vk##name name;
    VKAO_INSTANCE_FUNCTIONS(VKAO_DECLARE)
    VKAO_DEVICE_FUNCTIONS(VKAO_DECLARE)
    VKAO_DEBUG_FUNCTIONS(VKAO_DECLARE)
#undef VKAO_DECLARE
};

/* False if a required function is missing; *missing then names it. */
bool vkao_vk_table_load(struct vk_table *vk, const vkao_context_info *info, const char **missing);

vkao_result vkao_from_vk(VkResult result);

/* Index of a memory type among type_bits with DEVICE_LOCAL, or UINT32_MAX. */
uint32_t vkao_memory_type(const VkPhysicalDeviceMemoryProperties *memory, uint32_t type_bits);

#endif
