/* SPDX-License-Identifier: MIT
 *
 * One result from whatever pipelines: compiled for their settings or general, scratch in buffers or
 * in images, whole images or parts of them. */
#include "fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Runs the picture with the context in the fixture's place. */
static void run_with(vkao_context *context, struct picture *p)
{
    vkao_context *kept = fixture.context;
    fixture.context = context;
    picture_run(p);
    fixture.context = kept;
}

static vkao_context *create(const vkao_context_info *info)
{
    vkao_context *context = NULL;
    check_vkao(vkao_context_create(info, &context));
    return context;
}

enum way { IMAGES, BUFFERS, BUFFERS_16BIT /* if the device has it */ };

static vkao_context_info way_info(enum way way)
{
    vkao_context_info info = fixture_context_info();
    info.scratch_layout = way == IMAGES ? VKAO_SCRATCH_IMAGES : VKAO_SCRATCH_BUFFERS;
    if (way != BUFFERS_16BIT)
        info.storage_16bit = VK_FALSE;
    return info;
}

static vkao_context *way_context(enum way way)
{
    const vkao_context_info info = way_info(way);
    return create(&info);
}

/* --- Variants --- */

enum { PRESETS = 4, SETTINGS = PRESETS + 5 };
static const char *const names[SETTINGS] = {"fast",      "default",  "high",
                                            "best",      "gtao 3x6", "hemisphere 16",
                                            "sphere 16", "hbao",     "vbao 2x13, no blur"};

static void choose(int i, vkao_ssao_params *ssao, vkao_blur_params *blur)
{
    /* 13 steps are two loops of 7, one of which has one too many. */
    static const struct {
        vkao_ssao_method method;
        uint32_t slices, steps; /* 0 = the default */
    } rows[SETTINGS - PRESETS] = {{VKAO_SSAO_GTAO, 3, 6},
                                  {VKAO_SSAO_HEMISPHERE, 0, 0},
                                  {VKAO_SSAO_SPHERE, 0, 0},
                                  {VKAO_SSAO_HBAO, 0, 0},
                                  {VKAO_SSAO_VBAO, 2, 13}};
    if (i < PRESETS) {
        check_vkao(vkao_preset((vkao_quality)i, NULL, ssao, blur));
        return;
    }
    ssao->method = rows[i - PRESETS].method;
    ssao->slice_count = rows[i - PRESETS].slices;
    ssao->step_count = rows[i - PRESETS].steps;
    if (ssao->method == VKAO_SSAO_VBAO)
        blur->radius = 0;
}

/* Each setting at full and at half resolution. */
static void variants_equal_the_general_pipelines(enum way way)
{
    struct picture pictures[SETTINGS * 2];
    vkao_variant variants[SETTINGS * 2];
    vkao_context_info info = way_info(way);
    const struct scene scene = scene_corner();
    for (int i = 0; i < SETTINGS * 2; ++i) {
        struct picture *p = &pictures[i];
        picture_make(p, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR, &scene);
        choose(i / 2, &p->ssao, &p->blur);
        p->half_resolution = i & 1;
        variants[i] = (vkao_variant){
            .struct_size = sizeof variants[i],
            .half_resolution = p->half_resolution,
            .view = &p->view,
            .ssao = &p->ssao,
            .blur = &p->blur,
        };
    }
    vkao_context *general = way_context(way);
    info.variants = variants;
    info.variant_count = SETTINGS * 2;
    info.variants_only = VK_TRUE;
    vkao_context *special = create(&info);
    for (int i = 0; i < SETTINGS * 2; ++i) {
        struct picture *p = &pictures[i];
        const size_t texels = picture_texels(p);
        char what[64];
        snprintf(what, sizeof what, "%s, %s", names[i / 2], i & 1 ? "half" : "full");
        run_with(general, p);
        double *want = p->values[SLOT_AO];
        p->values[SLOT_AO] = NULL;
        picture_set(p, SLOT_AO, VK_FORMAT_R32_SFLOAT, NULL);
        run_with(special, p);
        check_close(what, p->values[SLOT_AO], want, texels, 1e-5, 2e-3);
        const double mean = mean_of(want, texels);
        assert_true(mean > 0.5 && mean < 0.999); /* there is something to agree about */
        free(want);
    }
    vkao_context_destroy(special);
    vkao_context_destroy(general);
    for (int i = 0; i < SETTINGS * 2; ++i)
        picture_free(&pictures[i]);
}

static void variants_equal_the_general_pipelines_in_buffers(void **state)
{
    (void)state;
    variants_equal_the_general_pipelines(BUFFERS);
    variants_equal_the_general_pipelines(BUFFERS_16BIT);
}

static void variants_equal_the_general_pipelines_in_images(void **state)
{
    (void)state;
    variants_equal_the_general_pipelines(IMAGES);
}

/* --- Buffers, for images that the blur goes down in strips --- */

static const struct tall {
    const char *name;
    uint32_t width, height, blur_radius;
    float normal_power, sharpness;
    bool half_resolution, sky;
} talls[] = {
    {"radius 0", 96, 600, 0, 0.0f, 200.0f, false, false},
    {"radius 3", 96, 600, 3, 0.0f, 200.0f, false, false},
    {"radius 3, normals", 96, 600, 3, 8.0f, 200.0f, false, false},
    {"radius 7", 96, 600, 7, 0.0f, 200.0f, false, false},
    {"radius 7, normals", 96, 600, 7, 8.0f, 200.0f, false, false},
    {"radius 16", 96, 600, 16, 0.0f, 200.0f, false, false},
    {"radius 16, normals", 96, 600, 16, 8.0f, 200.0f, false, false},
    {"radius 16, no edges stop it", 96, 600, 16, 0.0f, 0.0f, false, true},
    {"odd size, sky", 97, 601, 16, 3.0f, 200.0f, false, true},
    {"half, radius 3", 96, 1100, 3, 0.0f, 200.0f, true, false},
    {"half, radius 3, normals", 96, 1100, 3, 8.0f, 200.0f, true, false},
    {"half, radius 16, odd size, sky", 97, 1101, 16, 8.0f, 200.0f, true, true},
};
enum { TALLS = sizeof talls / sizeof talls[0] };

static void make_tall(struct picture *p, const struct tall *t)
{
    /* Edges of depth alone, edges of normals alone. */
    const struct scene scene = t->normal_power > 0.0f ? scene_staircase() : scene_fence();
    const struct lens lens = lens_perspective(0.9 * (double)t->width / (double)t->height, 0.9);
    picture_init(p, t->width, t->height, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR);
    p->view.depth_encoding = VKAO_DEPTH_VIEW_Z;
    p->view.normal_encoding = VKAO_NORMALS_XYZ_SNORM;
    picture_render_scene(p, &scene, &lens, VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT);
    /* Windows to the sky. */
    for (uint32_t i = 0; t->sky && i < t->width * t->height; ++i) {
        if ((i % t->width / 11 + i / t->width / 23) % 3 == 0)
            p->values[SLOT_DEPTH][i] = INFINITY;
    }
    picture_set(p, SLOT_AO, VK_FORMAT_R32_SFLOAT, NULL);
    p->ssao.method = VKAO_SSAO_GTAO;
    p->ssao.radius = 2.0f;
    p->blur.radius = t->blur_radius;
    p->blur.normal_power = t->normal_power;
    p->blur.sharpness = t->sharpness;
    p->half_resolution = t->half_resolution;
}

static void buffers_agree_with_images(void **state)
{
    (void)state;
    vkao_context *images = way_context(IMAGES);
    vkao_context *buffers = way_context(BUFFERS);
    for (int i = 0; i < TALLS; ++i) {
        struct picture a, b;
        make_tall(&a, &talls[i]);
        make_tall(&b, &talls[i]);
        run_with(images, &a);
        run_with(buffers, &b);
        check_close(talls[i].name, b.values[SLOT_AO], a.values[SLOT_AO], picture_texels(&a), 0.002,
                    0.01);
        size_t dark = 0;
        for (size_t t = 0; t < picture_texels(&a); ++t)
            dark += a.values[SLOT_AO][t] < 0.9;
        assert_true(dark > 100);
        picture_free(&a);
        picture_free(&b);
    }
    vkao_context_destroy(images);
    vkao_context_destroy(buffers);
}

static void storage_of_16_bits_changes_nothing(void **state)
{
    (void)state;
    const struct scene scene = scene_corner();
    if (!fixture.gpu.storage_16bit)
        skip();
    vkao_context *with = way_context(BUFFERS_16BIT), *without = way_context(BUFFERS);
    for (int method = 0; method <= VKAO_SSAO_RAYMARCH; ++method) {
        struct picture p;
        picture_make(&p, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR, &scene);
        p.ssao.method = (vkao_ssao_method)method;
        run_with(without, &p);
        double *want = p.values[SLOT_AO];
        p.values[SLOT_AO] = NULL;
        picture_set(&p, SLOT_AO, VK_FORMAT_R32_SFLOAT, NULL);
        run_with(with, &p);
        assert_memory_equal(p.values[SLOT_AO], want, picture_texels(&p) * sizeof *want);
        assert_true(mean_of(want, picture_texels(&p)) < 0.999);
        free(want);
        picture_free(&p);
    }
    vkao_context_destroy(without);
    vkao_context_destroy(with);
}

static void rects_equal_the_whole_in(enum way way)
{
    static const VkRect2D rects[] = {
        {{20, 231}, {51, 300}}, {{33, 255}, {9, 34}}, {{17, 51}, {16, 16}},
        {{0, 288}, {96, 256}},  {{95, 599}, {1, 1}},  {{10, 201}, {70, 700}},
    };
    vkao_context *context = way_context(way);
    for (int i = 0; i < TALLS; ++i) {
        struct picture whole;
        make_tall(&whole, &talls[i]);
        const double canary = whole.values[SLOT_AO][0];
        run_with(context, &whole);
        for (size_t r = 0; r < sizeof rects / sizeof rects[0]; ++r) {
            struct picture part;
            if ((uint32_t)rects[r].offset.y + rects[r].extent.height > whole.height)
                continue;
            make_tall(&part, &talls[i]);
            part.view.rect = rects[r];
            run_with(context, &part);
            picture_check_part(&part, &whole, canary, talls[i].name);
            picture_free(&part);
        }
        picture_free(&whole);
    }
    vkao_context_destroy(context);
}

static void rects_equal_the_whole_in_buffers(void **state)
{
    (void)state;
    rects_equal_the_whole_in(BUFFERS);
    rects_equal_the_whole_in(BUFFERS_16BIT);
}

static void rects_equal_the_whole_in_images(void **state)
{
    (void)state;
    rects_equal_the_whole_in(IMAGES);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        gpu_test(variants_equal_the_general_pipelines_in_buffers),
        gpu_test(variants_equal_the_general_pipelines_in_images),
        gpu_test(buffers_agree_with_images),
        gpu_test(storage_of_16_bits_changes_nothing),
        gpu_test(rects_equal_the_whole_in_buffers),
        gpu_test(rects_equal_the_whole_in_images),
    };
    return fixture_run(tests);
}
