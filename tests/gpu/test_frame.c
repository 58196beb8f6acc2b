/* SPDX-License-Identifier: MIT
 *
 * Rectangles, stages recorded one by one or all at once, frames with fewer stages, other images. */
#include "fixture.h"
#include "ref_hemisphere.h"
#include "ref_methods.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Every stage, every image the caller's own. */
static void make(struct picture *p)
{
    const struct scene scene = scene_corner();
    picture_make(p, VKAO_STAGE_ALL, &scene);
    picture_set(p, SLOT_NOISY, VK_FORMAT_R16_SFLOAT, NULL);
    picture_fill(p, SLOT_COLOR, VK_FORMAT_R16G16B16A16_SFLOAT, 0.5);
    picture_set(p, SLOT_OUTPUT, VK_FORMAT_R16G16B16A16_SFLOAT, NULL);
}

static bool inside(const struct picture *p, size_t texel, VkRect2D rect)
{
    int x = (int)(texel % p->width), y = (int)(texel / p->width);
    return x >= rect.offset.x && y >= rect.offset.y && x < rect.offset.x + (int)rect.extent.width &&
           y < rect.offset.y + (int)rect.extent.height;
}

/* In the rect as in `whole`, outside as before. */
static void check_slot(const struct picture *p, const struct picture *whole, enum picture_slot slot,
                       double canary, VkRect2D rect, const char *what)
{
    uint32_t channels = picture_channels(slot);
    for (size_t i = 0; i < picture_texels(p) * channels; ++i) {
        double want = inside(p, i / channels, rect) ? whole->values[slot][i] : canary;
        if (!(p->values[slot][i] == want))
            fail_msg("%s: texel %zu,%zu is %.9g, want %.9g", what, i / channels % p->width,
                     i / channels / p->width, p->values[slot][i], want);
    }
}

static VkRect2D grown(VkRect2D rect, int by, const struct picture *p)
{
    int x0 = rect.offset.x - by, y0 = rect.offset.y - by;
    int x1 = rect.offset.x + (int)rect.extent.width + by,
        y1 = rect.offset.y + (int)rect.extent.height + by;
    x0 = x0 < 0 ? 0 : x0;
    y0 = y0 < 0 ? 0 : y0;
    x1 = x1 > (int)p->width ? (int)p->width : x1;
    y1 = y1 > (int)p->height ? (int)p->height : y1;
    return (VkRect2D){{x0, y0}, {(uint32_t)(x1 - x0), (uint32_t)(y1 - y0)}};
}

static void rect_leaves_exterior_untouched(void **state)
{
    (void)state;
    static const VkRect2D rects[] = {
        {{13, 11}, {37, 29}}, {{0, 0}, {1, 1}},    {{79, 59}, {1, 1}},
        {{0, 20}, {80, 3}},   {{64, 0}, {16, 60}},
    };
    struct picture whole;
    make(&whole);
    double ao = whole.values[SLOT_AO][0], noisy = whole.values[SLOT_NOISY][0],
           out = whole.values[SLOT_OUTPUT][0];
    picture_run(&whole);
    for (size_t i = 0; i < sizeof rects / sizeof rects[0]; ++i) {
        struct picture p;
        make(&p);
        p.view.rect = rects[i];
        picture_run(&p);
        check_slot(&p, &whole, SLOT_AO, ao, rects[i], "ao");
        check_slot(&p, &whole, SLOT_OUTPUT, out, rects[i], "output");
        check_slot(&p, &whole, SLOT_NOISY, noisy, grown(rects[i], (int)p.blur.radius, &p),
                   "ao_noisy");
        picture_free(&p);
    }
    picture_free(&whole);
}

static void split_rects_equal_the_whole(void **state)
{
    (void)state;
    static const VkRect2D parts[] = {
        {{0, 0}, {33, 60}}, {{33, 0}, {47, 17}}, {{33, 17}, {1, 43}}, {{34, 17}, {46, 43}}};
    struct picture whole, split;
    struct picture_gpu g;
    make(&whole);
    make(&split);
    picture_run(&whole);
    picture_open(&split, &g);
    VkCommandBuffer cmd = gpu_begin(&fixture.gpu, &fixture.error);
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; ++i) {
        split.view.rect = parts[i];
        picture_record(&split, &g, cmd);
    }
    check(gpu_submit(&fixture.gpu, cmd, &fixture.error));
    picture_download(&split, &g);
    check_equal("ao", split.values[SLOT_AO], whole.values[SLOT_AO], picture_texels(&whole));
    check_equal("output", split.values[SLOT_OUTPUT], whole.values[SLOT_OUTPUT],
                picture_texels(&whole) * 4);
    picture_close(&g);
    picture_free(&whole);
    picture_free(&split);
}

/* Dynamic resolution: the valid part of a large image and a small image of that size. What lies
 * beyond is not read: the large one's other texels hold a wall right before the eye. */
static void check_valid_part(bool half_resolution)
{
    struct picture large, small;
    const struct scene scene = scene_corner();
    struct lens lens = lens_perspective(0.6, 0.45);
    make(&large);
    large.half_resolution = half_resolution;
    large.formats[SLOT_NOISY] = VK_FORMAT_UNDEFINED;
    large.view.valid = (VkRect2D){{0, 0}, {52, 39}};
    picture_render_scene(&large, &scene, &lens, VK_FORMAT_R32_SFLOAT,
                         VK_FORMAT_R32G32B32A32_SFLOAT);
    for (size_t i = 0; i < picture_texels(&large); ++i) {
        if (!inside(&large, i, large.view.valid))
            large.values[SLOT_DEPTH][i] = 0.125;
    }
    picture_init(&small, 52, 39, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR);
    small.half_resolution = half_resolution;
    small.view.depth_encoding = large.view.depth_encoding;
    small.view.normal_encoding = large.view.normal_encoding;
    picture_render_scene(&small, &scene, &lens, VK_FORMAT_R32_SFLOAT,
                         VK_FORMAT_R32G32B32A32_SFLOAT);
    picture_set(&small, SLOT_AO, VK_FORMAT_R32_SFLOAT, NULL);
    double canary = large.values[SLOT_AO][0];
    struct picture_gpu g;
    VkRect2D valid = large.view.valid, nowhere = {{79, 59}, {1, 1}};
    picture_open(&large, &g);
    VkCommandBuffer cmd = gpu_begin(&fixture.gpu, &fixture.error);
    /* First the whole image, so that scratch knows the wall; it writes one texel that is not looked
     * at. */
    large.view.valid = (VkRect2D){{0, 0}, {80, 60}};
    large.view.rect = nowhere;
    picture_record(&large, &g, cmd);
    large.view.valid = valid;
    large.view.rect = (VkRect2D){{0, 0}, {0, 0}};
    picture_record(&large, &g, cmd);
    check(gpu_submit(&fixture.gpu, cmd, &fixture.error));
    picture_download(&large, &g);
    picture_close(&g);
    picture_run(&small);
    for (size_t i = 0; i < picture_texels(&large); ++i) {
        double want = canary;
        if (inside(&large, i, nowhere))
            continue;
        if (inside(&large, i, valid))
            want = small.values[SLOT_AO][i / large.width * small.width + i % large.width];
        assert_true(large.values[SLOT_AO][i] == want);
    }
    picture_free(&large);
    picture_free(&small);
}

static void valid_part_equals_a_cropped_image(void **state)
{
    (void)state;
    check_valid_part(false);
    check_valid_part(true);
}

typedef void method_reference(const struct ref_scene *scene, const struct ao_ssao *params,
                              double *ao);

static void check_with_an_offset(VkRect2D valid, VkRect2D rect, vkao_ssao_method method,
                                 method_reference *method_ao, double mean, double p99, double most)
{
    struct picture p;
    struct ref_scene reference;
    const struct scene scene = scene_corner();
    struct lens lens = lens_perspective(0.6, 0.45);
    char what[64];
    picture_make(&p, VKAO_STAGE_SSAO, &scene);
    p.view.valid = valid;
    p.view.rect = rect;
    p.view.depth_encoding = VKAO_DEPTH_VIEW_Z;
    p.ssao.method = method;
    picture_render_scene(&p, &scene, &lens, VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT);
    /* Something in the last column, a texel wide. */
    const int32_t last = valid.offset.x + (int32_t)valid.extent.width - 1;
    for (int32_t y = 0; y < (int32_t)p.height; ++y)
        p.values[SLOT_DEPTH][y * (int32_t)p.width + last] *= 0.9;
    double *expected = test_alloc(picture_texels(&p), sizeof *expected);
    memcpy(expected, p.values[SLOT_AO], picture_texels(&p) * sizeof *expected);
    picture_run(&p);
    picture_reference_scene(&p, &reference);
    method_ao(&reference, &p.ssao, expected);
    snprintf(what, sizeof what, "valid (%d,%d) %ux%u", valid.offset.x, valid.offset.y,
             valid.extent.width, valid.extent.height);
    check_close(what, p.values[SLOT_AO], expected, picture_texels(&p), mean, p99, most);
    ref_scene_free(&reference);
    free(expected);
    picture_free(&p);
}

/* The last columns and rows count as well, which groups of passes reach only just. */
static void valid_part_with_an_offset_agrees_with_the_reference(void **state)
{
    (void)state;
    check_with_an_offset((VkRect2D){{17, 9}, {50, 40}}, (VkRect2D){{20, 9}, {47, 33}},
                         VKAO_SSAO_HEMISPHERE, ref_hemisphere, 1e-4, 1e-3, 0.02);
    for (int x = 0; x < 4; ++x) {
        const VkRect2D valid = {{4 + x, 5}, {46, 38}};
        check_with_an_offset(valid, valid, VKAO_SSAO_VBAO, ref_vbao, 1e-3, 2e-2, 0.2);
    }
}

static void stage_by_stage_equals_all(void **state)
{
    (void)state;
    struct picture all, stages;
    struct picture_gpu g;
    make(&all);
    make(&stages);
    picture_run(&all);
    picture_open(&stages, &g);
    VkCommandBuffer cmd = gpu_begin(&fixture.gpu, &fixture.error);
    picture_record_stages(&stages, &g, cmd, VKAO_STAGE_PREPARE);
    picture_record_stages(&stages, &g, cmd, VKAO_STAGE_SSAO);
    picture_record_stages(&stages, &g, cmd, VKAO_STAGE_BLUR);
    picture_record_stages(&stages, &g, cmd, VKAO_STAGE_COMPOSITE);
    check(gpu_submit(&fixture.gpu, cmd, &fixture.error));
    picture_download(&stages, &g);
    check_equal("ao_noisy", stages.values[SLOT_NOISY], all.values[SLOT_NOISY],
                picture_texels(&all));
    check_equal("ao", stages.values[SLOT_AO], all.values[SLOT_AO], picture_texels(&all));
    check_equal("output", stages.values[SLOT_OUTPUT], all.values[SLOT_OUTPUT],
                picture_texels(&all) * 4);
    picture_close(&g);
    picture_free(&all);
    picture_free(&stages);
}

/* The images that one stage hands to the next may be scratch, which a CPU keeps in buffers: a byte
 * per texel of noisy AO, so a hundredth of it, is rounded before the blur takes its mean. */
static void scratch_images_give_the_same_output(void **state)
{
    (void)state;
    struct picture own, scratch;
    make(&own);
    picture_set(&own, SLOT_AO, VK_FORMAT_R16_SFLOAT, NULL);
    make(&scratch);
    scratch.formats[SLOT_AO] = scratch.formats[SLOT_NOISY] = VK_FORMAT_UNDEFINED;
    picture_run(&own);
    picture_run(&scratch);
    check_close("output", scratch.values[SLOT_OUTPUT], own.values[SLOT_OUTPUT],
                picture_texels(&own) * 4, 5e-4, 3e-3, 6e-3);
    picture_free(&own);
    picture_free(&scratch);
}

static void each_stage_alone_continues_where_the_last_one_ended(void **state)
{
    (void)state;
    struct picture all, ssao, blur, composite;
    make(&all);
    picture_set(&all, SLOT_NOISY, VK_FORMAT_R32_SFLOAT, NULL);
    picture_run(&all);

    make(&ssao); /* without BLUR the SSAO stage writes ao itself */
    ssao.stages = VKAO_STAGE_SSAO;
    picture_run(&ssao);
    check_equal("ssao alone", ssao.values[SLOT_AO], all.values[SLOT_NOISY], picture_texels(&all));
    assert_true(ssao.values[SLOT_NOISY][0] <
                0.63); /* the canary: a slot that this frame does not use */

    make(&blur);
    blur.stages = VKAO_STAGE_BLUR;
    picture_set(&blur, SLOT_NOISY, VK_FORMAT_R32_SFLOAT, ssao.values[SLOT_AO]);
    picture_run(&blur);
    /* View z, which weighs the blur, has thickness in its last bits only where vbao runs. */
    check_close("blur alone", blur.values[SLOT_AO], all.values[SLOT_AO], picture_texels(&all), 5e-6,
                1e-4, 5e-4);

    make(&composite);
    composite.stages = VKAO_STAGE_COMPOSITE;
    picture_set(&composite, SLOT_AO, VK_FORMAT_R32_SFLOAT, all.values[SLOT_AO]);
    picture_run(&composite);
    check_equal("composite alone", composite.values[SLOT_OUTPUT], all.values[SLOT_OUTPUT],
                picture_texels(&all) * 4);
    picture_free(&all);
    picture_free(&ssao);
    picture_free(&blur);
    picture_free(&composite);
}

static void update_points_the_frame_at_other_images(void **state)
{
    (void)state;
    struct picture first, second, expected;
    struct picture_gpu a, b;
    const struct scene other = scene_steps();
    struct lens lens = lens_perspective(0.6, 0.45);
    make(&first);
    make(&second);
    make(&expected);
    picture_render_scene(&second, &other, &lens, VK_FORMAT_R32_SFLOAT,
                         VK_FORMAT_R32G32B32A32_SFLOAT);
    picture_render_scene(&expected, &other, &lens, VK_FORMAT_R32_SFLOAT,
                         VK_FORMAT_R32G32B32A32_SFLOAT);
    picture_run(&expected);
    picture_open(&first, &a);
    picture_open(&second, &b);
    check_vkao(vkao_frame_update(a.frame, &b.slots));
    VkCommandBuffer cmd = gpu_begin(&fixture.gpu, &fixture.error);
    picture_record(&first, &a, cmd);
    check(gpu_submit(&fixture.gpu, cmd, &fixture.error));
    double canary = first.values[SLOT_AO][0];
    picture_download(&first, &a);
    picture_download(&second, &b);
    assert_true(first.values[SLOT_AO][0] == canary && first.values[SLOT_AO][4799] == canary);
    check_equal("ao", second.values[SLOT_AO], expected.values[SLOT_AO], picture_texels(&expected));
    check_equal("output", second.values[SLOT_OUTPUT], expected.values[SLOT_OUTPUT],
                picture_texels(&expected) * 4);

    /* Another format is refused, and the frame still works. */
    vkao_images wrong = a.slots;
    wrong.ao.format = VK_FORMAT_R16_SFLOAT;
    assert_int_equal(vkao_frame_update(a.frame, &wrong), VKAO_ERROR_INVALID_ARGUMENT);
    cmd = gpu_begin(&fixture.gpu, &fixture.error);
    picture_record(&second, &a, cmd);
    check(gpu_submit(&fixture.gpu, cmd, &fixture.error));
    picture_close(&a);
    picture_close(&b);
    picture_free(&first);
    picture_free(&second);
    picture_free(&expected);
}

static void static_noise_repeats_bit_for_bit(void **state)
{
    (void)state;
    struct picture p;
    struct picture_gpu g;
    make(&p);
    picture_open(&p, &g);
    double *before = test_alloc(picture_texels(&p), sizeof *before);
    for (int i = 0; i < 3; ++i) {
        VkCommandBuffer cmd = gpu_begin(&fixture.gpu, &fixture.error);
        picture_record(&p, &g, cmd);
        check(gpu_submit(&fixture.gpu, cmd, &fixture.error));
        picture_download(&p, &g);
        if (i > 0)
            check_equal("ao", p.values[SLOT_AO], before, picture_texels(&p));
        memcpy(before, p.values[SLOT_AO], picture_texels(&p) * sizeof *before);
    }
    free(before);
    picture_close(&g);
    picture_free(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        gpu_test(rect_leaves_exterior_untouched),
        gpu_test(split_rects_equal_the_whole),
        gpu_test(valid_part_equals_a_cropped_image),
        gpu_test(valid_part_with_an_offset_agrees_with_the_reference),
        gpu_test(stage_by_stage_equals_all),
        gpu_test(scratch_images_give_the_same_output),
        gpu_test(each_stage_alone_continues_where_the_last_one_ended),
        gpu_test(update_points_the_frame_at_other_images),
        gpu_test(static_noise_repeats_bit_for_bit),
    };
    return fixture_run(tests);
}
