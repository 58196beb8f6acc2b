/* SPDX-License-Identifier: MIT */
#include "gpu.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vulkan.h>

static const char validation_layer[] = "VK_LAYER_KHRONOS_validation";

static void hint_at_memory(struct tool_error *err)
{
    fail_hint(err, "free memory, crop or scale the image, or raise the limit ('ulimit -v')");
}

static void hint_at_driver(struct tool_error *err)
{
    fail_hint(err, "the driver gave up, perhaps for want of memory ('ulimit -v'), as the system's "
                   "log may tell; or take another with --device");
}

bool gpu_ok(struct tool_error *err, const char *call, VkResult result)
{
    if (result == VK_SUCCESS)
        return true;
    bool memory = result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_OUT_OF_DEVICE_MEMORY;
    err->ends_run = err->ends_run || result == VK_ERROR_DEVICE_LOST;
    if (memory)
        hint_at_memory(err);
    else
        hint_at_driver(err);
    return fail(err, memory ? EXIT_MEMORY : EXIT_DEVICE, "%s failed with VkResult %d", call,
                (int)result);
}

static VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                 VkDebugUtilsMessageTypeFlagsEXT types,
                                                 const VkDebugUtilsMessengerCallbackDataEXT *data,
                                                 void *user)
{
    struct gpu *gpu = user;
    (void)severity;
    (void)types;
    gpu->validation_messages++;
    if (gpu->print_validation)
        fprintf(stderr, "validation: %s\n", data->pMessage);
    return VK_FALSE;
}

static bool has_layer(const char *name)
{
    uint32_t count = 0;
    bool found = false;
    vkEnumerateInstanceLayerProperties(&count, NULL);
    VkLayerProperties *layers = calloc(count ? count : 1, sizeof *layers);
    if (layers && vkEnumerateInstanceLayerProperties(&count, layers) == VK_SUCCESS) {
        for (uint32_t i = 0; i < count; ++i)
            found = found || strcmp(layers[i].layerName, name) == 0;
    }
    free(layers);
    return found;
}

enum { MAX_INSTANCE_EXTENSIONS = 16 };

/* Those of the window system, and debug utils for validation. */
static bool list_extensions(const struct gpu_options *options,
                            const char *names[MAX_INSTANCE_EXTENSIONS], uint32_t *count,
                            struct tool_error *err)
{
    const struct gpu_presentation *p = options->presentation;
    *count = 0;
    if (p && p->instance_extension_count >= MAX_INSTANCE_EXTENSIONS)
        return fail(err, EXIT_BUG, "%u instance extensions", p->instance_extension_count);
    for (uint32_t i = 0; p && i < p->instance_extension_count; i++)
        names[(*count)++] = p->instance_extensions[i];
    if (options->validation)
        names[(*count)++] = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    return true;
}

static bool create_instance(struct gpu *gpu, const struct gpu_options *options,
                            struct tool_error *err)
{
    const bool validation = options->validation;
    const VkDebugUtilsMessengerCreateInfoEXT messenger = {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        /* Performance advice would only say that GENERAL is not the best layout to copy from. */
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
        .pfnUserCallback = on_message,
        .pUserData = gpu,
    };
    /* Core checks are on by default. Queue-submit synchronization has no enumerator in these
     * headers; the layer reads it from the environment only. */
    const VkValidationFeatureEnableEXT enables[] = {
        VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
    const VkValidationFeaturesEXT features = {
        .sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
        .pNext = &messenger,
        .enabledValidationFeatureCount = 1,
        .pEnabledValidationFeatures = enables,
    };
    const char *layers[] = {validation_layer};
    const char *extensions[MAX_INSTANCE_EXTENSIONS];
    uint32_t extension_count;
    if (!list_extensions(options, extensions, &extension_count, err))
        return false;
    if (validation && !has_layer(validation_layer)) {
        fail(err, EXIT_DEVICE, "Vulkan validation layer %s is not installed", validation_layer);
        return fail_hint(err, "install the package vulkan-validationlayers");
    }
    if (validation)
        setenv("VK_LAYER_ENABLES",
               "VALIDATION_CHECK_ENABLE_SYNCHRONIZATION_VALIDATION_QUEUE_SUBMIT", 0);
    VkResult result = vkCreateInstance(
        &(VkInstanceCreateInfo){
            .sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
            .pNext = validation ? &features : NULL,
            .pApplicationInfo =
                &(VkApplicationInfo){
                    .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                    .pApplicationName = "vkao",
                    .apiVersion = VKAO_MIN_API_VERSION,
                },
            .enabledLayerCount = validation ? 1 : 0,
            .ppEnabledLayerNames = layers,
            .enabledExtensionCount = extension_count,
            .ppEnabledExtensionNames = extensions,
        },
        NULL, &gpu->instance);
    if (result != VK_SUCCESS)
        gpu->instance = VK_NULL_HANDLE;
    if (result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_OUT_OF_DEVICE_MEMORY)
        return gpu_ok(err, "vkCreateInstance", result);
    if (result != VK_SUCCESS) {
        fail(err, EXIT_DEVICE, "no Vulkan driver could be loaded (vkCreateInstance: VkResult %d)",
             (int)result);
        return fail_hint(
            err, "install mesa-vulkan-drivers to compute on the CPU (lavapipe), or a GPU driver");
    }
    if (!validation)
        return true;
    PFN_vkCreateDebugUtilsMessengerEXT create =
        (PFN_vkCreateDebugUtilsMessengerEXT)vkGetInstanceProcAddr(gpu->instance,
                                                                  "vkCreateDebugUtilsMessengerEXT");
    result = create ? create(gpu->instance, &messenger, NULL, &gpu->messenger)
                    : VK_ERROR_EXTENSION_NOT_PRESENT;
    return gpu_ok(err, "vkCreateDebugUtilsMessengerEXT", result);
}

const char *gpu_device_type_name(VkPhysicalDeviceType type)
{
    static const char *const names[] = {"other", "integrated GPU", "discrete GPU", "virtual GPU",
                                        "CPU"};
    return (unsigned)type < sizeof names / sizeof names[0] ? names[type] : names[0];
}

static int device_score(const VkPhysicalDeviceProperties *p)
{
    static const int scores[] = {1, 4, 5, 3, 2}; /* by VkPhysicalDeviceType */
    return (unsigned)p->deviceType < sizeof scores / sizeof scores[0] ? scores[p->deviceType] : 0;
}

/* How well device i fits what was asked for; 0 = not at all. */
static int device_fits(const char *wanted, uint32_t i, const VkPhysicalDeviceProperties *p)
{
    char *end;
    if (p->apiVersion < VKAO_MIN_API_VERSION)
        return 0;
    if (!wanted || strcmp(wanted, "auto") == 0)
        return device_score(p);
    if (strcmp(wanted, "cpu") == 0)
        return p->deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
    unsigned long index = strtoul(wanted, &end, 10);
    if (end != wanted && !*end)
        return index == i;
    return strstr(p->deviceName, wanted) != NULL;
}

/* malloc'ed list of devices; NULL with the error set. */
static VkPhysicalDevice *list_devices(VkInstance instance, uint32_t *count, struct tool_error *err)
{
    VkPhysicalDevice *devices = NULL;
    VkResult result = vkEnumeratePhysicalDevices(instance, count, NULL);
    if (result == VK_SUCCESS && *count) {
        devices = calloc(*count, sizeof *devices);
        result = devices ? vkEnumeratePhysicalDevices(instance, count, devices)
                         : VK_ERROR_OUT_OF_HOST_MEMORY;
    }
    if (devices && result == VK_SUCCESS && *count)
        return devices;
    free(devices);
    if (!gpu_ok(err, "vkEnumeratePhysicalDevices", result))
        return NULL;
    fail(err, EXIT_DEVICE, "no Vulkan device: the loader found 0 physical devices");
    fail_hint(err, "install mesa-vulkan-drivers to compute on the CPU (lavapipe), or a GPU driver");
    return NULL;
}

/* The queue family to work on, UINT32_MAX if the device has none. */
static uint32_t find_family(const struct gpu *gpu, VkPhysicalDevice device,
                            const struct gpu_presentation *presentation)
{
    VkQueueFamilyProperties families[32];
    uint32_t count = 32;
    VkQueueFlags wanted = VK_QUEUE_COMPUTE_BIT | (presentation ? VK_QUEUE_GRAPHICS_BIT : 0u);
    vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families);
    for (uint32_t i = 0; i < count; ++i) {
        if ((families[i].queueFlags & wanted) == wanted &&
            (!presentation || presentation->supported(gpu->instance, device, i)))
            return i;
    }
    return UINT32_MAX;
}

static bool pick_device(struct gpu *gpu, const struct gpu_options *options, struct tool_error *err)
{
    const char *wanted = options->device;
    uint32_t count = 0;
    bool any_fits = false;
    VkPhysicalDevice *devices = list_devices(gpu->instance, &count, err);
    if (!devices)
        return false;
    int best = 0;
    for (uint32_t i = 0; i < count; ++i) {
        VkPhysicalDeviceProperties p;
        vkGetPhysicalDeviceProperties(devices[i], &p);
        int score = device_fits(wanted, i, &p);
        any_fits = any_fits || score > 0;
        /* A device without a compute queue says so later; one that cannot present is passed
         * over. */
        if (options->presentation &&
            find_family(gpu, devices[i], options->presentation) == UINT32_MAX)
            continue;
        if (score > best) {
            best = score;
            gpu->physical_device = devices[i];
            gpu->properties = p;
        }
    }
    free(devices);
    if (best)
        return true;
    if (any_fits) {
        fail(err, EXIT_DEVICE, "no Vulkan device can present on this display");
        return fail_hint(err, "vkao computes without a display");
    }
    fail(err, EXIT_DEVICE, "no Vulkan 1.1 device fits --device %s", wanted ? wanted : "auto");
    return fail_hint(err, "vkao devices lists them");
}

static bool create_device(struct gpu *gpu, const struct gpu_options *options,
                          struct tool_error *err)
{
    static const char *const swapchain[] = {VK_KHR_SWAPCHAIN_EXTENSION_NAME};
    VkQueueFamilyProperties families[32];
    uint32_t count = 32;
    vkGetPhysicalDeviceQueueFamilyProperties(gpu->physical_device, &count, families);
    gpu->queue_family = find_family(gpu, gpu->physical_device, options->presentation);
    if (gpu->queue_family == UINT32_MAX)
        return fail(err, EXIT_DEVICE, "%s has no compute queue", gpu->properties.deviceName);
    gpu->timestamp_bits = families[gpu->queue_family].timestampValidBits;
    vkGetPhysicalDeviceMemoryProperties(gpu->physical_device, &gpu->memory);
    VkPhysicalDeviceMaintenance3Properties limits = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES};
    vkGetPhysicalDeviceProperties2(
        gpu->physical_device,
        &(VkPhysicalDeviceProperties2){.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
                                       .pNext = &limits});
    gpu->max_allocation = limits.maxMemoryAllocationSize;
    VkPhysicalDevice16BitStorageFeatures storage = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_16BIT_STORAGE_FEATURES};
    VkPhysicalDeviceFeatures2 supported = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                           .pNext = &storage};
    vkGetPhysicalDeviceFeatures2(gpu->physical_device, &supported);
    if (!supported.features.shaderStorageImageWriteWithoutFormat)
        return fail(err, EXIT_DEVICE, "%s lacks shaderStorageImageWriteWithoutFormat",
                    gpu->properties.deviceName);
    gpu->storage_features = (VkPhysicalDevice16BitStorageFeatures){
        .sType = storage.sType, .storageBuffer16BitAccess = storage.storageBuffer16BitAccess};
    gpu->features = (VkPhysicalDeviceFeatures2){.sType = supported.sType};
    vkao_add_required_features(&gpu->features.features);
    VkResult result =
        vkCreateDevice(gpu->physical_device,
                       &(VkDeviceCreateInfo){
                           .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                           .pNext = &gpu->storage_features,
                           .queueCreateInfoCount = 1,
                           .pQueueCreateInfos =
                               &(VkDeviceQueueCreateInfo){
                                   .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                   .queueFamilyIndex = gpu->queue_family,
                                   .queueCount = 1,
                                   .pQueuePriorities = &(float){1.0f},
                               },
                           .enabledExtensionCount = options->presentation ? 1 : 0,
                           .ppEnabledExtensionNames = swapchain,
                           .pEnabledFeatures = &gpu->features.features,
                       },
                       NULL, &gpu->device);
    if (result != VK_SUCCESS) {
        gpu->device = VK_NULL_HANDLE;
        return gpu_ok(err, "vkCreateDevice", result);
    }
    vkGetDeviceQueue(gpu->device, gpu->queue_family, 0, &gpu->queue);
    result = vkCreateCommandPool(gpu->device,
                                 &(VkCommandPoolCreateInfo){
                                     .sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                     .flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT,
                                     .queueFamilyIndex = gpu->queue_family,
                                 },
                                 NULL, &gpu->command_pool);
    return gpu_ok(err, "vkCreateCommandPool", result);
}

bool gpu_create(const struct gpu_options *options, struct gpu *gpu, struct tool_error *err)
{
    *gpu = (struct gpu){.print_validation = true};
    if (create_instance(gpu, options, err) && pick_device(gpu, options, err) &&
        create_device(gpu, options, err))
        return true;
    gpu_destroy(gpu);
    return false;
}

void gpu_destroy(struct gpu *gpu)
{
    if (gpu->command_pool)
        vkDestroyCommandPool(gpu->device, gpu->command_pool, NULL);
    if (gpu->device)
        vkDestroyDevice(gpu->device, NULL);
    if (gpu->messenger) {
        PFN_vkDestroyDebugUtilsMessengerEXT destroy =
            (PFN_vkDestroyDebugUtilsMessengerEXT)vkGetInstanceProcAddr(
                gpu->instance, "vkDestroyDebugUtilsMessengerEXT");
        if (destroy)
            destroy(gpu->instance, gpu->messenger, NULL);
    }
    if (gpu->instance)
        vkDestroyInstance(gpu->instance, NULL);
    uint32_t messages = gpu->validation_messages;
    *gpu = (struct gpu){.validation_messages = messages};
}

bool gpu_list_devices(struct gpu_device_list *list, struct tool_error *err)
{
    struct gpu gpu = {0};
    *list = (struct gpu_device_list){0};
    const struct gpu_options compute = {0};
    bool ok = create_instance(&gpu, &compute, err);
    VkPhysicalDevice *devices = ok ? list_devices(gpu.instance, &list->count, err) : NULL;
    if (devices)
        list->properties = calloc(list->count, sizeof *list->properties);
    if (devices && !list->properties)
        fail(err, EXIT_MEMORY, "out of memory");
    for (uint32_t i = 0; list->properties && i < list->count; ++i)
        vkGetPhysicalDeviceProperties(devices[i], &list->properties[i]);
    free(devices);
    gpu_destroy(&gpu);
    return list->properties != NULL;
}

void gpu_device_list_free(struct gpu_device_list *list)
{
    free(list->properties);
    *list = (struct gpu_device_list){0};
}

uint32_t gpu_format_bytes(VkFormat format)
{
    switch (format) {
    case VK_FORMAT_R8_UNORM:
        return 1;
    case VK_FORMAT_R8G8_UNORM:
    case VK_FORMAT_R8G8_SNORM:
    case VK_FORMAT_R16_UNORM:
    case VK_FORMAT_R16_SFLOAT:
    case VK_FORMAT_D16_UNORM:
        return 2;
    case VK_FORMAT_R8G8B8A8_UNORM:
    case VK_FORMAT_R8G8B8A8_SNORM:
    case VK_FORMAT_A2B10G10R10_UNORM_PACK32:
    case VK_FORMAT_R16G16_UNORM:
    case VK_FORMAT_R16G16_SNORM:
    case VK_FORMAT_R16G16_SFLOAT:
    case VK_FORMAT_R32_SFLOAT:
    case VK_FORMAT_D32_SFLOAT:
    case VK_FORMAT_X8_D24_UNORM_PACK32:
        return 4;
    case VK_FORMAT_R16G16B16A16_SFLOAT:
    case VK_FORMAT_R16G16B16A16_SNORM:
    case VK_FORMAT_R16G16B16A16_UNORM:
    case VK_FORMAT_R32G32_SFLOAT:
        return 8;
    case VK_FORMAT_R32G32B32A32_SFLOAT:
        return 16;
    default:
        return 0;
    }
}

static void print_log(void *user_data, vkao_log_level level, const char *message)
{
    (void)user_data;
    (void)level;
    fprintf(stderr, "vkao: %s\n", message);
}

bool gpu_library_failed(struct tool_error *err, const char *call, vkao_result result)
{
    enum exit_code code = EXIT_DEVICE;
    if (result == VKAO_ERROR_OUT_OF_HOST_MEMORY || result == VKAO_ERROR_OUT_OF_DEVICE_MEMORY) {
        code = EXIT_MEMORY;
        hint_at_memory(err);
    } else if (result == VKAO_ERROR_INVALID_ARGUMENT) {
        code = EXIT_CHANNELS; /* options were checked before: it is what the file says */
    } else if ((int)result <= (int)VKAO_ERROR_VULKAN) {
        err->ends_run |= (int)result == (int)VKAO_ERROR_VULKAN + (int)VK_ERROR_DEVICE_LOST;
        hint_at_driver(err);
    }
    return fail(err, code, "%s: %s", call, vkao_result_string(result));
}

/* A trial override: with VKAO_PATH=images a CPU says that it is a GPU, and gets the passes that
 * GPUs get. */
static VKAPI_ATTR void VKAPI_CALL properties_of_gpu(VkPhysicalDevice device,
                                                    VkPhysicalDeviceProperties *out)
{
    vkGetPhysicalDeviceProperties(device, out);
    out->deviceType = VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU;
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL instance_function(VkInstance instance,
                                                                  const char *name)
{
    const char *path = getenv("VKAO_PATH");
    if (path && strcmp(path, "images") == 0 && strcmp(name, "vkGetPhysicalDeviceProperties") == 0)
        return (PFN_vkVoidFunction)properties_of_gpu;
    return vkGetInstanceProcAddr(instance, name);
}

vkao_context_info gpu_context_info(struct gpu *gpu)
{
    vkao_context_info info = vkao_context_info_default();
    info.instance = gpu->instance;
    info.physical_device = gpu->physical_device;
    info.device = gpu->device;
    info.get_instance_proc_addr = instance_function;
    info.get_device_proc_addr = vkGetDeviceProcAddr;
    gpu->features.pNext = &gpu->storage_features;
    info.enabled_features = &gpu->features;
    info.log = print_log;
    info.debug_labels = gpu->messenger != VK_NULL_HANDLE;
    return info;
}

vkao_context *gpu_context_create(const vkao_context_info *info, struct tool_error *err)
{
    vkao_context *ctx = NULL;
    vkao_result result = vkao_context_create(info, &ctx);
    if (result != VKAO_SUCCESS)
        gpu_library_failed(err, "vkao_context_create", result);
    return ctx;
}

vkao_context *gpu_context(struct gpu *gpu, struct tool_error *err)
{
    const vkao_context_info info = gpu_context_info(gpu);
    return gpu_context_create(&info, err);
}
