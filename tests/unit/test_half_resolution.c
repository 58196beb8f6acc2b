/* SPDX-License-Identifier: MIT
 *
 * Half resolution and bent normals as frames know them: which combinations exist, how much scratch
 * they take, and which texels each dispatch covers. */
#include "recording.h"
#include "stages.h"
#include "world.h"

#include <stdio.h>
#include <string.h>

static void open_frame(struct world *w, bool half, bool bent, VkExtent2D extent)
{
    world_open(w);
    world_use_scratch_noise(w);
    w->images.ao = (vkao_image){0};
    if (bent)
        world_use_bent_normals(w);
    w->effect_info.half_resolution = half;
    w->frame_info.extent = extent;
    world_create_effect(w);
    fake_forget_calls(&w->fake);
    assert_int_equal(vkao_frame_create(w->effect, &w->frame_info, &w->frame), VKAO_SUCCESS);
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
        size_t full = 0, vectors = 0, codes = 0;
        /* View z, noisy AO, AO; bent normals beside the noisy AO, and what upsampling reads. */
        const size_t images = 3u + bent + half;
        assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_IMAGE), images);
        for (size_t k = 0; k < images; ++k) {
            const VkImageCreateInfo *image = &fake_nth(&w.fake, "vkCreateImage", k)->image;
            const VkExtent2D view_z = vkao_view_z_extent((VkExtent2D){width, height});
            const bool is_view_z = image->format == VK_FORMAT_R32_SFLOAT;
            bool small = image->extent.width == (is_view_z ? view_z.width : width) &&
                         image->extent.height == (is_view_z ? view_z.height : height);
            vectors += image->format == VK_FORMAT_R16G16B16A16_SFLOAT;
            codes += image->format == VK_FORMAT_R8G8B8A8_UNORM;
            full += !small;
            if (!small) {
                assert_int_equal(image->extent.width, e.width);
                assert_int_equal(image->extent.height, e.height);
                assert_int_equal(image->format, VK_FORMAT_R16_SFLOAT);
            }
        }
        assert_int_equal(full, half && e.width * e.height > 1 ? 1 : 0);
        assert_int_equal(vectors, bent && half ? 1 : 0);
        assert_int_equal(codes, bent ? 1 : 0);
        VkMemoryRequirements query;
        const struct fake_call *allocation = fake_nth(&w.fake, "vkAllocateMemory", 0);
        assert_int_equal(vkao_frame_scratch(w.effect, &w.frame_info, &query), VKAO_SUCCESS);
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
        vkao_result results[5];
        for (int k = 0; k < 4; ++k) {
            const vkao_stage_flags stages[] = {VKAO_STAGE_PREPARE, VKAO_STAGE_SSAO, VKAO_STAGE_BLUR,
                                               VKAO_STAGE_COMPOSITE};
            results[k] = vkao_cmd_stage(w.frame, world_cmd(&w), stages[k], &w.view, &w.params);
        }
        results[4] = world_record_all(&w);
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

/* Groups of that size cover want, from even texels on if it is begun there, and not one more; the
 * push constants hold want. */
static void check_cover(const struct world *w, size_t index, struct vkao_rect want, uint32_t width,
                        uint32_t height, uint32_t begins)
{
    const struct fake_call *dispatch = fake_nth(&w->fake, "vkCmdDispatch", index);
    const VkExtent2D view_z = vkao_view_z_extent((VkExtent2D){want.x1, want.y1});
    /* of prepare */
    const uint32_t border_x = index == 0 ? view_z.width - want.x1 : 0,
                   border_y = index == 0 ? view_z.height - want.y1 : 0;
    const struct fake_call *push = fake_nth(&w->fake, "vkCmdPushConstants", index);
    uint32_t packed[2];
    assert_non_null(dispatch);
    assert_int_equal(dispatch->groups[0],
                     (want.x1 - want.x0 / begins * begins + border_x + width - 1) / width);
    assert_int_equal(dispatch->groups[1],
                     (want.y1 - want.y0 / begins * begins + border_y + height - 1) / height);
    vkao_rect_pack(want, packed);
    if (memcmp(push->push, packed, sizeof packed) != 0)
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
        struct vkao_rect ssao, blur, upsample;
    } cases[] = {
        /* blur radius 3 */
        {{{0, 0}, {0, 0}}, {{0, 0}, {0, 0}}, {0, 0, 51, 30}, {0, 0, 51, 30}, {0, 0, 101, 59}},
        {{{0, 0}, {0, 0}},
         {{50, 30}, {1, 1}},
         {21, 11, 31, 21},
         {24, 14, 28, 18},
         {50, 30, 51, 31}},
        {{{0, 0}, {0, 0}},
         {{51, 31}, {1, 1}},
         {21, 11, 31, 21},
         {24, 14, 28, 18},
         {51, 31, 52, 32}},
        {{{20, 10}, {41, 21}},
         {{21, 11}, {2, 3}},
         {10, 5, 17, 12},
         {10, 5, 14, 9},
         {21, 11, 23, 14}},
        {{{20, 10}, {41, 21}},
         {{59, 30}, {2, 1}},
         {25, 11, 31, 16},
         {28, 14, 31, 16},
         {59, 30, 61, 31}},
    };
    for (size_t i = 0; i < COUNT(cases); ++i) {
        struct world w;
        open_frame(&w, true, false, (VkExtent2D){101, 59});
        w.view.valid = cases[i].valid;
        w.view.rect = cases[i].rect;
        fake_forget_calls(&w.fake);
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        enum { WIDTH = VKAO_GROUP_WIDTH, HEIGHT = VKAO_GROUP_HEIGHT };
        check_cover(&w, 0, (struct vkao_rect){0, 0, 51, 30}, 2 * WIDTH, 2 * HEIGHT, 1);
        check_cover(&w, 1, cases[i].ssao, VKAO_SSAO_GROUP_WIDTH, VKAO_SSAO_GROUP_HEIGHT, 1);
        check_cover(&w, 2, cases[i].blur, VKAO_BLUR_TILE_WIDTH,
                    VKAO_BLUR_TILE_ROWS(2) - 2 * (VKAO_BLUR_TILE_RADIUS + 1), 1);
        check_cover(&w, 3, cases[i].upsample, 2 * WIDTH, 2 * HEIGHT, 2);
        check_cover(&w, 4, cases[i].upsample, WIDTH, HEIGHT, 1);
        assert_int_equal(fake_count(&w.fake, "vkCmdDispatch"), 5);
        world_close(&w);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scratch_has_half_the_resolution),
        cmocka_unit_test(odd_valid_origins_are_refused),
        cmocka_unit_test(dispatch_covers_what_the_upsampling_reads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
