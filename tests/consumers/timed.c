/* SPDX-License-Identifier: MIT
 *
 * An engine that has nothing but the README's lines, timed on the room of vkao-bench:
 *
 *   cc timed.c $(pkg-config --cflags --libs vkao vulkan) -o timed
 *   timed room [16bit]
 *
 * reads room_z32.npy and room_n8.npy, which vkao-bench speed --dump room writes, and prints the
 * median as --vs reads it. 16bit: the device has storageBuffer16BitAccess enabled. C and C++. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <vkao.h>
#include <vulkan/vulkan.h>

enum { RUNS = 9, WARM = 3 };
#define CHECK(call) check(call, #call)

static VkPhysicalDevice physical_device;
static VkDevice device;
static VkQueue queue;
static VkCommandBuffer cmd;
static VkExtent2D extent;

static void check(int result, const char *call)
{
    if (result) {
        fprintf(stderr, "%s: %d\n", call, result);
        exit(EXIT_FAILURE);
    }
}

/* --- The room --- */

/* The numbers of an .npy file of height x width values of 4 bytes; sets extent. */
static void *read_npy(const char *prefix, const char *suffix)
{
    char path[512], header[256] = "";
    unsigned char start[10];
    const char *shape;
    snprintf(path, sizeof path, "%s%s", prefix, suffix);
    FILE *file = fopen(path, "rb");
    if (!file || fread(start, 1, sizeof start, file) != sizeof start)
        check(1, path);
    const size_t length = start[8] + 256u * start[9];
    check(length >= sizeof header || fread(header, 1, length, file) != length, path);
    shape = strstr(header, "'shape': (");
    check(!shape || sscanf(shape, "'shape': (%u, %u)", &extent.height, &extent.width) != 2, path);
    const size_t bytes = (size_t)extent.width * extent.height * 4;
    void *out = malloc(bytes);
    check(!out || fread(out, 1, bytes, file) != bytes, path);
    fclose(file);
    return out;
}

/* --- What every engine has --- */

static void create_device(VkInstance *instance, VkPhysicalDeviceFeatures2 *features)
{
    uint32_t one = 1;
    const float priority = 1;
    VkApplicationInfo application;
    VkInstanceCreateInfo instance_info;
    VkDeviceQueueCreateInfo queue_info;
    VkDeviceCreateInfo info;
    memset(&application, 0, sizeof application);
    memset(&instance_info, 0, sizeof instance_info);
    memset(&queue_info, 0, sizeof queue_info);
    memset(&info, 0, sizeof info);
    application.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
    application.apiVersion = VKAO_MIN_API_VERSION;
    instance_info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
    instance_info.pApplicationInfo = &application;
    CHECK(vkCreateInstance(&instance_info, NULL, instance));
    check(vkEnumeratePhysicalDevices(*instance, &one, &physical_device) < 0 || !one, "no device");
    queue_info.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
    queue_info.queueCount = 1;
    queue_info.pQueuePriorities = &priority;
    vkao_add_required_features(&features->features);
    info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
    info.pNext = features;
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queue_info;
    CHECK(vkCreateDevice(physical_device, &info, NULL, &device));
    vkGetDeviceQueue(device, 0, 0, &queue);
}

static vkao_context *create_context(VkInstance instance, const VkPhysicalDeviceFeatures2 *features)
{
    vkao_context_info info = vkao_context_info_default();
    vkao_context *out;
    info.instance = instance;
    info.physical_device = physical_device;
    info.device = device;
    info.get_instance_proc_addr = vkGetInstanceProcAddr;
    info.get_device_proc_addr = vkGetDeviceProcAddr;
    info.enabled_features = features;
    CHECK(vkao_context_create(&info, &out));
    return out;
}

static VkDeviceMemory allocate(VkMemoryRequirements need, VkMemoryPropertyFlags flags)
{
    VkPhysicalDeviceMemoryProperties memory;
    VkMemoryAllocateInfo info = {VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, NULL, need.size, 0};
    VkDeviceMemory out;
    vkGetPhysicalDeviceMemoryProperties(physical_device, &memory);
    while (!(need.memoryTypeBits >> info.memoryTypeIndex & 1u) ||
           (memory.memoryTypes[info.memoryTypeIndex].propertyFlags & flags) != flags)
        ++info.memoryTypeIndex;
    CHECK(vkAllocateMemory(device, &info, NULL, &out));
    return out;
}

static VkImage create_image(VkFormat format, VkImageUsageFlags usage, VkImageView *view)
{
    VkImageCreateInfo info;
    VkImageViewCreateInfo view_info;
    VkMemoryRequirements need;
    VkImage out;
    memset(&info, 0, sizeof info);
    memset(&view_info, 0, sizeof view_info);
    info.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = format;
    info.extent.width = extent.width;
    info.extent.height = extent.height;
    info.extent.depth = info.mipLevels = info.arrayLayers = 1;
    info.usage = usage;
    info.samples = VK_SAMPLE_COUNT_1_BIT;
    CHECK(vkCreateImage(device, &info, NULL, &out));
    vkGetImageMemoryRequirements(device, out, &need);
    CHECK(vkBindImageMemory(device, out, allocate(need, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT), 0));
    view_info.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
    view_info.image = out;
    view_info.viewType = VK_IMAGE_VIEW_TYPE_2D;
    view_info.format = format;
    view_info.subresourceRange.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT;
    view_info.subresourceRange.levelCount = view_info.subresourceRange.layerCount = 1;
    CHECK(vkCreateImageView(device, &view_info, NULL, view));
    return out;
}

static VkCommandBuffer create_commands(void)
{
    VkCommandPoolCreateInfo pool_info = {VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO, NULL,
                                         VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT, 0};
    VkCommandPool pool;
    CHECK(vkCreateCommandPool(device, &pool_info, NULL, &pool));
    VkCommandBufferAllocateInfo info = {VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, NULL, pool,
                                        VK_COMMAND_BUFFER_LEVEL_PRIMARY, 1};
    VkCommandBuffer out;
    CHECK(vkAllocateCommandBuffers(device, &info, &out));
    return out;
}

static void begin(void)
{
    VkCommandBufferBeginInfo info;
    memset(&info, 0, sizeof info);
    info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
    CHECK(vkBeginCommandBuffer(cmd, &info));
}

static void finish(void)
{
    VkSubmitInfo info;
    memset(&info, 0, sizeof info);
    info.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
    info.commandBufferCount = 1;
    info.pCommandBuffers = &cmd;
    CHECK(vkEndCommandBuffer(cmd));
    CHECK(vkQueueSubmit(queue, 1, &info, VK_NULL_HANDLE));
    CHECK(vkQueueWaitIdle(queue));
}

static void to_layout(VkImage image, VkImageLayout before, VkImageLayout after)
{
    const VkAccessFlags all = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
    VkImageMemoryBarrier barrier;
    memset(&barrier, 0, sizeof barrier);
    barrier.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER;
    barrier.srcAccessMask = barrier.dstAccessMask = all;
    barrier.oldLayout = before;
    barrier.newLayout = after;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image;
    barrier.subresourceRange.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT;
    barrier.subresourceRange.levelCount = barrier.subresourceRange.layerCount = 1;
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                         VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, NULL, 0, NULL, 1, &barrier);
}

static VkImageView upload(VkFormat format, const void *values)
{
    const VkDeviceSize bytes = (VkDeviceSize)extent.width * extent.height * 4;
    VkBufferCreateInfo info;
    VkMemoryRequirements need;
    VkBufferImageCopy copy;
    VkBuffer buffer;
    VkImageView view;
    void *mapped;
    memset(&info, 0, sizeof info);
    memset(&copy, 0, sizeof copy);
    const VkImage image =
        create_image(format, VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT, &view);
    info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
    info.size = bytes;
    info.usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT;
    CHECK(vkCreateBuffer(device, &info, NULL, &buffer));
    vkGetBufferMemoryRequirements(device, buffer, &need);
    VkDeviceMemory memory =
        allocate(need, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    CHECK(vkBindBufferMemory(device, buffer, memory, 0));
    CHECK(vkMapMemory(device, memory, 0, VK_WHOLE_SIZE, 0, &mapped));
    memcpy(mapped, values, bytes);
    copy.imageSubresource.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT;
    copy.imageSubresource.layerCount = 1;
    copy.imageExtent.width = extent.width;
    copy.imageExtent.height = extent.height;
    copy.imageExtent.depth = 1;
    begin();
    to_layout(image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    vkCmdCopyBufferToImage(cmd, buffer, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy);
    to_layout(image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
              VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
    finish();
    return view;
}

/* --- vkao --- */

static vkao_frame *create_frame(const vkao_context *context, VkImageView depth_view,
                                VkImageView normals_view, VkImage ao_image, VkImageView ao_view)
{
    vkao_effect *effect;
    vkao_frame *frame;
    vkao_effect_info settings = vkao_effect_info_default();
    settings.depth_encoding = VKAO_DEPTH_VIEW_Z;
    settings.normal_encoding = VKAO_NORMALS_XYZ_SNORM;
    CHECK(vkao_effect_create(context, &settings, &effect));
    const vkao_image depth = {depth_view, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                              VK_FORMAT_R32_SFLOAT, VK_NULL_HANDLE};
    const vkao_image normals = {normals_view, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                                VK_FORMAT_R8G8B8A8_SNORM, VK_NULL_HANDLE};
    const vkao_image ao = {ao_view, VK_IMAGE_LAYOUT_GENERAL, VK_FORMAT_R8_UNORM, ao_image};
    vkao_images images = vkao_images_default();
    images.depth = depth;
    images.normals = normals;
    images.ao = ao;
    vkao_frame_info info = vkao_frame_info_default();
    info.extent = extent;
    info.images = &images;
    CHECK(vkao_frame_create(effect, &info, &frame));
    return frame;
}

static double time_ms(const vkao_frame *frame, VkQueryPool pool, double period)
{
    uint64_t ticks[2];
    vkao_view view = vkao_view_default();
    /* 60 degrees across; the camera looks along +z. */
    view.projection[0] = 1.7320508f;
    view.projection[5] = -1.7320508f * (float)extent.width / (float)extent.height;
    view.projection[10] = 100 / 99.9f;
    view.projection[11] = 1;
    view.projection[14] = -10 / 99.9f;
    vkao_params params = vkao_params_default();
    begin();
    vkCmdResetQueryPool(cmd, pool, 0, 2);
    vkCmdWriteTimestamp(cmd, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, pool, 0);
    CHECK(vkao_cmd_record(frame, cmd, &view, &params));
    vkCmdWriteTimestamp(cmd, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, pool, 1);
    finish();
    CHECK(vkGetQueryPoolResults(device, pool, 0, 2, sizeof ticks, ticks, sizeof ticks[0],
                                VK_QUERY_RESULT_64_BIT));
    return (double)(ticks[1] - ticks[0]) * period / 1e6;
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

int main(int argc, char **argv)
{
    const int is_16bit = argc == 3 && strcmp(argv[2], "16bit") == 0;
    double ms[RUNS];
    VkInstance instance;
    VkPhysicalDevice16BitStorageFeatures storage;
    VkPhysicalDeviceFeatures2 features;
    VkPhysicalDeviceProperties properties;
    VkQueryPoolCreateInfo query;
    VkQueryPool pool;
    VkImageView ao_view;
    memset(&storage, 0, sizeof storage);
    memset(&features, 0, sizeof features);
    memset(&query, 0, sizeof query);
    check(argc < 2 || (argc == 3 && !is_16bit), "usage: timed PREFIX [16bit]");
    void *depth = read_npy(argv[1], "_z32.npy"), *normals = read_npy(argv[1], "_n8.npy");
    features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
    storage.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_16BIT_STORAGE_FEATURES;
    storage.storageBuffer16BitAccess = VK_TRUE;
    if (is_16bit)
        features.pNext = &storage;
    create_device(&instance, &features);
    vkGetPhysicalDeviceProperties(physical_device, &properties);
    vkao_context *context = create_context(instance, &features);
    cmd = create_commands();
    VkImageView depth_view = upload(VK_FORMAT_R32_SFLOAT, depth),
                normals_view = upload(VK_FORMAT_R8G8B8A8_SNORM, normals);
    VkImage ao = create_image(VK_FORMAT_R8_UNORM,
                              VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT |
                                  VK_IMAGE_USAGE_TRANSFER_DST_BIT,
                              &ao_view);
    const vkao_frame *frame = create_frame(context, depth_view, normals_view, ao, ao_view);
    begin();
    to_layout(ao, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL);
    finish();
    query.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO;
    query.queryType = VK_QUERY_TYPE_TIMESTAMP;
    query.queryCount = 2;
    CHECK(vkCreateQueryPool(device, &query, NULL, &pool));
    for (int i = -WARM; i < RUNS; ++i) {
        const double t = time_ms(frame, pool, (double)properties.limits.timestampPeriod);
        if (i >= 0)
            ms[i] = t;
    }
    qsort(ms, RUNS, sizeof ms[0], compare);
    printf("readme%s med %.3f ms\n", is_16bit ? "-16bit" : "", ms[RUNS / 2]);
    /* The process ends here: what it made goes with it. */
    free(depth);
    free(normals);
    return EXIT_SUCCESS;
}
