/* SPDX-License-Identifier: MIT */
#include "fixture.h"
#include "pixels.h"
#include "ref_normal.h"

#include <stdlib.h>
#include <string.h>

/* What texels hold that nobody has written yet; 1 is what broken code writes most. */
static const double canary = 0.6235;

void picture_init(struct picture *p, uint32_t width, uint32_t height, vkao_stage_flags stages)
{
    *p = (struct picture){.width = width, .height = height, .stages = stages, .staged = true};
    p->view = ao_view_default();
    p->ssao = ao_ssao_default();
    p->blur = ao_blur_default();
    p->composite = ao_composite_default();
}

void picture_preset(struct picture *p, vkao_quality quality)
{
    vkao_effect_info effect = vkao_effect_info_default();
    vkao_params params = vkao_params_default();
    check_vkao(vkao_preset(quality, &effect, &params));
    p->half_resolution = effect.half_resolution;
    p->ssao.method = effect.method;
    p->ssao.slice_count = effect.slice_count;
    p->ssao.step_count = effect.step_count;
    p->ssao.bias = params.bias;
    p->ssao.thickness = params.thickness;
    p->blur.radius = effect.blur_radius;
    p->blur.normal_power = effect.blur_normal_power;
    p->blur.sharpness = params.sharpness;
}

void picture_free(struct picture *p)
{
    for (int i = 0; i < SLOT_COUNT; ++i)
        free(p->values[i]);
    memset(p, 0, sizeof *p);
}

uint32_t picture_channels(enum picture_slot slot)
{
    const bool is_color = slot != SLOT_DEPTH && slot != SLOT_NOISY && slot != SLOT_AO &&
                          slot != SLOT_THICKNESS && slot != SLOT_SECOND;
    return is_color ? 4 : 1;
}

size_t picture_texels(const struct picture *p)
{
    return (size_t)p->width * p->height;
}

vkao_image *picture_slot_image(vkao_images *images, enum picture_slot slot)
{
    vkao_image *const slots[SLOT_COUNT] = {
        [SLOT_DEPTH] = &images->depth,         [SLOT_NORMALS] = &images->normals,
        [SLOT_NOISY] = &images->ao_noisy,      [SLOT_AO] = &images->ao,
        [SLOT_COLOR] = &images->color,         [SLOT_DIRECT] = &images->direct,
        [SLOT_OUTPUT] = &images->output,       [SLOT_BENT] = &images->bent_normals,
        [SLOT_ALBEDO] = &images->albedo,       [SLOT_SPECULAR] = &images->specular,
        [SLOT_THICKNESS] = &images->thickness, [SLOT_SECOND] = &images->second_depth,
    };
    return slots[slot];
}

/* Between the values of a slot and the bytes of its image. */
static void *slot_encode(const struct picture *p, enum picture_slot slot, size_t *bytes)
{
    size_t texels = picture_texels(p);
    uint32_t channels = picture_channels(slot);
    *bytes = texels * gpu_format_bytes(p->formats[slot]);
    double *wide = test_alloc(texels * 4, sizeof *wide);
    for (size_t i = 0; i < texels; ++i)
        memcpy(&wide[i * 4], &p->values[slot][i * channels], channels * sizeof *wide);
    void *data = test_alloc(*bytes, 1);
    pixels_encode(p->formats[slot], wide, texels, data);
    free(wide);
    return data;
}

static void slot_decode(struct picture *p, enum picture_slot slot, const void *data)
{
    size_t texels = picture_texels(p);
    uint32_t channels = picture_channels(slot);
    double *wide = test_alloc(texels * 4, sizeof *wide);
    pixels_decode(p->formats[slot], data, texels, wide);
    for (size_t i = 0; i < texels; ++i)
        memcpy(&p->values[slot][i * channels], &wide[i * 4], channels * sizeof *wide);
    free(wide);
}

void picture_set(struct picture *p, enum picture_slot slot, VkFormat format, const double *values)
{
    size_t count = picture_texels(p) * picture_channels(slot), bytes;
    assert_int_not_equal(pixels_components(format), 0);
    free(p->values[slot]);
    p->formats[slot] = format;
    p->values[slot] = test_alloc(count, sizeof(double));
    for (size_t i = 0; i < count; ++i)
        p->values[slot][i] = values ? values[i] : canary;
    void *data = slot_encode(p, slot, &bytes);
    slot_decode(p, slot, data);
    free(data);
}

void picture_fill(struct picture *p, enum picture_slot slot, VkFormat format, double value)
{
    size_t count = picture_texels(p) * picture_channels(slot);
    double *values = test_alloc(count, sizeof *values);
    for (size_t i = 0; i < count; ++i)
        values[i] = value;
    picture_set(p, slot, format, values);
    free(values);
}

static VkRect2D lens_viewport(const struct picture *p)
{
    if (p->view.viewport.extent.width)
        return p->view.viewport;
    return p->view.valid.extent.width ? p->view.valid : (VkRect2D){{0, 0}, {p->width, p->height}};
}

void picture_render_scene(struct picture *p, const struct scene *scene, const struct lens *lens,
                          VkFormat depth_format, VkFormat normals_format)
{
    size_t texels = picture_texels(p);
    double *z = test_alloc(texels, sizeof *z), *normals = test_alloc(texels * 4, sizeof *normals);
    VkRect2D viewport = lens_viewport(p);
    scene_render(scene, lens, viewport, p->width, p->height, z, normals);
    for (size_t i = 0; i < texels; ++i) {
        double x =
            ((double)(i % p->width) + 0.5 - viewport.offset.x) / viewport.extent.width * 2.0 - 1.0;
        double y =
            ((double)(i / p->width) + 0.5 - viewport.offset.y) / viewport.extent.height * 2.0 - 1.0;
        z[i] = lens_encode(lens, p->view.depth_encoding, x, y, z[i]);
        double normal[3] = {normals[i * 4], normals[i * 4 + 1], normals[i * 4 + 2]};
        ref_normal_encode(p->view.normal_encoding, normal, &normals[i * 4]);
    }
    picture_set(p, SLOT_DEPTH, depth_format, z);
    if (normals_format != VK_FORMAT_UNDEFINED)
        picture_set(p, SLOT_NORMALS, normals_format, normals);
    lens_matrix(lens, p->view.projection);
    free(z);
    free(normals);
}

void picture_render_behind(struct picture *p, const struct scene *scene, const struct lens *lens)
{
    const size_t texels = picture_texels(p);
    double *back = test_alloc(texels, sizeof *back), *second = test_alloc(texels, sizeof *second);
    scene_render_behind(scene, lens, lens_viewport(p), p->width, p->height, back, second);
    if (p->thickness_input == VKAO_THICKNESS_GIVEN)
        for (size_t i = 0; i < texels; ++i)
            back[i] -= p->values[SLOT_DEPTH][i]; /* view z */
    picture_set(p, SLOT_THICKNESS, VK_FORMAT_R32_SFLOAT, back);
    picture_set(p, SLOT_SECOND, VK_FORMAT_R32_SFLOAT, second);
    free(back);
    free(second);
}

void picture_make(struct picture *p, vkao_stage_flags stages, const struct scene *scene)
{
    struct lens lens = lens_perspective(0.6, 0.45);
    picture_init(p, 80, 60, stages);
    p->view.depth_encoding = VKAO_DEPTH_VIEW_Z;
    p->view.normal_encoding = VKAO_NORMALS_XYZ_SNORM;
    picture_render_scene(p, scene, &lens, VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT);
    picture_set(p, SLOT_AO, VK_FORMAT_R32_SFLOAT, NULL);
}

static bool is_written(const struct picture *p, enum picture_slot slot)
{
    bool makes_ao = p->stages & (VKAO_STAGE_SSAO | VKAO_STAGE_BLUR);
    bool makes_noisy = (p->stages & VKAO_STAGE_SSAO) && (p->stages & VKAO_STAGE_BLUR);
    if (slot == SLOT_BENT)
        return makes_noisy;
    return slot == SLOT_OUTPUT || (slot == SLOT_AO && makes_ao) ||
           (slot == SLOT_NOISY && makes_noisy) || (slot == SLOT_COLOR && p->output_is_color);
}

static void open_slot(const struct picture *p, enum picture_slot slot, struct gpu_image *image)
{
    size_t bytes;
    VkImageUsageFlags usage = slot == SLOT_OUTPUT ? 0u : VK_IMAGE_USAGE_SAMPLED_BIT;
    usage |= is_written(p, slot) ? VK_IMAGE_USAGE_STORAGE_BIT : 0u;
    check(gpu_image_create(&fixture.gpu, p->formats[slot], (VkExtent2D){p->width, p->height}, usage,
                           image, &fixture.error));
    void *data = slot_encode(p, slot, &bytes);
    check(gpu_image_upload(&fixture.gpu, image, data, bytes, &fixture.error));
    free(data);
}

vkao_effect_info picture_effect_info(const struct picture *p)
{
    const vkao_stage_flags both = VKAO_STAGE_SSAO | VKAO_STAGE_BLUR;
    const bool has_both = (p->stages & both) == both;
    vkao_effect_info info = ao_effect(p->stages, &p->view, &p->ssao, &p->blur, &p->composite);
    info.half_resolution = p->half_resolution;
    info.thickness_input = p->thickness_input;
    info.second_layer = p->formats[SLOT_SECOND] != VK_FORMAT_UNDEFINED;
    info.bent_normals = has_both && p->formats[SLOT_BENT] != VK_FORMAT_UNDEFINED;
    info.noisy_ao = has_both && p->formats[SLOT_NOISY] != VK_FORMAT_UNDEFINED;
    info.ao_format = p->formats[SLOT_AO];
    return info;
}

vkao_effect *picture_effect(const struct picture *p, const vkao_context *context)
{
    const vkao_effect_info info = picture_effect_info(p);
    vkao_effect *effect = NULL;
    check_vkao(vkao_effect_create(context, &info, &effect));
    return effect;
}

void picture_frame_info(const struct picture *p, const struct picture_gpu *g, vkao_frame_info *info)
{
    *info = vkao_frame_info_default();
    info->extent = (VkExtent2D){p->width, p->height};
    info->images = &g->slots;
    info->scratch_memory = p->scratch_memory;
    info->scratch_offset = p->scratch_offset;
}

void picture_open(const struct picture *p, struct picture_gpu *g)
{
    vkao_frame_info info;
    *g = (struct picture_gpu){.slots = vkao_images_default()};
    for (int i = 0; i < SLOT_COUNT; ++i) {
        if (p->formats[i] == VK_FORMAT_UNDEFINED)
            continue;
        open_slot(p, (enum picture_slot)i, &g->images[i]);
        *picture_slot_image(&g->slots, (enum picture_slot)i) = gpu_image_slot(&g->images[i]);
    }
    if (p->output_is_color)
        g->slots.output = g->slots.color;
    if (p->staged)
        g->slots.ao.image = g->images[SLOT_AO].image;
    picture_frame_info(p, g, &info);
    const vkao_effect_info effect = picture_effect_info(p);
    g->effect = fixture_effect(&effect);
    check_vkao(vkao_frame_create(g->effect, &info, &g->frame));
}

void picture_record(const struct picture *p, const struct picture_gpu *g, VkCommandBuffer cmd)
{
    const vkao_view view = ao_library_view(&p->view);
    const vkao_params params = ao_params(&p->ssao, &p->blur, &p->composite);
    check_vkao(vkao_cmd_record(g->frame, cmd, &view, &params));
}

void picture_record_stages(const struct picture *p, const struct picture_gpu *g,
                           VkCommandBuffer cmd, vkao_stage_flags stages)
{
    const vkao_view view = ao_library_view(&p->view);
    const vkao_params params = ao_params(&p->ssao, &p->blur, &p->composite);
    check_vkao(vkao_cmd_stage(g->frame, cmd, stages, &view, &params));
}

void picture_download(struct picture *p, struct picture_gpu *g)
{
    for (int i = 0; i < SLOT_COUNT; ++i) {
        if (p->formats[i] == VK_FORMAT_UNDEFINED || !is_written(p, (enum picture_slot)i))
            continue;
        size_t bytes = picture_texels(p) * gpu_format_bytes(p->formats[i]);
        void *data = test_alloc(bytes, 1);
        check(gpu_image_download(&fixture.gpu, &g->images[i], data, bytes, &fixture.error));
        slot_decode(p, (enum picture_slot)i, data);
        free(data);
    }
}

void picture_close(struct picture_gpu *g)
{
    vkao_frame_destroy(g->frame);
    for (int i = 0; i < SLOT_COUNT; ++i)
        gpu_image_destroy(&fixture.gpu, &g->images[i]);
    *g = (struct picture_gpu){.frame = NULL};
}

void picture_run(struct picture *p)
{
    struct picture_gpu g;
    picture_open(p, &g);
    VkCommandBuffer cmd = gpu_begin(&fixture.gpu, &fixture.error);
    check(cmd != NULL);
    picture_record(p, &g, cmd);
    check(gpu_submit(&fixture.gpu, cmd, &fixture.error));
    picture_download(p, &g);
    picture_close(&g);
}

void picture_reference_scene(const struct picture *p, struct ref_scene *scene)
{
    bool stored = p->view.normal_encoding != VKAO_NORMALS_FROM_DEPTH;
    ref_scene_init(scene, &p->view, p->width, p->height, p->formats[SLOT_DEPTH],
                   p->values[SLOT_DEPTH], stored ? p->values[SLOT_NORMALS] : NULL);
}

void picture_check_part(const struct picture *part, const struct picture *whole, double untouched,
                        const char *what)
{
    const VkRect2D rect = part->view.rect;
    for (size_t i = 0; i < picture_texels(part); ++i) {
        const uint32_t x = (uint32_t)(i % part->width), y = (uint32_t)(i / part->width);
        const bool inside = x - (uint32_t)rect.offset.x < rect.extent.width &&
                            y - (uint32_t)rect.offset.y < rect.extent.height;
        const double want = inside ? whole->values[SLOT_AO][i] : untouched;
        if (!(part->values[SLOT_AO][i] == want))
            fail_msg("%s %ux%u at (%d,%d): texel (%u,%u) is %.9g, want %.9g", what,
                     rect.extent.width, rect.extent.height, rect.offset.x, rect.offset.y, x, y,
                     part->values[SLOT_AO][i], want);
    }
}
