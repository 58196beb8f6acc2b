/* SPDX-License-Identifier: MIT */
#include "cost_device.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vulkan.h>

/* The functions that the library asks for carry no pointer of ours. */
static struct {
    VkDevice device; /* that compiles; the one of struct gpu cannot say what it compiled */
    struct cost_record record;
    size_t bound;
    uintptr_t handles; /* so far */
} null_device;

/* --- Pipelines: real ones, asked what they became --- */

static void read_statistics(const VkPipelineExecutableInfoKHR *which, struct cost_pipeline *p)
{
    const struct {
        const char *name;
        unsigned *to;
    } wanted[] = {
        {"Instructions", &p->instructions},
        {"VGPRs", &p->registers},
        {"LDS size", &p->shared_bytes},
        {"Subgroups per SIMD", &p->waves},
    };
    VkPipelineExecutableStatisticKHR all[64];
    uint32_t count = sizeof all / sizeof all[0];
    PFN_vkGetPipelineExecutableStatisticsKHR get =
        (PFN_vkGetPipelineExecutableStatisticsKHR)vkGetDeviceProcAddr(
            null_device.device, "vkGetPipelineExecutableStatisticsKHR");
    for (uint32_t i = 0; i < count; i++)
        all[i] = (VkPipelineExecutableStatisticKHR){
            .sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_STATISTIC_KHR};
    get(null_device.device, which, &count, all);
    for (uint32_t i = 0; i < count; i++)
        for (size_t w = 0; w < sizeof wanted / sizeof wanted[0]; w++)
            if (strcmp(all[i].name, wanted[w].name) == 0)
                *wanted[w].to = (unsigned)all[i].value.u64;
}

enum { FORMS = 8 }; /* of a shader on its way: NIR, ACO's own, assembly */

static void take_form(const VkPipelineExecutableInternalRepresentationKHR *form,
                      struct cost_pipeline *p)
{
    const char *text = form->pData;
    const char *size = strstr(text, "workgroup-size: ");
    unsigned x, y, z;
    if (size && sscanf(size, "workgroup-size: %u, %u, %u", &x, &y, &z) == 3)
        p->group_size = x * y * z;
    if (strcmp(form->name, "Assembly") == 0) {
        p->assembly = malloc(form->dataSize);
        if (p->assembly)
            memcpy(p->assembly, text, form->dataSize);
    }
}

static void read_forms(const VkPipelineExecutableInfoKHR *which, struct cost_pipeline *p)
{
    VkPipelineExecutableInternalRepresentationKHR forms[FORMS];
    uint32_t count = FORMS;
    PFN_vkGetPipelineExecutableInternalRepresentationsKHR get =
        (PFN_vkGetPipelineExecutableInternalRepresentationsKHR)vkGetDeviceProcAddr(
            null_device.device, "vkGetPipelineExecutableInternalRepresentationsKHR");
    for (uint32_t i = 0; i < count; i++)
        forms[i] = (VkPipelineExecutableInternalRepresentationKHR){
            .sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_INTERNAL_REPRESENTATION_KHR};
    get(null_device.device, which, &count, forms);
    for (uint32_t i = 0; i < count; i++)
        forms[i].pData = calloc(1, forms[i].dataSize + 1);
    get(null_device.device, which, &count, forms);
    for (uint32_t i = 0; i < count; i++) {
        if (forms[i].pData)
            take_form(&forms[i], p);
        free(forms[i].pData);
    }
}

static VKAPI_ATTR VkResult VKAPI_CALL create_pipelines(VkDevice device, VkPipelineCache cache,
                                                       uint32_t count,
                                                       const VkComputePipelineCreateInfo *infos,
                                                       const VkAllocationCallbacks *allocator,
                                                       VkPipeline *out)
{
    struct cost_record *record = &null_device.record;
    VkResult result = VK_SUCCESS;
    for (uint32_t i = 0; i < count && result == VK_SUCCESS; i++) {
        VkComputePipelineCreateInfo info = infos[i];
        info.flags |= VK_PIPELINE_CREATE_CAPTURE_STATISTICS_BIT_KHR |
                      VK_PIPELINE_CREATE_CAPTURE_INTERNAL_REPRESENTATIONS_BIT_KHR;
        result = vkCreateComputePipelines(device, cache, 1, &info, allocator, &out[i]);
        if (result != VK_SUCCESS || record->pipeline_count == MAX_COST_PIPELINES)
            continue;
        struct cost_pipeline *p = &record->pipelines[record->pipeline_count++];
        const VkPipelineExecutableInfoKHR which = {
            .sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_INFO_KHR, .pipeline = out[i]};
        p->pipeline = out[i];
        read_statistics(&which, p);
        read_forms(&which, p);
    }
    return result;
}

static VKAPI_ATTR VkResult VKAPI_CALL set_name(VkDevice device,
                                               const VkDebugUtilsObjectNameInfoEXT *info)
{
    struct cost_record *record = &null_device.record;
    (void)device;
    for (size_t i = 0; i < record->pipeline_count; i++) {
        struct cost_pipeline *p = &record->pipelines[i];
        if (info->objectType == VK_OBJECT_TYPE_PIPELINE &&
            info->objectHandle == (uint64_t)(uintptr_t)p->pipeline)
            snprintf(p->pass, sizeof p->pass, "%s", info->pObjectName);
    }
    return VK_SUCCESS;
}

/* --- Commands: counted --- */

static VKAPI_ATTR void VKAPI_CALL bind_pipeline(VkCommandBuffer cmd, VkPipelineBindPoint point,
                                                VkPipeline pipeline)
{
    const struct cost_record *record = &null_device.record;
    (void)cmd;
    (void)point;
    for (size_t i = 0; i < record->pipeline_count; i++)
        if (record->pipelines[i].pipeline == pipeline)
            null_device.bound = i;
}

static void add_dispatch(uint64_t groups)
{
    struct cost_record *record = &null_device.record;
    if (record->dispatch_count < MAX_COST_DISPATCHES)
        record->dispatches[record->dispatch_count++] =
            (struct cost_dispatch){null_device.bound, groups};
}

static VKAPI_ATTR void VKAPI_CALL dispatch(VkCommandBuffer cmd, uint32_t x, uint32_t y, uint32_t z)
{
    (void)cmd;
    add_dispatch((uint64_t)x * y * z);
}

static VKAPI_ATTR void VKAPI_CALL dispatch_indirect(VkCommandBuffer cmd, VkBuffer buffer,
                                                    VkDeviceSize offset)
{
    (void)cmd;
    (void)buffer;
    (void)offset;
    add_dispatch(0);
}

/* --- All else: accepted, and nothing comes of it. RADV's null device has neither memory nor
 * images --- */

#define FAKE_OBJECT(Name)                                                                          \
    static VKAPI_ATTR VkResult VKAPI_CALL create_##Name(                                           \
        VkDevice device, const Vk##Name##CreateInfo *info, const VkAllocationCallbacks *allocator, \
        Vk##Name *out)                                                                             \
    {                                                                                              \
        (void)device;                                                                              \
        (void)info;                                                                                \
        (void)allocator;                                                                           \
        *out = (Vk##Name)++ null_device.handles;                                                   \
        return VK_SUCCESS;                                                                         \
    }                                                                                              \
    FAKE_END(Name)

#define FAKE_END(Name)                                                                             \
    static VKAPI_ATTR void VKAPI_CALL destroy_##Name(VkDevice device, Vk##Name object,             \
                                                     const VkAllocationCallbacks *allocator)       \
    {                                                                                              \
        (void)device;                                                                              \
        (void)object;                                                                              \
        (void)allocator;                                                                           \
    }

#define FAKE_MEMORY(Name)                                                                          \
    static VKAPI_ATTR void VKAPI_CALL require_##Name(VkDevice device, Vk##Name object,             \
                                                     VkMemoryRequirements *out)                    \
    {                                                                                              \
        (void)device;                                                                              \
        (void)object;                                                                              \
        *out = (VkMemoryRequirements){.size = 4096, .alignment = 256, .memoryTypeBits = 1};        \
    }                                                                                              \
    static VKAPI_ATTR VkResult VKAPI_CALL bind_##Name(VkDevice device, Vk##Name object,            \
                                                      VkDeviceMemory memory, VkDeviceSize offset)  \
    {                                                                                              \
        (void)device;                                                                              \
        (void)object;                                                                              \
        (void)memory;                                                                              \
        (void)offset;                                                                              \
        return VK_SUCCESS;                                                                         \
    }

FAKE_OBJECT(Image)
FAKE_OBJECT(ImageView)
FAKE_OBJECT(Buffer)
FAKE_OBJECT(BufferView)
FAKE_OBJECT(DescriptorPool)
FAKE_END(DeviceMemory)
FAKE_MEMORY(Image)
FAKE_MEMORY(Buffer)

static VKAPI_ATTR void VKAPI_CALL memory_types(VkPhysicalDevice device,
                                               VkPhysicalDeviceMemoryProperties *out)
{
    (void)device;
    *out = (VkPhysicalDeviceMemoryProperties){
        .memoryTypeCount = 1,
        .memoryTypes = {{.propertyFlags = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT}},
        .memoryHeapCount = 1,
        .memoryHeaps = {{.size = UINT64_C(1) << 32, .flags = VK_MEMORY_HEAP_DEVICE_LOCAL_BIT}},
    };
}

static VKAPI_ATTR VkResult VKAPI_CALL allocate(VkDevice device, const VkMemoryAllocateInfo *info,
                                               const VkAllocationCallbacks *allocator,
                                               VkDeviceMemory *out)
{
    (void)device;
    (void)info;
    (void)allocator;
    *out = (VkDeviceMemory)++null_device.handles;
    return VK_SUCCESS;
}

static VKAPI_ATTR VkResult VKAPI_CALL allocate_sets(VkDevice device,
                                                    const VkDescriptorSetAllocateInfo *info,
                                                    VkDescriptorSet *out)
{
    (void)device;
    for (uint32_t i = 0; i < info->descriptorSetCount; i++)
        out[i] = (VkDescriptorSet)++null_device.handles;
    return VK_SUCCESS;
}

static VKAPI_ATTR void VKAPI_CALL update_sets(VkDevice device, uint32_t write_count,
                                              const VkWriteDescriptorSet *writes,
                                              uint32_t copy_count,
                                              const VkCopyDescriptorSet *copies)
{
    (void)device;
    (void)write_count;
    (void)writes;
    (void)copy_count;
    (void)copies;
}

static VKAPI_ATTR void VKAPI_CALL bind_sets(VkCommandBuffer cmd, VkPipelineBindPoint point,
                                            VkPipelineLayout layout, uint32_t first, uint32_t count,
                                            const VkDescriptorSet *sets, uint32_t offset_count,
                                            const uint32_t *offsets)
{
    (void)cmd;
    (void)point;
    (void)layout;
    (void)first;
    (void)count;
    (void)sets;
    (void)offset_count;
    (void)offsets;
}

static VKAPI_ATTR void VKAPI_CALL barrier(VkCommandBuffer cmd, VkPipelineStageFlags from,
                                          VkPipelineStageFlags to, VkDependencyFlags flags,
                                          uint32_t memory_count, const VkMemoryBarrier *memory,
                                          uint32_t buffer_count,
                                          const VkBufferMemoryBarrier *buffers,
                                          uint32_t image_count, const VkImageMemoryBarrier *images)
{
    (void)cmd;
    (void)from;
    (void)to;
    (void)flags;
    (void)memory_count;
    (void)memory;
    (void)buffer_count;
    (void)buffers;
    (void)image_count;
    (void)images;
}

static VKAPI_ATTR void VKAPI_CALL push_constants(VkCommandBuffer cmd, VkPipelineLayout layout,
                                                 VkShaderStageFlags stages, uint32_t offset,
                                                 uint32_t size, const void *values)
{
    (void)cmd;
    (void)layout;
    (void)stages;
    (void)offset;
    (void)size;
    (void)values;
}

static VKAPI_ATTR void VKAPI_CALL update_buffer(VkCommandBuffer cmd, VkBuffer buffer,
                                                VkDeviceSize offset, VkDeviceSize size,
                                                const void *data)
{
    (void)cmd;
    (void)buffer;
    (void)offset;
    (void)size;
    (void)data;
}

static VKAPI_ATTR void VKAPI_CALL begin_label(VkCommandBuffer cmd, const VkDebugUtilsLabelEXT *info)
{
    (void)cmd;
    (void)info;
}

static VKAPI_ATTR void VKAPI_CALL end_label(VkCommandBuffer cmd)
{
    (void)cmd;
}

/* --- The tables that the library asks --- */

#define OF(name, function)                                                                         \
    {                                                                                              \
        name, (PFN_vkVoidFunction)(function)                                                       \
    }

static const struct {
    const char *name;
    PFN_vkVoidFunction function;
} functions[] = {
    OF("vkCreateComputePipelines", create_pipelines),
    OF("vkSetDebugUtilsObjectNameEXT", set_name),
    OF("vkCmdBeginDebugUtilsLabelEXT", begin_label),
    OF("vkCmdEndDebugUtilsLabelEXT", end_label),
    OF("vkCmdBindPipeline", bind_pipeline),
    OF("vkCmdDispatch", dispatch),
    OF("vkCmdDispatchIndirect", dispatch_indirect),
    OF("vkGetPhysicalDeviceMemoryProperties", memory_types),
    OF("vkCreateImage", create_Image),
    OF("vkDestroyImage", destroy_Image),
    OF("vkGetImageMemoryRequirements", require_Image),
    OF("vkBindImageMemory", bind_Image),
    OF("vkCreateImageView", create_ImageView),
    OF("vkDestroyImageView", destroy_ImageView),
    OF("vkCreateBuffer", create_Buffer),
    OF("vkDestroyBuffer", destroy_Buffer),
    OF("vkGetBufferMemoryRequirements", require_Buffer),
    OF("vkBindBufferMemory", bind_Buffer),
    OF("vkCreateBufferView", create_BufferView),
    OF("vkDestroyBufferView", destroy_BufferView),
    OF("vkCreateDescriptorPool", create_DescriptorPool),
    OF("vkDestroyDescriptorPool", destroy_DescriptorPool),
    OF("vkAllocateDescriptorSets", allocate_sets),
    OF("vkUpdateDescriptorSets", update_sets),
    OF("vkAllocateMemory", allocate),
    OF("vkFreeMemory", destroy_DeviceMemory),
    OF("vkCmdPipelineBarrier", barrier),
    OF("vkCmdBindDescriptorSets", bind_sets),
    OF("vkCmdPushConstants", push_constants),
    OF("vkCmdUpdateBuffer", update_buffer),
};

static PFN_vkVoidFunction function_of(const char *name)
{
    for (size_t i = 0; i < sizeof functions / sizeof functions[0]; i++)
        if (strcmp(functions[i].name, name) == 0)
            return functions[i].function;
    return NULL;
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL instance_function(VkInstance instance,
                                                                  const char *name)
{
    PFN_vkVoidFunction own = function_of(name);
    return own ? own : vkGetInstanceProcAddr(instance, name);
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL device_function(VkDevice device, const char *name)
{
    PFN_vkVoidFunction own = function_of(name);
    return own ? own : vkGetDeviceProcAddr(device, name);
}

/* --- The device --- */

static bool create_compiler(const struct gpu *gpu, struct tool_error *err)
{
    static const char *const extensions[] = {VK_KHR_PIPELINE_EXECUTABLE_PROPERTIES_EXTENSION_NAME};
    VkPhysicalDevicePipelineExecutablePropertiesFeaturesKHR executables = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PIPELINE_EXECUTABLE_PROPERTIES_FEATURES_KHR,
        .pipelineExecutableInfo = VK_TRUE};
    VkPhysicalDevice16BitStorageFeatures storage = gpu->storage_features;
    storage.pNext = &executables;
    VkResult result =
        vkCreateDevice(gpu->physical_device,
                       &(VkDeviceCreateInfo){
                           .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                           .pNext = &storage,
                           .queueCreateInfoCount = 1,
                           .pQueueCreateInfos =
                               &(VkDeviceQueueCreateInfo){
                                   .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                   .queueFamilyIndex = gpu->queue_family,
                                   .queueCount = 1,
                                   .pQueuePriorities = &(float){1.0f},
                               },
                           .enabledExtensionCount = 1,
                           .ppEnabledExtensionNames = extensions,
                           .pEnabledFeatures = &gpu->features.features,
                       },
                       NULL, &null_device.device);
    if (result != VK_SUCCESS)
        null_device.device = VK_NULL_HANDLE;
    return gpu_ok(err, "vkCreateDevice", result);
}

bool cost_device_create(const char *family, struct gpu *gpu, struct tool_error *err)
{
    const struct gpu_options options = {.device = "Null hardware"};
    struct tool_error why = {0};
    setenv("RADV_FORCE_FAMILY", family, 1);
    if (!gpu_create(&options, gpu, &why)) {
        fail(err, EXIT_DEVICE, "RADV does not compile for %s here: %s", family, why.message);
        return fail_hint(err, "install mesa-vulkan-drivers");
    }
    if (create_compiler(gpu, err))
        return true;
    gpu_destroy(gpu);
    return false;
}

void cost_device_destroy(struct gpu *gpu)
{
    cost_device_forget();
    if (null_device.device)
        vkDestroyDevice(null_device.device, NULL);
    null_device.device = VK_NULL_HANDLE;
    gpu_destroy(gpu);
}

vkao_context_info cost_device_context_info(struct gpu *gpu)
{
    vkao_context_info info = gpu_context_info(gpu);
    info.device = null_device.device;
    info.get_instance_proc_addr = instance_function;
    info.get_device_proc_addr = device_function;
    info.debug_labels = VK_TRUE; /* which is how passes get their names */
    return info;
}

const struct cost_record *cost_device_record(void)
{
    return &null_device.record;
}

void cost_device_forget(void)
{
    for (size_t i = 0; i < null_device.record.pipeline_count; i++)
        free(null_device.record.pipelines[i].assembly);
    null_device.record = (struct cost_record){0};
}

VkImageView cost_device_view(void)
{
    return (VkImageView)++null_device.handles;
}

VkCommandBuffer cost_device_command_buffer(void)
{
    return (VkCommandBuffer)++null_device.handles;
}
