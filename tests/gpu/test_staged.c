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

/* Scratch in buffers, whatever the device is; in the fixture's place. */
static vkao_context *fixtures_own;

static void use_context(const vkao_variant *variant)
{
    vkao_context_info info = fixture_context_info();
    vkao_context *context = NULL;
    info.scratch_layout = VKAO_SCRATCH_BUFFERS;
    info.variants = variant;
    info.variant_count = variant ? 1 : 0;
    info.variants_only = variant ? VK_TRUE : VK_FALSE;
    check_vkao(vkao_context_create(&info, &context));
    fixtures_own = fixture.context;
    fixture.context = context;
}

static void give_back(void)
{
    vkao_context_destroy(fixture.context);
    fixture.context = fixtures_own;
}

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
    use_context(NULL);
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
    give_back();
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
    use_context(NULL);
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
    give_back();
}

static void rect_leaves_exterior_untouched(void **state)
{
    (void)state;
    static const VkRect2D rects[] = {
        {{7, 31}, {53, 150}}, {{1, 0}, {1, 1}},    {{33, 129}, {6, 1}},
        {{96, 5}, {1, 294}},  {{0, 171}, {97, 3}}, {{9, 3}, {85, 257}},
    };
    use_context(NULL);
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
    give_back();
}

static void composite_reads_the_copy(void **state)
{
    (void)state;
    use_context(NULL);
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
    give_back();
}

static void variant_of_the_format_is_found(void **state)
{
    (void)state;
    for (int i = 0; i < FORMATS * 2; ++i) {
        const struct format *f = &formats[i / 2];
        struct picture p;
        make(&p, 67, 135, f->format, i & 1);
        const vkao_variant variant = {
            .struct_size = sizeof variant,
            .half_resolution = p.half_resolution,
            .staged_ao = f->format,
            .view = &p.view,
            .ssao = &p.ssao,
            .blur = &p.blur,
        };
        use_context(NULL);
        picture_run(&p);
        give_back();
        double *general = take_ao(&p);
        use_context(&variant); /* refuses all that it has no variant for */
        picture_run(&p);
        give_back();
        check_close(f->name, p.values[SLOT_AO], general, picture_texels(&p), f->step / 2 + 1e-5,
                    f->step + 2e-3);
        check_shaded(general, picture_texels(&p));
        free(general);
        picture_free(&p);
    }
}

/* --- Order --- */

/* A level of a layer, of the picture's extent, after waiting for shader writes alone. */
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
    use_context(NULL);
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
    give_back();
}

/* --- Levels and layers --- */

enum { LEVEL = 1, LEVELS = 2, LAYER = 2, LAYERS = 3 };
static const VkImageSubresourceRange all_of_it = {VK_IMAGE_ASPECT_COLOR_BIT, 0, LEVELS, 0, LAYERS};

static void check_vk(VkResult result)
{
    assert_int_equal(result, VK_SUCCESS);
}

/* R32F of which LEVEL has the picture's extent, with a view of that level of LAYER. */
static void create_layered(const struct picture *p, struct gpu_image *image)
{
    VkMemoryRequirements need;
    const VkDevice device = fixture.gpu.device;
    *image = (struct gpu_image){.format = VK_FORMAT_R32_SFLOAT};
    check_vk(vkCreateImage(device,
                           &(VkImageCreateInfo){
                               .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                               .imageType = VK_IMAGE_TYPE_2D,
                               .format = image->format,
                               .extent = {p->width << LEVEL, p->height << LEVEL, 1},
                               .mipLevels = LEVELS,
                               .arrayLayers = LAYERS,
                               .samples = VK_SAMPLE_COUNT_1_BIT,
                               .tiling = VK_IMAGE_TILING_OPTIMAL,
                               .usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT |
                                        VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                        VK_IMAGE_USAGE_TRANSFER_DST_BIT,
                           },
                           NULL, &image->image));
    vkGetImageMemoryRequirements(device, image->image, &need);
    image->memory = fixture_allocate(&need, need.size);
    check_vk(vkBindImageMemory(device, image->image, image->memory, 0));
    check_vk(
        vkCreateImageView(device,
                          &(VkImageViewCreateInfo){
                              .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                              .image = image->image,
                              .viewType = VK_IMAGE_VIEW_TYPE_2D,
                              .format = image->format,
                              .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, LEVEL, 1, LAYER, 1},
                          },
                          NULL, &image->view));
}

/* The canary into every level of every layer. */
static void record_clear(VkImage image, float canary, VkCommandBuffer cmd)
{
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0,
                         0, NULL, 0, NULL, 1,
                         &(VkImageMemoryBarrier){
                             .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                             .dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                             .oldLayout = VK_IMAGE_LAYOUT_UNDEFINED,
                             .newLayout = VK_IMAGE_LAYOUT_GENERAL,
                             .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                             .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                             .image = image,
                             .subresourceRange = all_of_it,
                         });
    vkCmdClearColorImage(cmd, image, VK_IMAGE_LAYOUT_GENERAL,
                         &(VkClearColorValue){.float32 = {canary}}, 1, &all_of_it);
    gpu_full_barrier(cmd);
}

static void run_layered(struct picture *p, struct gpu_image *image,
                        struct gpu_buffer read[LAYERS + 1])
{
    struct picture_gpu g;
    picture_open(p, &g);
    g.slots.ao.view = image->view;
    g.slots.ao_image = image->image;
    g.slots.ao_mip_level = LEVEL;
    g.slots.ao_array_layer = LAYER;
    check_vkao(vkao_frame_update(g.frame, &g.slots));
    VkCommandBuffer cmd = gpu_begin(&fixture.gpu, &fixture.error);
    check(cmd != NULL);
    record_clear(image->image, 0.25f, cmd);
    picture_record(p, &g, cmd);
    for (uint32_t layer = 0; layer < LAYERS; ++layer)
        record_read_back(p, image->image, LEVEL, layer, cmd, read[layer].buffer);
    record_read_back(p, image->image, 0, LAYER, cmd, read[LAYERS].buffer);
    check(gpu_submit(&fixture.gpu, cmd, &fixture.error));
    picture_close(&g);
}

static void one_level_of_one_layer_is_written(void **state)
{
    (void)state;
    use_context(NULL);
    for (int half = 0; half < 2; ++half) {
        struct picture p;
        struct gpu_image image;
        struct gpu_buffer read[LAYERS + 1];
        make(&p, 45, 139, VK_FORMAT_R32_SFLOAT, half);
        picture_run(&p);
        create_layered(&p, &image);
        for (int i = 0; i <= LAYERS; ++i)
            check(gpu_buffer_create(&fixture.gpu, picture_texels(&p) * sizeof(float),
                                    VK_BUFFER_USAGE_TRANSFER_DST_BIT, &read[i], &fixture.error));
        run_layered(&p, &image, read);
        for (int i = 0; i <= LAYERS; ++i) {
            const float *texels = read[i].mapped;
            for (size_t t = 0; t < picture_texels(&p); ++t) {
                const double want = i == LAYER ? p.values[SLOT_AO][t] : 0.25;
                if ((double)texels[t] != want)
                    fail_msg("%s %d, texel %zu is %g, want %g", i < LAYERS ? "layer" : "level 0 of",
                             i, t, (double)texels[t], want);
            }
            gpu_buffer_destroy(&fixture.gpu, &read[i]);
        }
        check_shaded(p.values[SLOT_AO], picture_texels(&p));
        gpu_image_destroy(&fixture.gpu, &image);
        picture_free(&p);
    }
    give_back();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        gpu_test(staged_ao_is_what_is_stored),
        gpu_test(every_end_of_blur_is_staged),
        gpu_test(rect_leaves_exterior_untouched),
        gpu_test(composite_reads_the_copy),
        gpu_test(variant_of_the_format_is_found),
        gpu_test(waiting_for_shader_writes_waits_for_the_copy),
        gpu_test(one_level_of_one_layer_is_written),
    };
    return fixture_run(tests);
}
