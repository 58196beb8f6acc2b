/* SPDX-License-Identifier: MIT
 *
 * An engine with vkao in it. Each frame a render pass draws depth and normals of a box on a floor,
 * vkao makes ambient occlusion of them in the same command buffer, and a copy brings it home. Two
 * frames are in flight, on one depth image; the barriers are all that this needs.
 *
 *   glslangValidator -V --target-env vulkan1.1 --variable-name box_vert -o box_vert.h box.vert
 *   glslangValidator -V --target-env vulkan1.1 --variable-name box_frag -o box_frag.h box.frag
 *   cc example.c $(pkg-config --cflags --libs vkao vulkan) -lm -o example
 */
#include "plumbing.h"

#include <math.h>
#include <string.h>
#include <vkao.h>

static const VkPipelineStageFlags compute = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                                  transfer = VK_PIPELINE_STAGE_TRANSFER_BIT,
                                  drawing = VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT |
                                            VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT |
                                            VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT;
static void print_log(void *user_data, vkao_log_level level, const char *message)
{
    (void)user_data;
    fprintf(stderr, "vkao: %s%s\n", level == VKAO_LOG_ERROR ? "error: " : "", message);
}

/* Instance, device with the features that vkao wants, and the context. */
static vkao_context *create_device(VkInstance *instance)
{
    uint32_t one = 1;
    VkPhysicalDeviceFeatures2 features = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
    VkApplicationInfo application = {VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                     .apiVersion = VKAO_MIN_API_VERSION};
    CHECK(vkCreateInstance(&(VkInstanceCreateInfo){VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                                   .pApplicationInfo = &application},
                           NULL, instance));
    if (vkEnumeratePhysicalDevices(*instance, &one, &physical_device) < 0 || !one)
        check(VK_ERROR_INITIALIZATION_FAILED, "vkEnumeratePhysicalDevices");
    /* Family 0 draws and computes wherever there are drivers for desktops. */
    VkDeviceQueueCreateInfo queue = {VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, .queueCount = 1,
                                     .pQueuePriorities = &(float){1.0f}};
    vkao_add_required_features(&features.features);
    CHECK(vkCreateDevice(physical_device,
                         &(VkDeviceCreateInfo){VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, &features,
                                               .queueCreateInfoCount = 1,
                                               .pQueueCreateInfos = &queue},
                         NULL, &device));
    vkao_context_info info = vkao_context_info_default();
    info.instance = *instance;
    info.physical_device = physical_device;
    info.device = device;
    info.get_instance_proc_addr = vkGetInstanceProcAddr;
    info.get_device_proc_addr = vkGetDeviceProcAddr;
    info.enabled_features = &features;
    info.log = print_log;
    vkao_context *out;
    CHECK(vkao_context_create(&info, &out));
    return out;
}

/* Draws normals and depth, and leaves them as vkao reads them. */
static VkRenderPass create_render_pass(void)
{
    const VkAccessFlags written =
        VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
    const VkSubpassDependency dependencies[] = {
        /* vkao has read the images of the frame before -> they are drawn over */
        {VK_SUBPASS_EXTERNAL, 0, compute, drawing, 0, written, 0},
        /* they are drawn -> vkao reads them */
        {0, VK_SUBPASS_EXTERNAL, drawing, compute, written, VK_ACCESS_SHADER_READ_BIT, 0},
    };
    const VkAttachmentDescription attachments[] = {
        {0, VK_FORMAT_R16G16B16A16_SFLOAT, VK_SAMPLE_COUNT_1_BIT, VK_ATTACHMENT_LOAD_OP_CLEAR,
         VK_ATTACHMENT_STORE_OP_STORE, VK_ATTACHMENT_LOAD_OP_DONT_CARE,
         VK_ATTACHMENT_STORE_OP_DONT_CARE, VK_IMAGE_LAYOUT_UNDEFINED,
         VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL},
        {0, VK_FORMAT_D32_SFLOAT, VK_SAMPLE_COUNT_1_BIT, VK_ATTACHMENT_LOAD_OP_CLEAR,
         VK_ATTACHMENT_STORE_OP_STORE, VK_ATTACHMENT_LOAD_OP_DONT_CARE,
         VK_ATTACHMENT_STORE_OP_DONT_CARE, VK_IMAGE_LAYOUT_UNDEFINED,
         VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL},
    };
    const VkAttachmentReference color = {0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL},
                                depth = {1, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
    const VkSubpassDescription subpass = {
        .colorAttachmentCount = 1, .pColorAttachments = &color, .pDepthStencilAttachment = &depth};
    VkRenderPass out;
    CHECK(vkCreateRenderPass(device,
                             &(VkRenderPassCreateInfo){VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                                       NULL, 0, 2, attachments, 1, &subpass, 2,
                                                       dependencies},
                             NULL, &out));
    return out;
}

/* For a camera that looks down upon the box. */
struct camera {
    float projection[16], world_to_view[16];
};

static struct camera camera_at(float angle)
{
    const float near = 0.1f, scale = 1.6f, c = cosf(angle), s = sinf(angle), down = 0.45f;
    const float cd = cosf(down), sd = sinf(down);
    /* Reversed depth without a far plane: near is 1, the background 0. +y is up, as in OpenGL. */
    return (struct camera){
        {scale * HEIGHT / WIDTH, 0, 0, 0, 0, -scale, 0, 0, 0, 0, 0, -1, 0, 0, near, 0},
        {c, sd * s, -cd * s, 0, 0, cd, sd, 0, s, -sd * c, cd * c, 0, 0, -0.4f, -4.5f, 1}};
}

/* What one frame records: draw, vkao, copy. */
struct engine {
    VkRenderPass pass;
    VkFramebuffer framebuffer;
    VkPipelineLayout layout;
    VkPipeline pipeline;
    struct image depth, normals, ao;
    vkao_context *context;
    vkao_effect *effect;
    vkao_frame *frame;
    struct buffer result; /* IN_FLIGHT images of AO */
};

static void draw(const struct engine *e, VkCommandBuffer cmd, const struct camera *camera)
{
    const VkClearValue clear[2] = {0}; /* depth 0 is the background */
    const VkRenderPassBeginInfo info = {VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                        NULL,
                                        e->pass,
                                        e->framebuffer,
                                        {{0, 0}, {WIDTH, HEIGHT}},
                                        2,
                                        clear};
    vkCmdBeginRenderPass(cmd, &info, VK_SUBPASS_CONTENTS_INLINE);
    vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, e->pipeline);
    vkCmdPushConstants(cmd, e->layout, VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof *camera, camera);
    vkCmdDraw(cmd, 36, 2, 0, 0);
    vkCmdEndRenderPass(cmd);
}

static void occlude(const struct engine *e, VkCommandBuffer cmd, const struct camera *camera)
{
    /* The copy of the frame before has read AO -> vkao writes it anew. */
    const VkImageMemoryBarrier discard = {
        VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
        .dstAccessMask = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT,
        .oldLayout = VK_IMAGE_LAYOUT_UNDEFINED,
        .newLayout = VK_IMAGE_LAYOUT_GENERAL,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = e->ao.image,
        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    vkCmdPipelineBarrier(cmd, transfer, compute | transfer, 0, 0, NULL, 0, NULL, 1, &discard);
    vkao_view view = vkao_view_default();
    memcpy(view.projection, camera->projection, sizeof view.projection);
    vkao_params params = vkao_params_default();
    params.radius = 1.0f; /* of the scene's units: the box is 1.4 high */
    CHECK(vkao_cmd_record(e->frame, cmd, &view, &params));
}

static void read_back(const struct engine *e, VkCommandBuffer cmd, VkDeviceSize offset)
{
    /* vkao has written AO -> the copy reads it */
    const VkMemoryBarrier written = {VK_STRUCTURE_TYPE_MEMORY_BARRIER, NULL,
                                     VK_ACCESS_SHADER_WRITE_BIT, VK_ACCESS_TRANSFER_READ_BIT};
    vkCmdPipelineBarrier(cmd, compute, transfer, 0, 1, &written, 0, NULL, 0, NULL);
    vkCmdCopyImageToBuffer(
        cmd, e->ao.image, VK_IMAGE_LAYOUT_GENERAL, e->result.buffer, 1,
        &(VkBufferImageCopy){
            offset, 0, 0, {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1}, {0, 0, 0}, {WIDTH, HEIGHT, 1}});
    /* the copy has written the buffer -> the host reads it, after the fence */
    const VkMemoryBarrier copied = {VK_STRUCTURE_TYPE_MEMORY_BARRIER, NULL,
                                    VK_ACCESS_TRANSFER_WRITE_BIT, VK_ACCESS_HOST_READ_BIT};
    vkCmdPipelineBarrier(cmd, transfer, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &copied, 0, NULL, 0,
                         NULL);
}

static void create_vkao(struct engine *e)
{
    vkao_effect_info settings = vkao_effect_info_default();
    settings.normal_encoding = VKAO_NORMALS_XYZ_SNORM; /* in view space, any length */
    CHECK(vkao_effect_create(e->context, &settings, &e->effect));
    vkao_images images = vkao_images_default();
    images.depth = (vkao_image){e->depth.view, VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL,
                                VK_FORMAT_D32_SFLOAT, VK_NULL_HANDLE};
    images.normals = (vkao_image){e->normals.view, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                                  VK_FORMAT_R16G16B16A16_SFLOAT, VK_NULL_HANDLE};
    images.ao = (vkao_image){e->ao.view, VK_IMAGE_LAYOUT_GENERAL, VK_FORMAT_R8_UNORM, e->ao.image};
    vkao_frame_info info = vkao_frame_info_default();
    info.extent = (VkExtent2D){WIDTH, HEIGHT};
    info.images = &images;
    CHECK(vkao_frame_create(e->effect, &info, &e->frame));
}

static void create_engine(struct engine *e)
{
    e->depth =
        create_image(VK_FORMAT_D32_SFLOAT,
                     VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT,
                     VK_IMAGE_ASPECT_DEPTH_BIT);
    e->normals = create_image(VK_FORMAT_R16G16B16A16_SFLOAT,
                              VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT,
                              VK_IMAGE_ASPECT_COLOR_BIT);
    e->ao = create_image(VK_FORMAT_R8_UNORM,
                         VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                             VK_IMAGE_USAGE_TRANSFER_DST_BIT,
                         VK_IMAGE_ASPECT_COLOR_BIT);
    e->pass = create_render_pass();
    CHECK(vkCreateFramebuffer(
        device,
        &(VkFramebufferCreateInfo){VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO, NULL, 0, e->pass, 2,
                                   (VkImageView[]){e->normals.view, e->depth.view}, WIDTH, HEIGHT,
                                   1},
        NULL, &e->framebuffer));
    CHECK(vkCreatePipelineLayout(
        device,
        &(VkPipelineLayoutCreateInfo){
            VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO, .pushConstantRangeCount = 1,
            .pPushConstantRanges =
                &(VkPushConstantRange){VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof(struct camera)}},
        NULL, &e->layout));
    e->pipeline = create_pipeline(e->pass, e->layout);
    create_vkao(e);
}

static void destroy_engine(struct engine *e)
{
    vkao_frame_destroy(e->frame);
    vkao_effect_destroy(e->effect);
    vkao_context_destroy(e->context);
    vkDestroyPipeline(device, e->pipeline, NULL);
    vkDestroyPipelineLayout(device, e->layout, NULL);
    vkDestroyFramebuffer(device, e->framebuffer, NULL);
    vkDestroyRenderPass(device, e->pass, NULL);
    destroy_image(e->depth);
    destroy_image(e->normals);
    destroy_image(e->ao);
    destroy_buffer(e->result);
}

static void print_result(const unsigned char *ao)
{
    unsigned sum = 0, least = 255;
    for (int i = 0; i < WIDTH * HEIGHT; ++i) {
        sum += ao[i];
        least = ao[i] < least ? ao[i] : least;
    }
    printf("mean %.4f, minimum %.4f\n", sum / 255.0 / (WIDTH * HEIGHT), least / 255.0);
}

int main(void)
{
    enum { FRAMES = 15 };
    const VkDeviceSize bytes = (VkDeviceSize)WIDTH * HEIGHT;
    VkInstance instance;
    struct engine e = {.context = create_device(&instance)};
    create_engine(&e);
    e.result = create_buffer(bytes * IN_FLIGHT);
    struct commands commands = create_commands();

    for (int n = 0; n < FRAMES; ++n) {
        const int i = n % IN_FLIGHT;
        const struct camera camera = camera_at(0.05f * (float)n);
        VkCommandBuffer cmd = begin(&commands, i);
        draw(&e, cmd, &camera);
        occlude(&e, cmd, &camera);
        read_back(&e, cmd, bytes * (VkDeviceSize)i);
        submit(&commands, i);
    }
    CHECK(vkQueueWaitIdle(commands.queue));
    print_result((unsigned char *)e.result.mapped + bytes * ((FRAMES - 1) % IN_FLIGHT));

    destroy_commands(commands);
    destroy_engine(&e);
    vkDestroyDevice(device, NULL);
    vkDestroyInstance(instance, NULL);
    return EXIT_SUCCESS;
}
