/* SPDX-License-Identifier: MIT
 *
 * Staged AO: what is copied into the caller's image is what the shaders would have stored there. */
#include "fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct format {
    VkFormat format;
    const char *name;
    double step; /* by which two ways of rounding may differ */
} formats[] = {
    {VK_FORMAT_R8_UNORM, "R8", 1.0 / 255.0},
    {VK_FORMAT_R16_UNORM, "R16", 1.0 / 65535.0},
    {VK_FORMAT_R16_SFLOAT, "R16F", 0x1p-11}, /* of [.5,1] */
    {VK_FORMAT_R32_SFLOAT, "R32F", 0x1p-22}, /* what compilers may join */
};
enum { FORMATS = sizeof formats / sizeof formats[0] };

/* Bars before a wall, with windows to the sky. */
static void make(struct picture *p, uint32_t width, uint32_t height, VkFormat format, bool half)
{
    const struct scene scene = scene_fence();
    const struct lens lens = lens_perspective(0.9 * (double)width / (double)height, 0.9);
    picture_init(p, width, height, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR);
    p->view.depth_encoding = VKAO_DEPTH_VIEW_Z;
    p->view.normal_encoding = VKAO_NORMALS_XYZ_SNORM;
    picture_render_scene(p, &scene, &lens, VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT);
    for (uint32_t i = 0; width > 4 && i < width * height; ++i) {
        if ((i % width / 11 + i / width / 23) % 3 == 0)
            p->values[SLOT_DEPTH][i] = INFINITY;
    }
    picture_set(p, SLOT_AO, format, NULL);
    p->ssao.method = VKAO_SSAO_GTAO;
    p->ssao.radius = 2.0f;
    p->half_resolution = half;
    p->staged = true;
}

/* Every texel within a step of its format. */
static void check_within(const char *what, const double *a, const double *b, size_t count,
                         double step)
{
    const struct difference d = difference_of(a, b, count);
    printf("    %-40s max %.2e  mean %.2e\n", what, d.max, d.mean);
    if (!(d.max <= step * 1.0001))
        fail_msg("%s: off by up to %g, want at most %g", what, d.max, step);
}

/* There is something to agree about. */
static void check_shaded(const double *ao, size_t count)
{
    size_t between = 0;
    for (size_t i = 0; i < count; ++i)
        between += ao[i] > 0.05 && ao[i] < 0.9;
    if (between < count / 50)
        fail_msg("%zu of %zu texels are neither open nor black", between, count);
}

static double *take_ao(struct picture *p)
{
    double *ao = p->values[SLOT_AO];
    p->values[SLOT_AO] = NULL;
    picture_set(p, SLOT_AO, p->formats[SLOT_AO], NULL);
    return ao;
}

static const struct size {
    uint32_t width, height;
} sizes[] = {{201, 137}, {1, 1}, {13, 300}, {2, 7}, {64, 129}};

static void staged_ao_is_what_is_stored(void **state)
{
    (void)state;
    for (int i = 0; i < (int)(sizeof sizes / sizeof sizes[0]) * FORMATS * 2; ++i) {
        const struct size *size = &sizes[i / FORMATS / 2];
        const struct format *f = &formats[i / 2 % FORMATS];
        const bool half = i & 1;
        struct picture p;
        char what[80];
        make(&p, size->width, size->height, f->format, half);
        p.staged = false;
        picture_run(&p);
        double *stored = take_ao(&p);
        p.staged = true;
        picture_run(&p);
        snprintf(what, sizeof what, "%s, %s, %ux%u", f->name, half ? "half" : "full", size->width,
                 size->height);
        check_within(what, p.values[SLOT_AO], stored, picture_texels(&p), f->step);
        if (picture_texels(&p) > 1000)
            check_shaded(stored, picture_texels(&p));
        free(stored);
        picture_free(&p);
    }
}

/* Radii, normals and settings that other branches of the shaders end with. */
static void every_end_of_blur_is_staged(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        uint32_t radius;
        float normal_power, intensity, power;
    } rows[] = {
        {"radius 0", 0, 0.0f, 1.0f, 1.0f},
        {"radius 3, normals", 3, 8.0f, 1.0f, 1.0f},
        {"radius 16, stronger", 16, 0.0f, 1.5f, 2.0f},
        {"radius 5, clipped", 5, 3.0f, 4.0f, 1.0f},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0] * 2; ++i) {
        struct picture p;
        make(&p, 93, 150, VK_FORMAT_R32_SFLOAT, i & 1);
        p.blur.radius = rows[i / 2].radius;
        p.blur.normal_power = rows[i / 2].normal_power;
        p.blur.intensity = rows[i / 2].intensity;
        p.blur.power = rows[i / 2].power;
        p.staged = false;
        picture_run(&p);
        double *stored = take_ao(&p);
        p.staged = true;
        picture_run(&p);
        check_within(rows[i / 2].name, p.values[SLOT_AO], stored, picture_texels(&p), 0x1p-22);
        check_shaded(stored, picture_texels(&p));
        free(stored);
        picture_free(&p);
    }
}

static void rect_leaves_exterior_untouched(void **state)
{
    (void)state;
    static const VkRect2D rects[] = {
        {{7, 31}, {53, 150}}, {{1, 0}, {1, 1}},    {{33, 129}, {6, 1}},
        {{96, 5}, {1, 294}},  {{0, 171}, {97, 3}}, {{9, 3}, {85, 257}},
    };
    for (int i = 0; i < FORMATS * 2; ++i) {
        const VkFormat format = formats[i / 2].format;
        struct picture whole;
        make(&whole, 97, 300, format, i & 1);
        const double canary = whole.values[SLOT_AO][0];
        picture_run(&whole);
        for (size_t r = 0; r < sizeof rects / sizeof rects[0]; ++r) {
            struct picture part;
            make(&part, 97, 300, format, i & 1);
            part.view.rect = rects[r];
            picture_run(&part);
            picture_check_part(&part, &whole, canary, "");
            picture_free(&part);
        }
        picture_free(&whole);
    }
}

static void composite_reads_the_copy(void **state)
{
    (void)state;
    for (int i = 0; i < FORMATS * 2; ++i) {
        struct picture p;
        make(&p, 75, 140, formats[i / 2].format, i & 1);
        p.stages = VKAO_STAGE_ALL;
        p.composite.mode = VKAO_COMPOSITE_AO_ONLY;
        p.composite.strength = 1.0f;
        picture_set(&p, SLOT_OUTPUT, VK_FORMAT_R32G32B32A32_SFLOAT, NULL);
        picture_run(&p);
        double *shown = test_alloc(picture_texels(&p), sizeof *shown);
        for (size_t t = 0; t < picture_texels(&p); ++t)
            shown[t] = p.values[SLOT_OUTPUT][t * 4];
        /* Sampled, and mixed with a tint of 0: the last bits may differ. */
        check_within(formats[i / 2].name, shown, p.values[SLOT_AO], picture_texels(&p), 2e-7);
        check_shaded(shown, picture_texels(&p));
        free(shown);
        picture_free(&p);
    }
}

static void record_read_back(const struct picture *p, VkImage image, uint32_t mip, uint32_t layer,
                             VkCommandBuffer cmd, VkBuffer to)
{
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT,
                         0, 1,
                         &(VkMemoryBarrier){
                             .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                             .srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT,
                             .dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT,
                         },
                         0, NULL, 0, NULL);
    vkCmdCopyImageToBuffer(cmd, image, VK_IMAGE_LAYOUT_GENERAL, to, 1,
                           &(VkBufferImageCopy){
                               .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, mip, layer, 1},
                               .imageExtent = {p->width, p->height, 1},
                           });
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1,
                         &(VkMemoryBarrier){
                             .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                             .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                             .dstAccessMask = VK_ACCESS_HOST_READ_BIT,
                         },
                         0, NULL, 0, NULL);
}

/* Synchronization validation watches: twice in a row without a word of the caller's between, then
 * a read that waits for shader writes. */
static void waiting_for_shader_writes_waits_for_the_copy(void **state)
{
    (void)state;
    for (int half = 0; half < 2; ++half) {
        struct picture p;
        struct picture_gpu g;
        struct gpu_buffer read;
        make(&p, 96, 270, VK_FORMAT_R32_SFLOAT, half);
        picture_run(&p);
        double *once = take_ao(&p);
        const size_t bytes = picture_texels(&p) * sizeof(float);
        picture_open(&p, &g);
        check(gpu_buffer_create(&fixture.gpu, bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, &read,
                                &fixture.error));
        VkCommandBuffer cmd = gpu_begin(&fixture.gpu, &fixture.error);
        check(cmd != NULL);
        picture_record(&p, &g, cmd);
        picture_record(&p, &g, cmd);
        record_read_back(&p, g.images[SLOT_AO].image, 0, 0, cmd, read.buffer);
        check(gpu_submit(&fixture.gpu, cmd, &fixture.error));
        const float *texels = read.mapped;
        for (size_t i = 0; i < picture_texels(&p); ++i)
            p.values[SLOT_AO][i] = (double)texels[i];
        check_equal(half ? "half" : "full", p.values[SLOT_AO], once, picture_texels(&p));
        gpu_buffer_destroy(&fixture.gpu, &read);
        picture_close(&g);
        free(once);
        picture_free(&p);
    }
}

/* Level 1 and layer 2 of an image, GENERAL, of this size. */
struct deep_image {
    VkImage image;
    VkImageView view;
    VkDeviceMemory memory;
};
enum { LEVEL = 1, LAYER = 2 };

static struct deep_image make_deep(VkFormat format, uint32_t width, uint32_t height)
{
    struct deep_image out;
    VkMemoryRequirements need;
    const VkDevice device = fixture.gpu.device;
    const VkImageSubresourceRange range = {VK_IMAGE_ASPECT_COLOR_BIT, LEVEL, 1, LAYER, 1};
    const VkImageCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
        .imageType = VK_IMAGE_TYPE_2D,
        .format = format,
        .extent = {width << LEVEL, height << LEVEL, 1},
        .mipLevels = LEVEL + 1,
        .arrayLayers = LAYER + 1,
        .samples = VK_SAMPLE_COUNT_1_BIT,
        .usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
    };
    assert_int_equal(vkCreateImage(device, &info, NULL, &out.image), VK_SUCCESS);
    vkGetImageMemoryRequirements(device, out.image, &need);
    out.memory = fixture_allocate(&need, need.size);
    assert_int_equal(vkBindImageMemory(device, out.image, out.memory, 0), VK_SUCCESS);
    assert_int_equal(vkCreateImageView(device,
                                       &(VkImageViewCreateInfo){
                                           .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                           .image = out.image,
                                           .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                           .format = format,
                                           .subresourceRange = range,
                                       },
                                       NULL, &out.view),
                     VK_SUCCESS);
    VkCommandBuffer cmd = gpu_begin(&fixture.gpu, &fixture.error);
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT,
                         VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, 0, 0, NULL, 0, NULL, 1,
                         &(VkImageMemoryBarrier){
                             .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                             .dstAccessMask = VK_ACCESS_SHADER_WRITE_BIT,
                             .newLayout = VK_IMAGE_LAYOUT_GENERAL,
                             .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                             .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                             .image = out.image,
                             .subresourceRange = range,
                         });
    check(gpu_submit(&fixture.gpu, cmd, &fixture.error));
    return out;
}

/* Without ao.image a view may be of any level and layer. */
static void view_of_a_level_and_a_layer_is_written(void **state)
{
    (void)state;
    struct picture p;
    struct picture_gpu g;
    struct gpu_buffer read;
    make(&p, 96, 70, VK_FORMAT_R32_SFLOAT, false);
    p.staged = false;
    picture_run(&p);
    double *plain = take_ao(&p);
    picture_open(&p, &g);
    struct deep_image deep = make_deep(VK_FORMAT_R32_SFLOAT, p.width, p.height);
    vkao_images images = g.slots;
    images.ao.view = deep.view;
    check_vkao(vkao_frame_update(g.frame, &images));
    check(gpu_buffer_create(&fixture.gpu, picture_texels(&p) * sizeof(float),
                            VK_BUFFER_USAGE_TRANSFER_DST_BIT, &read, &fixture.error));
    VkCommandBuffer cmd = gpu_begin(&fixture.gpu, &fixture.error);
    picture_record(&p, &g, cmd);
    record_read_back(&p, deep.image, LEVEL, LAYER, cmd, read.buffer);
    check(gpu_submit(&fixture.gpu, cmd, &fixture.error));
    const float *texels = read.mapped;
    for (size_t i = 0; i < picture_texels(&p); ++i)
        p.values[SLOT_AO][i] = (double)texels[i];
    check_equal("level 1, layer 2", p.values[SLOT_AO], plain, picture_texels(&p));
    gpu_buffer_destroy(&fixture.gpu, &read);
    picture_close(&g);
    vkDestroyImageView(fixture.gpu.device, deep.view, NULL);
    vkDestroyImage(fixture.gpu.device, deep.image, NULL);
    vkFreeMemory(fixture.gpu.device, deep.memory, NULL);
    free(plain);
    picture_free(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        gpu_test(staged_ao_is_what_is_stored),
        gpu_test(every_end_of_blur_is_staged),
        gpu_test(rect_leaves_exterior_untouched),
        gpu_test(composite_reads_the_copy),
        gpu_test(waiting_for_shader_writes_waits_for_the_copy),
        gpu_test(view_of_a_level_and_a_layer_is_written),
    };
    return fixture_run(tests);
}
