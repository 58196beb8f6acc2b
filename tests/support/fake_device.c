/* SPDX-License-Identifier: MIT */
#include "fake_internal.h"

#include <string.h>

/* Whether this call, which returns VkResult, is the one that shall fail. */
static bool fails(struct fake_vulkan *fake, const char *name)
{
    const unsigned call = ++fake->result_calls;
    if (call != fake->fail_at && !(fake->fail_from && call > fake->fail_at))
        return false;
    fake->failed = name;
    return true;
}

static bool same_callbacks(const VkAllocationCallbacks *a, const VkAllocationCallbacks *b)
{
    if (!a || !b)
        return a == b;
    return a->pUserData == b->pUserData && a->pfnAllocation == b->pfnAllocation &&
           a->pfnReallocation == b->pfnReallocation && a->pfnFree == b->pfnFree;
}

/* What every vkCreate* does. An error leaves an output parameter undefined, so here it leaves
 * garbage. */
static VkResult create(VkDevice device, const char *name, VkObjectType type,
                       const VkAllocationCallbacks *allocator, uint64_t *out,
                       struct fake_object **made)
{
    struct fake_vulkan *fake = fake_of(device);
    struct fake_call *call = fake_note(fake, name);
    *out = UINT64_C(0xdeadbeefdead);
    *made = NULL;
    if (!same_callbacks(allocator, fake->expected_allocator))
        fake_misuse(fake, "%s: not the caller's allocation callbacks", name);
    if (fails(fake, name))
        return fake->fail_result;
    void *host = NULL;
    if (allocator) {
        host = allocator->pfnAllocation(allocator->pUserData, 32, 16,
                                        VK_SYSTEM_ALLOCATION_SCOPE_OBJECT);
        if (!host) {
            fake->failed = name;
            return VK_ERROR_OUT_OF_HOST_MEMORY;
        }
    }
    *made = fake_add(fake, type);
    (*made)->allocator = fake->expected_allocator;
    (*made)->host = host;
    *out = call->handle = (*made)->handle;
    return VK_SUCCESS;
}

static void destroy(VkDevice device, const char *name, VkObjectType type, uint64_t handle,
                    const VkAllocationCallbacks *allocator)
{
    struct fake_vulkan *fake = fake_of(device);
    fake_note(fake, name)->handle = handle;
    if (!handle)
        return;
    struct fake_object *object = fake_use(fake, name, type, handle);
    if (!object)
        return;
    if (object->of_caller)
        fake_misuse(fake, "%s: the object is the caller's", name);
    if (!same_callbacks(allocator, object->allocator))
        fake_misuse(fake, "%s: other allocation callbacks than at creation", name);
    if (object->host && allocator)
        allocator->pfnFree(allocator->pUserData, object->host);
    object->alive = false;
    for (size_t i = 0; i < fake->object_count; ++i) {
        if (fake->objects[i].parent == handle &&
            fake->objects[i].type == VK_OBJECT_TYPE_DESCRIPTOR_SET)
            fake->objects[i].alive = false;
    }
}

/* Of the formats that views of the library's buffer have. */
static VkDeviceSize texel_bytes(VkFormat format)
{
    switch (format) {
    case VK_FORMAT_R8_UINT:
        return 1;
    case VK_FORMAT_R16_UINT:
        return 2;
    case VK_FORMAT_R32_UINT:
    case VK_FORMAT_R32_SFLOAT:
        return 4;
    default:
        return 16;
    }
}

/* A create and destroy pair. The body sees fake, call and object, after success. */
#define FAKE_CREATE(Name, TYPE, BODY)                                                              \
    static VKAPI_ATTR VkResult VKAPI_CALL fake_Create##Name(                                       \
        VkDevice device, const Vk##Name##CreateInfo *info, const VkAllocationCallbacks *allocator, \
        Vk##Name *out)                                                                             \
    {                                                                                              \
        struct fake_object *object;                                                                \
        uint64_t handle;                                                                           \
        pthread_mutex_lock(&fake_of(device)->lock);                                                \
        VkResult result =                                                                          \
            create(device, "vkCreate" #Name, VK_OBJECT_TYPE_##TYPE, allocator, &handle, &object);  \
        *out = (Vk##Name)(uintptr_t)handle;                                                        \
        if (object) {                                                                              \
            struct fake_vulkan *fake = fake_of(device);                                            \
            struct fake_call *call = &fake->calls[fake->call_count - 1];                           \
            (void)call;                                                                            \
            (void)info;                                                                            \
            BODY                                                                                   \
        }                                                                                          \
        pthread_mutex_unlock(&fake_of(device)->lock);                                              \
        return result;                                                                             \
    }
#define FAKE_DESTROY(Name, TYPE)                                                                   \
    static VKAPI_ATTR void VKAPI_CALL fake_Destroy##Name(VkDevice device, Vk##Name handle,         \
                                                         const VkAllocationCallbacks *allocator)   \
    {                                                                                              \
        pthread_mutex_lock(&fake_of(device)->lock);                                                \
        destroy(device, "vkDestroy" #Name, VK_OBJECT_TYPE_##TYPE, fake_number(handle), allocator); \
        pthread_mutex_unlock(&fake_of(device)->lock);                                              \
    }

FAKE_CREATE(ShaderModule, SHADER_MODULE, {
    if (!info->codeSize || info->codeSize % 4 || info->pCode[0] != 0x07230203u)
        fake_misuse(fake, "vkCreateShaderModule: no SPIR-V");
    object->code = info->pCode;
})
FAKE_DESTROY(ShaderModule, SHADER_MODULE)
/* What every Vulkan 1.1 device has per stage, and not one more. */
static void check_layout(struct fake_vulkan *fake, const VkDescriptorSetLayoutCreateInfo *info)
{
    unsigned sampled = 0, images = 0, buffers = 0, uniforms = 0;
    for (uint32_t i = 0; i < info->bindingCount; ++i) {
        switch (info->pBindings[i].descriptorType) {
        case VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE:
            ++sampled;
            break;
        case VK_DESCRIPTOR_TYPE_STORAGE_IMAGE:
        case VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER:
            ++images;
            break;
        case VK_DESCRIPTOR_TYPE_STORAGE_BUFFER:
            ++buffers;
            break;
        case VK_DESCRIPTOR_TYPE_SAMPLER:
            if (info->pBindings[i].pImmutableSamplers)
                fake_use(fake, "vkCreateDescriptorSetLayout", VK_OBJECT_TYPE_SAMPLER,
                         fake_number(info->pBindings[i].pImmutableSamplers[0]));
            else
                fake_misuse(fake, "vkCreateDescriptorSetLayout: nobody writes samplers");
            break;
        default:
            ++uniforms;
        }
        for (uint32_t k = 0; k < i; ++k) {
            if (info->pBindings[k].binding == info->pBindings[i].binding)
                fake_misuse(fake, "binding %u twice", info->pBindings[i].binding);
        }
    }
    if (sampled > 16 || images > 4 || buffers > 4 || uniforms > 12)
        fake_misuse(fake,
                    "vkCreateDescriptorSetLayout: %u sampled images, %u storage images and texel "
                    "buffers, %u storage buffers; devices need have 16, 4 and 4",
                    sampled, images, buffers);
}

FAKE_CREATE(DescriptorSetLayout, DESCRIPTOR_SET_LAYOUT, { check_layout(fake, info); })
FAKE_DESTROY(DescriptorSetLayout, DESCRIPTOR_SET_LAYOUT)
FAKE_CREATE(PipelineLayout, PIPELINE_LAYOUT, {
    fake_use(fake, call->name, VK_OBJECT_TYPE_DESCRIPTOR_SET_LAYOUT,
             fake_number(info->pSetLayouts[0]));
    if (info->setLayoutCount > 4 || info->pPushConstantRanges[0].size > 128)
        fake_misuse(fake,
                    "vkCreatePipelineLayout: more sets or push constants than devices need have");
})
FAKE_DESTROY(PipelineLayout, PIPELINE_LAYOUT)
FAKE_CREATE(DescriptorPool, DESCRIPTOR_POOL, {})
FAKE_DESTROY(DescriptorPool, DESCRIPTOR_POOL)
FAKE_CREATE(Image, IMAGE, {
    call->image = object->image = *info;
    const VkExtent3D extent = info->extent;
    if (extent.width > fake->max_dimension || extent.height > fake->max_dimension)
        fake_misuse(fake, "vkCreateImage: larger than maxImageDimension2D");
})
FAKE_DESTROY(Image, IMAGE)
FAKE_CREATE(ImageView, IMAGE_VIEW, {
    const struct fake_object *image =
        fake_use(fake, call->name, VK_OBJECT_TYPE_IMAGE, fake_number(info->image));
    object->parent = fake_number(info->image);
    if (image && !image->memory)
        fake_misuse(fake, "vkCreateImageView: the image has no memory");
    if (image && image->image.format != info->format)
        fake_misuse(fake, "vkCreateImageView: not the image's format");
})
FAKE_DESTROY(ImageView, IMAGE_VIEW)
FAKE_CREATE(Buffer, BUFFER, {
    call->size = object->bytes = info->size;
    object->usage = info->usage;
})
FAKE_DESTROY(Buffer, BUFFER)
FAKE_CREATE(BufferView, BUFFER_VIEW, {
    const struct fake_object *buffer =
        fake_use(fake, call->name, VK_OBJECT_TYPE_BUFFER, fake_number(info->buffer));
    object->parent = fake_number(info->buffer);
    if (info->range / texel_bytes(info->format) > fake->max_texels)
        fake_misuse(fake, "vkCreateBufferView: more texels than maxTexelBufferElements");
    call->format = info->format;
    call->offset = info->offset;
    call->size = info->range;
    if (buffer && !buffer->memory)
        fake_misuse(fake, "vkCreateBufferView: the buffer has no memory");
    if (buffer && (!info->range || info->offset + info->range > buffer->bytes))
        fake_misuse(fake, "vkCreateBufferView: beyond the buffer");
})
FAKE_DESTROY(BufferView, BUFFER_VIEW)
FAKE_CREATE(Sampler, SAMPLER, {
    if (info->unnormalizedCoordinates &&
        (info->minFilter != info->magFilter || info->mipmapMode || info->minLod != 0.0f ||
         info->maxLod != 0.0f || info->anisotropyEnable || info->compareEnable ||
         info->addressModeU != VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE ||
         info->addressModeV != VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE))
        fake_misuse(fake, "vkCreateSampler: not what coordinates that are texels allow");
})
FAKE_DESTROY(Sampler, SAMPLER)
FAKE_DESTROY(Pipeline, PIPELINE)

/* By their ids, as bits, those that the SPIR-V says it has. */
static uint32_t constants_of(const uint32_t *code)
{
    enum { HEADER = 5, DECORATE = 71, FUNCTION = 54, SPEC_ID = 1 };
    uint32_t mask = 0;
    for (code += HEADER; (code[0] & 0xffff) != FUNCTION; code += code[0] >> 16) {
        if ((code[0] & 0xffff) == DECORATE && code[2] == SPEC_ID)
            mask |= 1u << code[3];
    }
    return mask;
}

/* What a pipeline is made of: a value for each constant of its shader, and for no other. */
static void keep_constants(struct fake_vulkan *fake, struct fake_object *object,
                           const VkSpecializationInfo *info)
{
    const uint32_t wanted = constants_of(object->code);
    for (uint32_t i = 0; info && i < info->mapEntryCount; ++i) {
        const VkSpecializationMapEntry *e = &info->pMapEntries[i];
        if (e->constantID >= FAKE_CONSTANTS || e->size != 4 || e->offset + e->size > info->dataSize)
            fake_misuse(fake, "vkCreateComputePipelines: constant %u", e->constantID);
        else
            memcpy(&object->constants[e->constantID], (const char *)info->pData + e->offset, 4);
        object->given |= 1u << e->constantID;
    }
    if (object->given != wanted)
        fake_misuse(fake, "vkCreateComputePipelines: constants %#x of %#x", object->given, wanted);
}

static VKAPI_ATTR VkResult VKAPI_CALL fake_CreateComputePipelines(
    VkDevice device, VkPipelineCache cache, uint32_t count, const VkComputePipelineCreateInfo *info,
    const VkAllocationCallbacks *allocator, VkPipeline *out)
{
    struct fake_vulkan *fake = fake_of(device);
    struct fake_object *object;
    uint64_t handle;
    pthread_mutex_lock(&fake->lock);
    VkResult result = create(device, "vkCreateComputePipelines", VK_OBJECT_TYPE_PIPELINE, allocator,
                             &handle, &object);
    fake->calls[fake->call_count - 1].cache = cache;
    if (count != 1)
        fake_misuse(fake, "the fake builds one pipeline a call");
    const struct fake_object *module =
        fake_use(fake, "vkCreateComputePipelines", VK_OBJECT_TYPE_SHADER_MODULE,
                 fake_number(info->stage.module));
    fake_use(fake, "vkCreateComputePipelines", VK_OBJECT_TYPE_PIPELINE_LAYOUT,
             fake_number(info->layout));
    if (object && module) {
        object->code = module->code;
        keep_constants(fake, object, info->stage.pSpecializationInfo);
    }
    *out = (VkPipeline)(uintptr_t)handle;
    pthread_mutex_unlock(&fake->lock);
    if (fake->compiling)
        pthread_barrier_wait(fake->compiling);
    return result;
}

static VKAPI_ATTR VkResult VKAPI_CALL fake_AllocateDescriptorSets(
    VkDevice device, const VkDescriptorSetAllocateInfo *info, VkDescriptorSet *out)
{
    struct fake_vulkan *fake = fake_of(device);
    struct fake_call *call = fake_note(fake, "vkAllocateDescriptorSets");
    *out = (VkDescriptorSet)(uintptr_t)0xdeadbeef;
    if (fails(fake, call->name))
        return fake->fail_result;
    fake_use(fake, call->name, VK_OBJECT_TYPE_DESCRIPTOR_POOL, fake_number(info->descriptorPool));
    for (uint32_t i = 0; i < info->descriptorSetCount; ++i) {
        fake_use(fake, call->name, VK_OBJECT_TYPE_DESCRIPTOR_SET_LAYOUT,
                 fake_number(info->pSetLayouts[i]));
        struct fake_object *object = fake_add(fake, VK_OBJECT_TYPE_DESCRIPTOR_SET);
        object->parent = fake_number(info->descriptorPool);
        call->handle = object->handle;
        out[i] = (VkDescriptorSet)(uintptr_t)object->handle;
    }
    return VK_SUCCESS;
}

static VKAPI_ATTR void VKAPI_CALL fake_UpdateDescriptorSets(VkDevice device, uint32_t count,
                                                            const VkWriteDescriptorSet *writes,
                                                            uint32_t copy_count,
                                                            const VkCopyDescriptorSet *copies)
{
    struct fake_vulkan *fake = fake_of(device);
    struct fake_call *call = fake_note(fake, "vkUpdateDescriptorSets");
    (void)copies;
    if (copy_count || count > FAKE_WRITES)
        fake_misuse(fake, "vkUpdateDescriptorSets: %u writes, %u copies", count, copy_count);
    for (uint32_t i = 0; i < count && i < FAKE_WRITES; ++i) {
        struct fake_object *set = fake_use(fake, call->name, VK_OBJECT_TYPE_DESCRIPTOR_SET,
                                           fake_number(writes[i].dstSet));
        if (writes[i].descriptorType == VK_DESCRIPTOR_TYPE_STORAGE_BUFFER ||
            writes[i].descriptorType == VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER) {
            const VkDescriptorBufferInfo *info = writes[i].pBufferInfo;
            const struct fake_object *buffer =
                fake_use(fake, call->name, VK_OBJECT_TYPE_BUFFER, fake_number(info->buffer));
            if (buffer && (!info->range || info->offset + info->range > buffer->bytes ||
                           info->range > fake->max_buffer))
                fake_misuse(fake, "vkUpdateDescriptorSets: beyond the buffer, or the limit");
            continue;
        }
        if (writes[i].descriptorType == VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER) {
            fake_use(fake, call->name, VK_OBJECT_TYPE_BUFFER_VIEW,
                     fake_number(writes[i].pTexelBufferView[0]));
            continue;
        }
        uint64_t view = fake_number(writes[i].pImageInfo->imageView);
        fake_use(fake, call->name, VK_OBJECT_TYPE_IMAGE_VIEW, view);
        if (set && writes[i].dstBinding < FAKE_WRITES)
            set->views[writes[i].dstBinding] = view;
        call->handle = fake_number(writes[i].dstSet);
        call->writes[call->write_count].binding = writes[i].dstBinding;
        call->writes[call->write_count].type = writes[i].descriptorType;
        call->writes[call->write_count].view = view;
        call->writes[call->write_count++].layout = writes[i].pImageInfo->imageLayout;
    }
}

static VKAPI_ATTR void VKAPI_CALL fake_GetImageMemoryRequirements(VkDevice device, VkImage image,
                                                                  VkMemoryRequirements *out)
{
    struct fake_vulkan *fake = fake_of(device);
    fake_note(fake, "vkGetImageMemoryRequirements")->handle = fake_number(image);
    const struct fake_object *object =
        fake_use(fake, "vkGetImageMemoryRequirements", VK_OBJECT_TYPE_IMAGE, fake_number(image));
    const VkFormat format = object ? object->image.format : VK_FORMAT_UNDEFINED;
    const VkDeviceSize texel = format == VK_FORMAT_R8_UNORM     ? 1
                               : format == VK_FORMAT_R16_SFLOAT ? 2
                                                                : 4;
    *out = (VkMemoryRequirements){
        .size = object ? texel * object->image.extent.width * object->image.extent.height : 0,
        .alignment = fake->image_alignment,
        .memoryTypeBits = fake->image_type_bits,
    };
}

static VKAPI_ATTR void VKAPI_CALL fake_GetBufferMemoryRequirements(VkDevice device, VkBuffer buffer,
                                                                   VkMemoryRequirements *out)
{
    struct fake_vulkan *fake = fake_of(device);
    fake_note(fake, "vkGetBufferMemoryRequirements")->handle = fake_number(buffer);
    const struct fake_object *object =
        fake_use(fake, "vkGetBufferMemoryRequirements", VK_OBJECT_TYPE_BUFFER, fake_number(buffer));
    *out = (VkMemoryRequirements){
        .size = object ? object->bytes : 0,
        .alignment = fake->image_alignment,
        .memoryTypeBits = fake->image_type_bits,
    };
}

static VKAPI_ATTR VkResult VKAPI_CALL fake_BindBufferMemory(VkDevice device, VkBuffer buffer,
                                                            VkDeviceMemory memory,
                                                            VkDeviceSize offset)
{
    struct fake_vulkan *fake = fake_of(device);
    struct fake_call *call = fake_note(fake, "vkBindBufferMemory");
    if (fails(fake, call->name))
        return fake->fail_result;
    struct fake_object *object =
        fake_use(fake, call->name, VK_OBJECT_TYPE_BUFFER, fake_number(buffer));
    fake_use(fake, call->name, VK_OBJECT_TYPE_DEVICE_MEMORY, fake_number(memory));
    if (offset % fake->image_alignment)
        fake_misuse(fake, "vkBindBufferMemory: offset %llu", (unsigned long long)offset);
    if (object && object->memory)
        fake_misuse(fake, "vkBindBufferMemory: the buffer has memory");
    if (object)
        object->memory = fake_number(memory);
    call->handle = fake_number(buffer);
    call->memory = fake_number(memory);
    call->offset = offset;
    return VK_SUCCESS;
}

static VKAPI_ATTR VkResult VKAPI_CALL fake_AllocateMemory(VkDevice device,
                                                          const VkMemoryAllocateInfo *info,
                                                          const VkAllocationCallbacks *allocator,
                                                          VkDeviceMemory *out)
{
    struct fake_object *object;
    uint64_t handle;
    VkResult result = create(device, "vkAllocateMemory", VK_OBJECT_TYPE_DEVICE_MEMORY, allocator,
                             &handle, &object);
    struct fake_vulkan *fake = fake_of(device);
    fake->calls[fake->call_count - 1].size = info->allocationSize;
    fake->calls[fake->call_count - 1].memory_type = info->memoryTypeIndex;
    *out = (VkDeviceMemory)(uintptr_t)handle;
    return result;
}

static VKAPI_ATTR void VKAPI_CALL fake_FreeMemory(VkDevice device, VkDeviceMemory memory,
                                                  const VkAllocationCallbacks *allocator)
{
    destroy(device, "vkFreeMemory", VK_OBJECT_TYPE_DEVICE_MEMORY, fake_number(memory), allocator);
}

static VKAPI_ATTR VkResult VKAPI_CALL fake_BindImageMemory(VkDevice device, VkImage image,
                                                           VkDeviceMemory memory,
                                                           VkDeviceSize offset)
{
    struct fake_vulkan *fake = fake_of(device);
    struct fake_call *call = fake_note(fake, "vkBindImageMemory");
    if (fails(fake, call->name))
        return fake->fail_result;
    struct fake_object *object =
        fake_use(fake, call->name, VK_OBJECT_TYPE_IMAGE, fake_number(image));
    fake_use(fake, call->name, VK_OBJECT_TYPE_DEVICE_MEMORY, fake_number(memory));
    if (offset % fake->image_alignment)
        fake_misuse(fake, "vkBindImageMemory: offset %llu", (unsigned long long)offset);
    if (object && object->memory)
        fake_misuse(fake, "vkBindImageMemory: the image has memory");
    if (object)
        object->memory = fake_number(memory);
    call->handle = fake_number(image);
    call->memory = fake_number(memory);
    call->offset = offset;
    return VK_SUCCESS;
}

static VKAPI_ATTR VkResult VKAPI_CALL
fake_SetDebugUtilsObjectNameEXT(VkDevice device, const VkDebugUtilsObjectNameInfoEXT *info)
{
    struct fake_vulkan *fake = fake_of(device);
    pthread_mutex_lock(&fake->lock);
    struct fake_call *call = fake_note(fake, "vkSetDebugUtilsObjectNameEXT");
    call->handle = info->objectHandle;
    fake_use(fake, call->name, info->objectType, info->objectHandle);
    const VkResult result = fails(fake, call->name) ? fake->fail_result : VK_SUCCESS;
    pthread_mutex_unlock(&fake->lock);
    return result;
}

static VKAPI_ATTR void VKAPI_CALL fake_CmdBeginDebugUtilsLabelEXT(VkCommandBuffer cmd,
                                                                  const VkDebugUtilsLabelEXT *label)
{
    fake_note(fake_of(cmd), "vkCmdBeginDebugUtilsLabelEXT");
    if (!label->pLabelName || !label->pLabelName[0])
        fake_misuse(fake_of(cmd), "vkCmdBeginDebugUtilsLabelEXT: no name");
}

static VKAPI_ATTR void VKAPI_CALL fake_CmdEndDebugUtilsLabelEXT(VkCommandBuffer cmd)
{
    fake_note(fake_of(cmd), "vkCmdEndDebugUtilsLabelEXT");
}

/* Known devices for Vulkan 1.1 by; the library has no command pool. */
static VKAPI_ATTR void VKAPI_CALL fake_TrimCommandPool(VkDevice device, VkCommandPool pool,
                                                       VkCommandPoolTrimFlags flags)
{
    (void)pool;
    (void)flags;
    fake_misuse(fake_of(device), "vkTrimCommandPool is called");
}

#define ENTRY(name)                                                                                \
    {                                                                                              \
        "vk" #name, (PFN_vkVoidFunction)fake_##name                                                \
    }
const struct fake_entry fake_debug_functions[FAKE_DEBUG_FUNCTIONS] = {
    ENTRY(SetDebugUtilsObjectNameEXT),
    ENTRY(CmdBeginDebugUtilsLabelEXT),
    ENTRY(CmdEndDebugUtilsLabelEXT),
};
const struct fake_entry fake_device_functions[FAKE_DEVICE_FUNCTIONS] = {
    ENTRY(CreateShaderModule),
    ENTRY(DestroyShaderModule),
    ENTRY(CreateDescriptorSetLayout),
    ENTRY(DestroyDescriptorSetLayout),
    ENTRY(CreatePipelineLayout),
    ENTRY(DestroyPipelineLayout),
    ENTRY(CreateComputePipelines),
    ENTRY(DestroyPipeline),
    ENTRY(CreateDescriptorPool),
    ENTRY(DestroyDescriptorPool),
    ENTRY(AllocateDescriptorSets),
    ENTRY(UpdateDescriptorSets),
    ENTRY(CreateImage),
    ENTRY(DestroyImage),
    ENTRY(GetImageMemoryRequirements),
    ENTRY(AllocateMemory),
    ENTRY(FreeMemory),
    ENTRY(BindImageMemory),
    ENTRY(CreateImageView),
    ENTRY(DestroyImageView),
    ENTRY(CreateBuffer),
    ENTRY(DestroyBuffer),
    ENTRY(GetBufferMemoryRequirements),
    ENTRY(BindBufferMemory),
    ENTRY(CreateBufferView),
    ENTRY(DestroyBufferView),
    ENTRY(CreateSampler),
    ENTRY(DestroySampler),
    ENTRY(TrimCommandPool),
};
