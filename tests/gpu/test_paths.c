/* SPDX-License-Identifier: MIT
 *
 * The CPU's passes against those of GPUs, on one device: the same AO but for the rounding of
 * codes. */
#include "fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Noisy AO is a code of .01 in the CPU's buffer, and a 16-bit float below 2 in the image of a GPU:
 * each is off by half a step, which the blur's mean does not exceed. */
static const double code_rounding = 0.005, float_rounding = 0x1p-11;
/* vbao's bounds of sectors come of the same numbers in another order: in one texel of a thousand
 * one falls to the other side. */
static const double sector = 1.0 / 31.0;

/* Higher than the ring of rows that a CPU blurs through. */
enum { WIDTH = 139, HEIGHT = 163 };
#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static const struct row {
    const char *name;
    vkao_ssao_method method;
    uint32_t slices, steps, samples, blur;
    float normal_power, intensity, power;
    vkao_falloff falloff;
    bool half, depth_only, orthographic, bent;
} rows[] = {
    {.name = "sphere", .method = VKAO_SSAO_SPHERE, .samples = 16, .blur = 3},
    {.name = "hemisphere", .method = VKAO_SSAO_HEMISPHERE, .samples = 16, .blur = 3},
    {.name = "hbao", .method = VKAO_SSAO_HBAO, .slices = 2, .steps = 6, .blur = 3},
    {.name = "gtao", .method = VKAO_SSAO_GTAO, .slices = 3, .steps = 6, .blur = 3},
    {.name = "vbao", .method = VKAO_SSAO_VBAO, .slices = 1, .steps = 8, .blur = 3},
    {.name = "vbao, 4 slices", .method = VKAO_SSAO_VBAO, .slices = 4, .steps = 24, .blur = 1},
    {.name = "raymarch", .method = VKAO_SSAO_RAYMARCH, .steps = 8, .samples = 8, .blur = 3},
    {.name = "vbao, threshold",
     .method = VKAO_SSAO_VBAO,
     .slices = 1,
     .steps = 8,
     .blur = 3,
     .falloff = VKAO_FALLOFF_THRESHOLD},
    {.name = "vbao, normals in the blur",
     .method = VKAO_SSAO_VBAO,
     .slices = 1,
     .steps = 14,
     .blur = 3,
     .normal_power = 8.0f},
    {.name = "vbao, large blur", .method = VKAO_SSAO_VBAO, .slices = 1, .steps = 4, .blur = 16},
    {.name = "vbao, no blur", .method = VKAO_SSAO_VBAO, .slices = 2, .steps = 4, .blur = 0},
    {.name = "vbao, toned",
     .method = VKAO_SSAO_VBAO,
     .slices = 1,
     .steps = 8,
     .blur = 3,
     .intensity = 1.5f,
     .power = 1.2f},
    {.name = "vbao, half",
     .method = VKAO_SSAO_VBAO,
     .slices = 1,
     .steps = 8,
     .blur = 3,
     .half = true},
    {.name = "gtao, half, normals",
     .method = VKAO_SSAO_GTAO,
     .slices = 1,
     .steps = 6,
     .blur = 3,
     .half = true,
     .normal_power = 8.0f},
    {.name = "vbao, depth only",
     .method = VKAO_SSAO_VBAO,
     .slices = 1,
     .steps = 8,
     .blur = 3,
     .depth_only = true},
    {.name = "vbao, orthographic",
     .method = VKAO_SSAO_VBAO,
     .slices = 1,
     .steps = 8,
     .blur = 3,
     .orthographic = true},
    {.name = "vbao, bent normals",
     .method = VKAO_SSAO_VBAO,
     .slices = 1,
     .steps = 8,
     .blur = 3,
     .bent = true},
    {.name = "gtao, bent normals, half",
     .method = VKAO_SSAO_GTAO,
     .slices = 1,
     .steps = 8,
     .blur = 3,
     .bent = true,
     .half = true},
};

static void make(struct picture *p, const struct row *row)
{
    const struct scene scene = scene_fence();
    const double aspect = (double)WIDTH / HEIGHT;
    const struct lens lens = row->orthographic ? lens_orthographic(2.0 * aspect, 2.0)
                                               : lens_perspective(0.7 * aspect, 0.7);
    picture_init(p, WIDTH, HEIGHT, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR);
    p->view.depth_encoding = VKAO_DEPTH_VIEW_Z;
    p->view.normal_encoding = row->depth_only ? VKAO_NORMALS_FROM_DEPTH : VKAO_NORMALS_XYZ_SNORM;
    picture_render_scene(p, &scene, &lens, VK_FORMAT_R32_SFLOAT,
                         row->depth_only ? VK_FORMAT_UNDEFINED : VK_FORMAT_R32G32B32A32_SFLOAT);
    picture_set(p, SLOT_AO, VK_FORMAT_R32_SFLOAT, NULL);
    if (row->bent)
        picture_set(p, SLOT_BENT, VK_FORMAT_R32G32B32A32_SFLOAT, NULL);
    p->half_resolution = row->half;
    p->ssao.radius = 1.5f;
    p->ssao.method = row->method;
    p->ssao.falloff = row->falloff;
    p->ssao.slice_count = row->slices;
    p->ssao.step_count = row->steps;
    p->ssao.sample_count = row->samples;
    p->blur.radius = row->blur;
    p->blur.normal_power = row->normal_power;
    p->blur.intensity = row->intensity > 0.0f ? row->intensity : 1.0f;
    p->blur.power = row->power > 0.0f ? row->power : 1.0f;
}

/* AO of every row, and its bent normals. */
static void run_all(double *ao[COUNT(rows)], double *bent[COUNT(rows)])
{
    for (size_t i = 0; i < COUNT(rows); ++i) {
        struct picture p;
        make(&p, &rows[i]);
        picture_run(&p);
        ao[i] = p.values[SLOT_AO];
        bent[i] = p.values[SLOT_BENT];
        p.values[SLOT_AO] = p.values[SLOT_BENT] = NULL;
        picture_free(&p);
    }
}

static void use_path(const char *path)
{
    setenv("VKAO_PATH", path, 1);
    fixture_forget_effects();
    vkao_context_destroy(fixture.context);
    fixture.context = gpu_context(&fixture.gpu, &fixture.error);
    check(fixture.context != NULL);
}

static void both_paths_agree(void **state)
{
    (void)state;
    double *cpu[COUNT(rows)], *cpu_bent[COUNT(rows)], *gpu[COUNT(rows)], *gpu_bent[COUNT(rows)];
    use_path("own");
    run_all(cpu, cpu_bent);
    use_path("images");
    run_all(gpu, gpu_bent);
    unsigned failed = 0;
    for (size_t i = 0; i < COUNT(rows); ++i) {
        const struct row *row = &rows[i];
        const struct difference d = difference_of(cpu[i], gpu[i], WIDTH * HEIGHT);
        /* Intensity scales it; the slope of a power is at most the power. With bent normals both
         * store floats. */
        const double tone = (row->intensity > 0.0f ? row->intensity : 1.0f) *
                            (row->power > 0.0f ? row->power : 1.0f);
        const double most =
            (row->bent ? float_rounding : code_rounding + float_rounding) * tone + 1e-5;
        const double spread = mean_of(gpu[i], WIDTH * HEIGHT);
        size_t flips = 0;
        for (size_t t = 0; t < (size_t)WIDTH * HEIGHT; ++t)
            flips += !(fabs(cpu[i][t] - gpu[i][t]) <= most);
        print_message("    %-28s max %.2e  mean %.2e of %.3f, %zu flips\n", row->name, d.max,
                      d.mean, spread, flips);
        failed += !(spread < 0.98) || !(d.max <= most + sector * tone);
        /* It counts samples. Shares of 16 may end on half a code, which both paths round alike. */
        failed += row->method == VKAO_SSAO_SPHERE && !(d.max <= 1e-4);
        failed += flips > (row->method == VKAO_SSAO_VBAO ? WIDTH * HEIGHT / 1000 : 0);
        if (row->bent) {
            const struct difference b =
                difference_of(cpu_bent[i], gpu_bent[i], (size_t)WIDTH * HEIGHT * 4);
            print_message("    %-28s max %.2e  mean %.2e\n", "  its bent normals", b.max, b.mean);
            failed += !(b.max <= 2.0 * float_rounding);
        }
        free(cpu[i]);
        free(gpu[i]);
        free(cpu_bent[i]);
        free(gpu_bent[i]);
    }
    assert_int_equal(failed, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {gpu_test(both_paths_agree)};
    if (!fixture_open())
        return FIXTURE_UNAVAILABLE;
    if (fixture.gpu.properties.deviceType != VK_PHYSICAL_DEVICE_TYPE_CPU) {
        fprintf(stderr, "skipped: the device is no CPU, and has one path\n");
        fixture_close(NULL);
        return FIXTURE_UNAVAILABLE;
    }
    return cmocka_run_group_tests(tests, NULL, fixture_close);
}
