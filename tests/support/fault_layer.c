/* SPDX-License-Identifier: MIT
 *
 * A Vulkan layer that makes one call of a program fail, whatever that program is: tests/cli and
 * tests/view load it into the tools. By environment variables:
 *
 *     VKAO_FAULT=NAME:N:RESULT  the N-th call (from 1) of NAME, or of all together if NAME is *,
 *                               does nothing and returns this VkResult (a number)
 *     VKAO_FAULT_LOG=FILE       appends the name of every call that could have failed
 *
 * A device that was lost stays lost: all that waits for it, submits or presents says so from then
 * on. What waits does wait first, since this device works on behind the back of the error. */
#include <fcntl.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <vulkan/vk_layer.h>
#include <vulkan/vulkan.h>

/* What the window system defines; the layer only passes it on. */
typedef VkResult(VKAPI_PTR *PFN_vkCreateXcbSurfaceKHR)(VkInstance, const void *,
                                                       const VkAllocationCallbacks *,
                                                       VkSurfaceKHR *);
typedef PFN_vkCreateXcbSurfaceKHR PFN_vkCreateXlibSurfaceKHR;

enum kind {
    PLAIN,
    WORKS = 1, /* fails for ever once the device is lost */
    WAITS = 3, /* and waits all the same */
};

/* of: what answers for the function, INSTANCE or DEVICE; kind; name; parameters; arguments. */
#define CREATE(X, name, parent_type, info_type, handle_type)                                       \
    X(DEVICE, PLAIN, name,                                                                         \
      (parent_type a, const info_type *b, const VkAllocationCallbacks *c, handle_type *d),         \
      (a, b, c, d))
#define FUNCTIONS(X)                                                                               \
    X(INSTANCE, PLAIN, EnumeratePhysicalDevices,                                                   \
      (VkInstance a, uint32_t * b, VkPhysicalDevice * c), (a, b, c))                               \
    X(INSTANCE, PLAIN, GetPhysicalDeviceImageFormatProperties,                                     \
      (VkPhysicalDevice a, VkFormat b, VkImageType c, VkImageTiling d, VkImageUsageFlags e,        \
       VkImageCreateFlags f, VkImageFormatProperties * g),                                         \
      (a, b, c, d, e, f, g))                                                                       \
    X(INSTANCE, PLAIN, GetPhysicalDeviceSurfaceSupportKHR,                                         \
      (VkPhysicalDevice a, uint32_t b, VkSurfaceKHR c, VkBool32 * d), (a, b, c, d))                \
    X(INSTANCE, PLAIN, GetPhysicalDeviceSurfaceCapabilitiesKHR,                                    \
      (VkPhysicalDevice a, VkSurfaceKHR b, VkSurfaceCapabilitiesKHR * c), (a, b, c))               \
    X(INSTANCE, PLAIN, GetPhysicalDeviceSurfaceFormatsKHR,                                         \
      (VkPhysicalDevice a, VkSurfaceKHR b, uint32_t * c, VkSurfaceFormatKHR * d), (a, b, c, d))    \
    X(INSTANCE, PLAIN, CreateXcbSurfaceKHR,                                                        \
      (VkInstance a, const void *b, const VkAllocationCallbacks *c, VkSurfaceKHR *d),              \
      (a, b, c, d))                                                                                \
    X(INSTANCE, PLAIN, CreateXlibSurfaceKHR,                                                       \
      (VkInstance a, const void *b, const VkAllocationCallbacks *c, VkSurfaceKHR *d),              \
      (a, b, c, d))                                                                                \
    CREATE(X, CreateBuffer, VkDevice, VkBufferCreateInfo, VkBuffer)                                \
    CREATE(X, CreateBufferView, VkDevice, VkBufferViewCreateInfo, VkBufferView)                    \
    CREATE(X, CreateCommandPool, VkDevice, VkCommandPoolCreateInfo, VkCommandPool)                 \
    CREATE(X, CreateDescriptorPool, VkDevice, VkDescriptorPoolCreateInfo, VkDescriptorPool)        \
    CREATE(X, CreateDescriptorSetLayout, VkDevice, VkDescriptorSetLayoutCreateInfo,                \
           VkDescriptorSetLayout)                                                                  \
    CREATE(X, CreateFence, VkDevice, VkFenceCreateInfo, VkFence)                                   \
    CREATE(X, CreateFramebuffer, VkDevice, VkFramebufferCreateInfo, VkFramebuffer)                 \
    CREATE(X, CreateImage, VkDevice, VkImageCreateInfo, VkImage)                                   \
    CREATE(X, CreateImageView, VkDevice, VkImageViewCreateInfo, VkImageView)                       \
    CREATE(X, CreatePipelineLayout, VkDevice, VkPipelineLayoutCreateInfo, VkPipelineLayout)        \
    CREATE(X, CreateQueryPool, VkDevice, VkQueryPoolCreateInfo, VkQueryPool)                       \
    CREATE(X, CreateRenderPass, VkDevice, VkRenderPassCreateInfo, VkRenderPass)                    \
    CREATE(X, CreateSampler, VkDevice, VkSamplerCreateInfo, VkSampler)                             \
    CREATE(X, CreateSemaphore, VkDevice, VkSemaphoreCreateInfo, VkSemaphore)                       \
    CREATE(X, CreateShaderModule, VkDevice, VkShaderModuleCreateInfo, VkShaderModule)              \
    CREATE(X, CreateSwapchainKHR, VkDevice, VkSwapchainCreateInfoKHR, VkSwapchainKHR)              \
    CREATE(X, AllocateMemory, VkDevice, VkMemoryAllocateInfo, VkDeviceMemory)                      \
    X(DEVICE, PLAIN, CreateComputePipelines,                                                       \
      (VkDevice a, VkPipelineCache b, uint32_t c, const VkComputePipelineCreateInfo *d,            \
       const VkAllocationCallbacks *e, VkPipeline *f),                                             \
      (a, b, c, d, e, f))                                                                          \
    X(DEVICE, PLAIN, CreateGraphicsPipelines,                                                      \
      (VkDevice a, VkPipelineCache b, uint32_t c, const VkGraphicsPipelineCreateInfo *d,           \
       const VkAllocationCallbacks *e, VkPipeline *f),                                             \
      (a, b, c, d, e, f))                                                                          \
    X(DEVICE, PLAIN, AllocateCommandBuffers,                                                       \
      (VkDevice a, const VkCommandBufferAllocateInfo *b, VkCommandBuffer *c), (a, b, c))           \
    X(DEVICE, PLAIN, AllocateDescriptorSets,                                                       \
      (VkDevice a, const VkDescriptorSetAllocateInfo *b, VkDescriptorSet *c), (a, b, c))           \
    X(DEVICE, PLAIN, BindBufferMemory, (VkDevice a, VkBuffer b, VkDeviceMemory c, VkDeviceSize d), \
      (a, b, c, d))                                                                                \
    X(DEVICE, PLAIN, BindImageMemory, (VkDevice a, VkImage b, VkDeviceMemory c, VkDeviceSize d),   \
      (a, b, c, d))                                                                                \
    X(DEVICE, PLAIN, MapMemory,                                                                    \
      (VkDevice a, VkDeviceMemory b, VkDeviceSize c, VkDeviceSize d, VkMemoryMapFlags e,           \
       void **f),                                                                                  \
      (a, b, c, d, e, f))                                                                          \
    X(DEVICE, PLAIN, FlushMappedMemoryRanges,                                                      \
      (VkDevice a, uint32_t b, const VkMappedMemoryRange *c), (a, b, c))                           \
    X(DEVICE, PLAIN, BeginCommandBuffer, (VkCommandBuffer a, const VkCommandBufferBeginInfo *b),   \
      (a, b))                                                                                      \
    X(DEVICE, PLAIN, EndCommandBuffer, (VkCommandBuffer a), (a))                                   \
    X(DEVICE, PLAIN, ResetCommandPool, (VkDevice a, VkCommandPool b, VkCommandPoolResetFlags c),   \
      (a, b, c))                                                                                   \
    X(DEVICE, PLAIN, ResetFences, (VkDevice a, uint32_t b, const VkFence *c), (a, b, c))           \
    X(DEVICE, PLAIN, GetSwapchainImagesKHR,                                                        \
      (VkDevice a, VkSwapchainKHR b, uint32_t * c, VkImage * d), (a, b, c, d))                     \
    X(DEVICE, WORKS, QueueSubmit, (VkQueue a, uint32_t b, const VkSubmitInfo *c, VkFence d),       \
      (a, b, c, d))                                                                                \
    X(DEVICE, WORKS, QueuePresentKHR, (VkQueue a, const VkPresentInfoKHR *b), (a, b))              \
    X(DEVICE, WORKS, AcquireNextImageKHR,                                                          \
      (VkDevice a, VkSwapchainKHR b, uint64_t c, VkSemaphore d, VkFence e, uint32_t * f),          \
      (a, b, c, d, e, f))                                                                          \
    X(DEVICE, WAITS, QueueWaitIdle, (VkQueue a), (a))                                              \
    X(DEVICE, WAITS, DeviceWaitIdle, (VkDevice a), (a))                                            \
    X(DEVICE, WAITS, WaitForFences,                                                                \
      (VkDevice a, uint32_t b, const VkFence *c, VkBool32 d, uint64_t e), (a, b, c, d, e))         \
    X(DEVICE, WAITS, GetQueryPoolResults,                                                          \
      (VkDevice a, VkQueryPool b, uint32_t c, uint32_t d, size_t e, void *f, VkDeviceSize g,       \
       VkQueryResultFlags h),                                                                      \
      (a, b, c, d, e, f, g, h))

/* One instance and one device at a time, as the tools have them. */
static PFN_vkGetInstanceProcAddr next_instance_proc;
static PFN_vkGetDeviceProcAddr next_device_proc;
static atomic_uint calls;
static atomic_bool is_lost;

/* --- The fault --- */

static void log_call(const char *name)
{
    const char *path = getenv("VKAO_FAULT_LOG");
    char line[80];
    size_t length = strlen(name);
    int fd = path ? open(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666) : -1;
    if (fd < 0)
        return;
    if (length > sizeof line - 1)
        length = sizeof line - 1;
    memcpy(line, name, length);
    line[length] = '\n';
    if (write(fd, line, length + 1) < 0)
        abort();
    close(fd);
}

/* What this call is to return; VK_SUCCESS: what it returns. */
static VkResult fault_of(const char *name, enum kind kind)
{
    const char *fault = getenv("VKAO_FAULT");
    const size_t length = strlen(name);
    log_call(name);
    if (atomic_load(&is_lost) && kind != PLAIN)
        return VK_ERROR_DEVICE_LOST;
    if (!fault || !(fault[0] == '*' || strncmp(fault, name, length) == 0))
        return VK_SUCCESS;
    const char *rest = fault + (fault[0] == '*' ? 1 : length);
    char *end;
    if (*rest != ':' || atomic_fetch_add(&calls, 1) + 1 != strtoul(rest + 1, &end, 10))
        return VK_SUCCESS;
    const VkResult result = (VkResult)strtol(end + 1, NULL, 10);
    if (result == VK_ERROR_DEVICE_LOST)
        atomic_store(&is_lost, true);
    return result;
}

/* --- The functions --- */

#define DEFINE(of, kind, name, parameters, arguments)                                              \
    static PFN_vk##name next_##name;                                                               \
    static VKAPI_ATTR VkResult VKAPI_CALL fault_##name parameters                                  \
    {                                                                                              \
        const VkResult fault = fault_of("vk" #name, kind);                                         \
        if (fault != VK_SUCCESS && kind != WAITS)                                                  \
            return fault;                                                                          \
        const VkResult result = next_##name arguments;                                             \
        return fault != VK_SUCCESS ? fault : result;                                               \
    }
FUNCTIONS(DEFINE)

/* The answers are asked for as instance and device are made: later, the loader answers with the
 * first layer of the chain. */
#define LOAD_INSTANCE(name) next_##name = (PFN_vk##name)next_instance_proc(instance, "vk" #name);
#define LOAD_DEVICE(name) next_##name = (PFN_vk##name)next_device_proc(device, "vk" #name);
#define SKIP(name)
#define LOAD_FOR_INSTANCE_INSTANCE LOAD_INSTANCE
#define LOAD_FOR_INSTANCE_DEVICE SKIP
#define LOAD_FOR_DEVICE_INSTANCE SKIP
#define LOAD_FOR_DEVICE_DEVICE LOAD_DEVICE
#define LOAD_OF_INSTANCE(of, kind, name, parameters, arguments) LOAD_FOR_INSTANCE_##of(name)
#define LOAD_OF_DEVICE(of, kind, name, parameters, arguments) LOAD_FOR_DEVICE_##of(name)

static PFN_vkCreateDevice next_CreateDevice;

static void load_instance(VkInstance instance)
{
    next_CreateDevice = (PFN_vkCreateDevice)next_instance_proc(instance, "vkCreateDevice");
    FUNCTIONS(LOAD_OF_INSTANCE)
}

static void load_device(VkDevice device)
{
    FUNCTIONS(LOAD_OF_DEVICE)
}

static VKAPI_ATTR VkResult VKAPI_CALL fault_CreateInstance(const VkInstanceCreateInfo *info,
                                                           const VkAllocationCallbacks *allocator,
                                                           VkInstance *instance)
{
    VkLayerInstanceCreateInfo *link = (VkLayerInstanceCreateInfo *)(uintptr_t)info->pNext;
    while (link && (link->sType != VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO ||
                    link->function != VK_LAYER_LINK_INFO))
        link = (VkLayerInstanceCreateInfo *)(uintptr_t)link->pNext;
    const VkResult fault = fault_of("vkCreateInstance", PLAIN);
    if (fault != VK_SUCCESS || !link)
        return fault != VK_SUCCESS ? fault : VK_ERROR_INITIALIZATION_FAILED;
    next_instance_proc = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
    link->u.pLayerInfo = link->u.pLayerInfo->pNext;
    PFN_vkCreateInstance next =
        (PFN_vkCreateInstance)next_instance_proc(VK_NULL_HANDLE, "vkCreateInstance");
    const VkResult result = next(info, allocator, instance);
    if (result == VK_SUCCESS)
        load_instance(*instance);
    return result;
}

static VKAPI_ATTR VkResult VKAPI_CALL fault_CreateDevice(VkPhysicalDevice physical_device,
                                                         const VkDeviceCreateInfo *info,
                                                         const VkAllocationCallbacks *allocator,
                                                         VkDevice *device)
{
    VkLayerDeviceCreateInfo *link = (VkLayerDeviceCreateInfo *)(uintptr_t)info->pNext;
    while (link && (link->sType != VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO ||
                    link->function != VK_LAYER_LINK_INFO))
        link = (VkLayerDeviceCreateInfo *)(uintptr_t)link->pNext;
    const VkResult fault = fault_of("vkCreateDevice", PLAIN);
    if (fault != VK_SUCCESS || !link)
        return fault != VK_SUCCESS ? fault : VK_ERROR_INITIALIZATION_FAILED;
    next_device_proc = link->u.pLayerInfo->pfnNextGetDeviceProcAddr;
    link->u.pLayerInfo = link->u.pLayerInfo->pNext;
    const VkResult result = next_CreateDevice(physical_device, info, allocator, device);
    if (result == VK_SUCCESS)
        load_device(*device);
    return result;
}

/* --- What the loader asks --- */

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_device_proc(VkDevice device, const char *name);

static PFN_vkVoidFunction own_proc(const char *name);

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_instance_proc(VkInstance instance,
                                                                  const char *name)
{
    PFN_vkVoidFunction own = own_proc(name);
    if (own || !instance)
        return own;
    return next_instance_proc(instance, name);
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_device_proc(VkDevice device, const char *name)
{
    PFN_vkVoidFunction next = next_device_proc(device, name);
    PFN_vkVoidFunction own = next ? own_proc(name) : NULL;
    return own ? own : next;
}

static PFN_vkVoidFunction own_proc(const char *name)
{
#define ROW(of, kind, function, parameters, arguments)                                             \
    {"vk" #function, (PFN_vkVoidFunction)fault_##function},
    static const struct {
        const char *name;
        PFN_vkVoidFunction function;
    } rows[] = {{"vkGetInstanceProcAddr", (PFN_vkVoidFunction)get_instance_proc},
                {"vkGetDeviceProcAddr", (PFN_vkVoidFunction)get_device_proc},
                {"vkCreateInstance", (PFN_vkVoidFunction)fault_CreateInstance},
                {"vkCreateDevice", (PFN_vkVoidFunction)fault_CreateDevice},
                FUNCTIONS(ROW)};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (strcmp(rows[i].name, name) == 0)
            return rows[i].function;
    return NULL;
}

VK_LAYER_EXPORT VKAPI_ATTR VkResult VKAPI_CALL
vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface *interface)
{
    interface->loaderLayerInterfaceVersion = 2;
    interface->pfnGetInstanceProcAddr = get_instance_proc;
    interface->pfnGetDeviceProcAddr = get_device_proc;
    interface->pfnGetPhysicalDeviceProcAddr = NULL;
    return VK_SUCCESS;
}
