/* SPDX-License-Identifier: MIT
 *
 * Half resolution and bent normals as frames know them: which combinations exist, how much scratch
 * they take, and which texels each dispatch covers. */
#include "internal.h"
#include "world.h"

#include <stdio.h>
#include <string.h>

/* Every combination of stages, half resolution, bent normals and ao_noisy. */
static void combinations_follow_the_header(void **state)
{
    (void)state;
    const vkao_stage_flags both = VKAO_STAGE_SSAO | VKAO_STAGE_BLUR;
    for (unsigned i = 8; i < (VKAO_STAGE_ALL + 1) * 8; ++i) {
        const vkao_stage_flags stages = i / 8;
        const bool half = i & 1, bent = i & 2, noisy = i & 4, has_both = (stages & both) == both;
        const bool needs_noisy = (stages & both) == VKAO_STAGE_BLUR;
        struct world w;
        world_open(&w);
        w.frame_info.stages = stages;
        w.frame_info.half_resolution = half;
        if (bent)
            w.images.bent_normals = w.bent_normals;
        if (!noisy)
            w.images.ao_noisy = (vkao_image){0};
        bool fits = !(half && (!has_both || noisy)) && !(needs_noisy && !noisy);
        /* A frame that only composites reads bent normals and ignores ao_noisy. */
        fits = fits && !(bent && (stages & both) && (!has_both || noisy));
        VkMemoryRequirements query;
        size_t before = fake_live(&w.fake);
        vkao_result created = vkao_frame_create(w.ctx, &w.frame_info, &w.frame);
        assert_int_equal(created, fits ? VKAO_SUCCESS : VKAO_ERROR_INVALID_ARGUMENT);
        if (!fits) {
            assert_int_equal(fake_live(&w.fake), before);
            const char *name = needs_noisy && !noisy ? "images.ao_noisy"
                               : half                ? "frame.half_resolution"
                                                     : "images.bent_normals";
            expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, created, name, "");
            expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT,
                           vkao_frame_scratch(w.ctx, &w.frame_info, &query), name, "");
        }
        world_close(&w);
    }
}

static void fields_out_of_range_are_refused_and_named(void **state)
{
    (void)state;
    static const struct {
        const char *name, *value;
        size_t offset;
        uint32_t v;
    } rows[] = {
        {"frame.half_resolution", "2", offsetof(vkao_frame_info, half_resolution), 2},
        {"frame.half_resolution", "4294967295", offsetof(vkao_frame_info, half_resolution),
         UINT32_MAX},
        {"reserved", "9", offsetof(vkao_frame_info, reserved), 9},
    };
    for (size_t i = 0; i < COUNT(rows); ++i) {
        struct world w;
        world_open(&w);
        w.images.ao_noisy = (vkao_image){0};
        memcpy((char *)&w.frame_info + rows[i].offset, &rows[i].v, sizeof rows[i].v);
        expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT,
                       vkao_frame_create(w.ctx, &w.frame_info, &w.frame), rows[i].name,
                       rows[i].value);
        assert_null(w.frame);
        world_close(&w);
    }
}

static void open_frame(struct world *w, bool half, bool bent, VkExtent2D extent)
{
    world_open(w);
    w->images.ao_noisy = w->images.ao = (vkao_image){0};
    if (bent)
        world_use_bent_normals(w);
    w->frame_info.half_resolution = half;
    w->frame_info.extent = extent;
    fake_forget_calls(&w->fake);
    assert_int_equal(vkao_frame_create(w->ctx, &w->frame_info, &w->frame), VKAO_SUCCESS);
}

/* All that the stages hand to each other has half the resolution, rounded up; what COMPOSITE reads
 * has all of it. */
static void scratch_has_half_the_resolution(void **state)
{
    (void)state;
    static const VkExtent2D extents[] = {{1, 1}, {2, 2}, {3, 1}, {100, 60}, {37, 23}, {64, 31}};
    for (size_t i = 0; i < COUNT(extents) * 4; ++i) {
        const VkExtent2D e = extents[i / 4];
        const bool half = i & 1, bent = i & 2;
        struct world w;
        open_frame(&w, half, bent, e);
        const uint32_t width = half ? (e.width + 1) / 2 : e.width;
        const uint32_t height = half ? (e.height + 1) / 2 : e.height;
        size_t full = 0, vectors = 0;
        assert_int_equal(fake_count(&w.fake, "vkCreateImage"), 4 + 4); /* and as many views */
        for (size_t k = 0; k < 4; ++k) {
            const VkImageCreateInfo *image = &fake_nth(&w.fake, "vkCreateImage", k)->image;
            const uint32_t border = k == 0 ? 2 : 0; /* of view z */
            bool small = image->extent.width == width + border &&
                         image->extent.height == height + border;
            vectors += image->format == VK_FORMAT_R16G16B16A16_SFLOAT;
            full += !small;
            if (!small) {
                assert_int_equal(image->extent.width, e.width);
                assert_int_equal(image->extent.height, e.height);
                assert_int_equal(image->format, VK_FORMAT_R16_SFLOAT);
            }
        }
        assert_int_equal(full, half && e.width * e.height > 1 ? 1 : 0);
        assert_int_equal(vectors, bent ? 2 : 0); /* noisy and halfway */
        VkMemoryRequirements query;
        const struct fake_call *allocation = fake_nth(&w.fake, "vkAllocateMemory", 0);
        assert_int_equal(vkao_frame_scratch(w.ctx, &w.frame_info, &query), VKAO_SUCCESS);
        assert_int_equal(query.size, allocation->size);
        world_close(&w);
    }
}

static void odd_valid_origins_are_refused(void **state)
{
    (void)state;
    struct world w;
    open_frame(&w, true, false, (VkExtent2D){100, 60});
    for (int32_t i = 0; i < 16; ++i) {
        const VkOffset2D at = {i % 4, i / 4};
        char value[32];
        snprintf(value, sizeof value, "(%d,%d)", at.x, at.y);
        w.view.valid = (VkRect2D){at, {51, 31}};
        fake_forget_calls(&w.fake);
        vkao_result results[5] = {
            vkao_cmd_prepare(w.frame, world_cmd(&w), &w.view),
            vkao_cmd_ssao(w.frame, world_cmd(&w), &w.view, &w.ssao),
            vkao_cmd_blur(w.frame, world_cmd(&w), &w.view, &w.blur),
            vkao_cmd_composite(w.frame, world_cmd(&w), &w.view, &w.composite),
            world_record_all(&w),
        };
        bool even = at.x % 2 == 0 && at.y % 2 == 0;
        for (int k = 0; k < 5; ++k)
            assert_int_equal(results[k], even ? VKAO_SUCCESS : VKAO_ERROR_INVALID_ARGUMENT);
        if (!even) {
            assert_int_equal(w.log.errors, 5);
            assert_non_null(strstr(w.log.last_error, "view.valid"));
            assert_non_null(strstr(w.log.last_error, value));
            expect_nothing_recorded(&w);
            world_forget_log(&w);
        }
    }
    world_close(&w);
}

/* Groups cover want and not one more; the block holds want at the offset. */
static void check_cover(const struct world *w, size_t index, struct vkao_rect want, size_t offset)
{
    const struct fake_call *dispatch = fake_nth(&w->fake, "vkCmdDispatch", index);
    const struct fake_call *push = fake_nth(&w->fake, "vkCmdPushConstants", index);
    uint32_t packed[2];
    assert_non_null(dispatch);
    assert_int_equal(dispatch->groups[0],
                     (want.x1 - want.x0 + VKAO_GROUP_WIDTH - 1) / VKAO_GROUP_WIDTH);
    assert_int_equal(dispatch->groups[1],
                     (want.y1 - want.y0 + VKAO_GROUP_HEIGHT - 1) / VKAO_GROUP_HEIGHT);
    rect_pack(want, packed);
    if (memcmp(push->push + offset, packed, sizeof packed) != 0)
        fail_msg("dispatch %zu does not cover (%u,%u)..(%u,%u)", index, want.x0, want.y0, want.x1,
                 want.y1);
}

/* Texel (x, y) of the half-resolution grid is (2x, 2y) of the image. The upsampling of texel t
 * reads the grid from t/2 - 1 to t/2 + 2, the blur reads blur.radius further, all inside the grid's
 * valid part. */
static void dispatch_covers_what_the_upsampling_reads(void **state)
{
    (void)state;
    static const struct {
        VkRect2D valid, rect;
        struct vkao_rect prepare, ssao, blur_x, blur_y, upsample;
    } cases[] = {
        /* blur radius 3 */
        {{{0, 0}, {0, 0}},
         {{0, 0}, {0, 0}},
         {0, 0, 51, 30},
         {0, 0, 51, 30},
         {0, 0, 51, 30},
         {0, 0, 51, 30},
         {0, 0, 101, 59}},
        {{{0, 0}, {0, 0}},
         {{50, 30}, {1, 1}},
         {0, 0, 51, 30},
         {21, 11, 31, 21},
         {24, 11, 28, 21},
         {24, 14, 28, 18},
         {50, 30, 51, 31}},
        {{{0, 0}, {0, 0}},
         {{51, 31}, {1, 1}},
         {0, 0, 51, 30},
         {21, 11, 31, 21},
         {24, 11, 28, 21},
         {24, 14, 28, 18},
         {51, 31, 52, 32}},
        {{{20, 10}, {41, 21}},
         {{21, 11}, {2, 3}},
         {10, 5, 31, 16},
         {10, 5, 17, 12},
         {10, 5, 14, 12},
         {10, 5, 14, 9},
         {21, 11, 23, 14}},
        {{{20, 10}, {41, 21}},
         {{59, 30}, {2, 1}},
         {10, 5, 31, 16},
         {25, 11, 31, 16},
         {28, 11, 31, 16},
         {28, 14, 31, 16},
         {59, 30, 61, 31}},
    };
    for (size_t i = 0; i < COUNT(cases); ++i) {
        struct world w;
        open_frame(&w, true, false, (VkExtent2D){101, 59});
        w.view.valid = cases[i].valid;
        w.view.rect = cases[i].rect;
        w.blur.radius = 3;
        fake_forget_calls(&w.fake);
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        check_cover(&w, 0, cases[i].prepare, offsetof(struct vkao_prepare_block, valid));
        check_cover(&w, 1, cases[i].ssao, offsetof(struct vkao_ssao_block, rect));
        check_cover(&w, 2, cases[i].blur_x, offsetof(struct vkao_blur_block, rect));
        check_cover(&w, 3, cases[i].blur_y, offsetof(struct vkao_blur_block, rect));
        check_cover(&w, 4, cases[i].upsample, offsetof(struct vkao_upsample_block, rect));
        check_cover(&w, 5, cases[i].upsample, offsetof(struct vkao_composite_block, rect));
        assert_int_equal(fake_count(&w.fake, "vkCmdDispatch"), 6);
        world_close(&w);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(combinations_follow_the_header),
        cmocka_unit_test(fields_out_of_range_are_refused_and_named),
        cmocka_unit_test(scratch_has_half_the_resolution),
        cmocka_unit_test(odd_valid_origins_are_refused),
        cmocka_unit_test(dispatch_covers_what_the_upsampling_reads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
