/* SPDX-License-Identifier: MIT
 *
 * Scratch in buffers: which contexts have it, what frames of them create, and the strips in which
 * their blur goes down the image. */
#include "pipelines.h"
#include "world.h"

#include <stdio.h>
#include <string.h>

/* A CPU, without ao_noisy, not opened yet. */
static void init(struct world *w)
{
    world_init(w, true);
    w->fake.device_type = VK_PHYSICAL_DEVICE_TYPE_CPU;
    w->images.ao_noisy = w->images.ao = (vkao_image){0};
}

static void open_context(struct world *w)
{
    assert_int_equal(vkao_context_create(&w->info, &w->ctx), VKAO_SUCCESS);
    fake_forget_calls(&w->fake);
}

static void layout_follows_device_and_info(void **state)
{
    (void)state;
    static const struct {
        VkPhysicalDeviceType type;
        vkao_scratch_layout layout;
        bool half_view_z, formats; /* the device stores R8_UINT and R16_UINT texels */
        bool buffers;
    } cases[] = {
        {VK_PHYSICAL_DEVICE_TYPE_CPU, VKAO_SCRATCH_AUTO, false, true, true},
        {VK_PHYSICAL_DEVICE_TYPE_CPU, VKAO_SCRATCH_AUTO, false, false, false},
        {VK_PHYSICAL_DEVICE_TYPE_CPU, VKAO_SCRATCH_AUTO, true, true, false},
        {VK_PHYSICAL_DEVICE_TYPE_CPU, VKAO_SCRATCH_IMAGES, false, true, false},
        {VK_PHYSICAL_DEVICE_TYPE_CPU, VKAO_SCRATCH_IMAGES, true, true, false},
        {VK_PHYSICAL_DEVICE_TYPE_CPU, VKAO_SCRATCH_BUFFERS, false, true, true},
        {VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU, VKAO_SCRATCH_AUTO, false, true, false},
        {VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU, VKAO_SCRATCH_AUTO, false, true, false},
        {VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU, VKAO_SCRATCH_IMAGES, false, false, false},
        {VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU, VKAO_SCRATCH_BUFFERS, false, true, true},
    };
    for (size_t i = 0; i < COUNT(cases); ++i) {
        struct world w;
        init(&w);
        w.fake.device_type = cases[i].type;
        w.fake.buffer_features = cases[i].formats ? VK_FORMAT_FEATURE_STORAGE_TEXEL_BUFFER_BIT : 0u;
        w.features.shaderStorageImageExtendedFormats = VK_TRUE;
        w.info.scratch_layout = cases[i].layout;
        w.info.half_view_z = cases[i].half_view_z;
        open_context(&w);
        assert_int_equal(vkao_frame_create(w.ctx, &w.frame_info, &w.frame), VKAO_SUCCESS);
        assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_BUFFER), cases[i].buffers ? 1 : 0);
        /* AO alone, or view z, noisy, halfway and AO. */
        assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_IMAGE), cases[i].buffers ? 1 : 4);
        world_close(&w);
    }
}

static void impossible_layouts_are_refused_and_named(void **state)
{
    (void)state;
    for (int type = 0; type < 2; ++type) {
        struct world w;
        init(&w);
        if (type)
            w.fake.device_type = VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU;
        w.features.shaderStorageImageExtendedFormats = VK_TRUE;
        w.info.scratch_layout = (vkao_scratch_layout)3;
        expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, vkao_context_create(&w.info, &w.ctx),
                       "context.scratch_layout", "3");
        w.info.scratch_layout = VKAO_SCRATCH_BUFFERS;
        w.info.half_view_z = VK_TRUE;
        expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, vkao_context_create(&w.info, &w.ctx),
                       "context.scratch_layout", "half_view_z");
        assert_int_equal(w.fake.call_count, 0);
        w.info.half_view_z = VK_FALSE;
        for (int i = 0; i < 2; ++i) {
            w.fake.no_texel_buffer = i ? VK_FORMAT_R16_UINT : VK_FORMAT_R8_UINT;
            expect_refused(&w, VKAO_ERROR_UNSUPPORTED, vkao_context_create(&w.info, &w.ctx),
                           "context.scratch_layout", i ? "R16_UINT" : "R8_UINT");
        }
        assert_null(w.ctx);
        world_close(&w);
    }
}

enum { HALF = 1, BENT = 2, NOISY = 4, COMBINATIONS = 8 };

/* False if the stages forbid the combination. */
static bool set_frame(struct world *w, vkao_stage_flags stages, unsigned what)
{
    const vkao_image noisy = {fake_caller_view(&w->fake), VK_IMAGE_LAYOUT_GENERAL,
                              VK_FORMAT_R8_UNORM};
    const vkao_stage_flags both = VKAO_STAGE_SSAO | VKAO_STAGE_BLUR;
    const bool has_both = (stages & both) == both;
    w->frame_info.stages = stages;
    w->frame_info.half_resolution = what & HALF ? VK_TRUE : VK_FALSE;
    if (what & BENT)
        w->images.bent_normals = w->bent_normals;
    if (what & NOISY)
        w->images.ao_noisy = noisy;
    if (!(stages & VKAO_STAGE_COMPOSITE) || !(stages & both))
        w->images.ao = noisy;
    if ((stages & both) == VKAO_STAGE_BLUR)
        return what == NOISY;
    return (!(what & (HALF | BENT)) || has_both) && (!(what & NOISY) || what == NOISY);
}

static void frames_have_one_buffer_and_no_view_z_image(void **state)
{
    (void)state;
    for (unsigned i = COMBINATIONS; i < (VKAO_STAGE_ALL + 1) * COMBINATIONS; ++i) {
        const vkao_stage_flags stages = i / COMBINATIONS;
        const unsigned what = i % COMBINATIONS;
        const bool makes_ao = stages != VKAO_STAGE_COMPOSITE;
        const bool blurs = stages & VKAO_STAGE_BLUR, ssao = stages & VKAO_STAGE_SSAO;
        const bool packed = blurs && ssao && !(what & (BENT | NOISY));
        struct world w;
        init(&w);
        open_context(&w);
        if (set_frame(&w, stages, what)) {
            VkMemoryRequirements need;
            assert_int_equal(vkao_frame_scratch(w.ctx, &w.frame_info, &need), VKAO_SUCCESS);
            fake_forget_calls(&w.fake);
            assert_int_equal(vkao_frame_create(w.ctx, &w.frame_info, &w.frame), VKAO_SUCCESS);
            const struct fake_call *allocation = fake_nth(&w.fake, "vkAllocateMemory", 0);
            assert_null(fake_nth(&w.fake, "vkAllocateMemory", 1));
            assert_true(allocation ? allocation->size == need.size : need.size == 0);
            /* The AO that COMPOSITE reads; noisy and halfway if the blur is not packed. */
            size_t images = (stages & VKAO_STAGE_COMPOSITE) && makes_ao ? 1 : 0;
            if (blurs && !packed)
                images += what & NOISY ? 1 : 2;
            assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_IMAGE), images);
            assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_BUFFER), makes_ao ? 1 : 0);
            /* Without strips of a blur there is nothing between its directions. */
            const size_t views = !makes_ao ? 0 : packed ? 7 : 6;
            assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_BUFFER_VIEW), views);
            for (size_t k = 0; fake_nth(&w.fake, "vkCreateImage", k); ++k)
                assert_true(fake_nth(&w.fake, "vkCreateImage", k)->image.extent.width <= 100);
            assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        }
        world_close(&w);
    }
}

static void frames_lie_in_memory_that_is_lent(void **state)
{
    (void)state;
    struct world w;
    init(&w);
    open_context(&w);
    w.frame_info.scratch_memory = fake_caller_memory(&w.fake);
    w.frame_info.scratch_offset = 1 << 20;
    assert_int_equal(vkao_frame_create(w.ctx, &w.frame_info, &w.frame), VKAO_SUCCESS);
    assert_int_equal(fake_count(&w.fake, "vkAllocateMemory"), 0);
    assert_int_equal(fake_nth(&w.fake, "vkBindBufferMemory", 0)->offset, 1 << 20);
    assert_true(fake_nth(&w.fake, "vkBindImageMemory", 0)->offset > 1 << 20);
    world_close(&w);
}

/* Of images 100 wide: each row has its padding and whole windows. */
enum {
    STRIDE = 100 + 4 + 2 * VKAO_BUFFER_PAD,
    RING = STRIDE * VKAO_RING_ROWS / 2, /* two texels in a word */
    HIGH = STRIDE * (200 + 2 * VKAO_VIEW_Z_BORDER)
};

/* Low images have more texels in the ring of the blur than in view z. */
static void too_large_frames_are_unsupported(void **state)
{
    (void)state;
    static const struct {
        uint32_t height, texels, bytes;
        const char *value; /* NULL = fits */
    } cases[] = {
        {200, HIGH, HIGH * 4, NULL},
        {200, HIGH - 1, HIGH * 4, "30704 texels"},
        {200, HIGH, HIGH * 4 - 1, "122815 bytes"},
        {60, RING, RING * 4, NULL},
        {60, RING - 1, RING * 4, "13376 texels"},
        {60, RING, RING * 4 - 1, "53503 bytes"},
    };
    for (size_t i = 0; i < COUNT(cases); ++i) {
        struct world w;
        VkMemoryRequirements need;
        init(&w);
        w.fake.max_texels = cases[i].texels;
        w.fake.max_buffer = cases[i].bytes;
        w.frame_info.extent.height = cases[i].height;
        open_context(&w);
        const size_t before = fake_live(&w.fake);
        const vkao_result query = vkao_frame_scratch(w.ctx, &w.frame_info, &need);
        if (cases[i].value) {
            expect_refused(&w, VKAO_ERROR_UNSUPPORTED, query, "frame.extent", cases[i].value);
            expect_refused(&w, VKAO_ERROR_UNSUPPORTED,
                           vkao_frame_create(w.ctx, &w.frame_info, &w.frame), "frame.extent",
                           cases[i].value);
            assert_null(w.frame);
            assert_int_equal(fake_live(&w.fake), before);
        } else {
            assert_int_equal(query, VKAO_SUCCESS);
            assert_int_equal(vkao_frame_create(w.ctx, &w.frame_info, &w.frame), VKAO_SUCCESS);
        }
        world_close(&w);
    }
}

/* Larger than 32 bits count. */
static void sizes_do_not_overflow(void **state)
{
    (void)state;
    struct world w;
    init(&w);
    w.fake.max_dimension = UINT16_MAX;
    w.fake.max_texels = w.fake.max_buffer = UINT32_MAX;
    open_context(&w);
    w.frame_info.extent = (VkExtent2D){UINT16_MAX, UINT16_MAX};
    expect_refused(&w, VKAO_ERROR_UNSUPPORTED, vkao_frame_create(w.ctx, &w.frame_info, &w.frame),
                   "frame.extent", "4298178608");
    world_close(&w);
}

static void failing_nth_call_leaks_nothing(void **state)
{
    (void)state;
    for (unsigned i = COMBINATIONS; i < (VKAO_STAGE_ALL + 1) * COMBINATIONS * 2; ++i) {
        const bool host = i & 1;
        if (i / 2 < COMBINATIONS)
            continue;
        unsigned n = 0;
        for (bool done = false; !done;) {
            struct world w;
            init(&w);
            open_context(&w);
            const bool possible = set_frame(&w, i / 2 / COMBINATIONS, i / 2 % COMBINATIONS);
            const size_t before = fake_live(&w.fake);
            w.host.fail_at = host ? w.host.total + ++n : 0;
            w.fake.fail_at = host ? 0 : w.fake.result_calls + ++n;
            w.frame = (vkao_frame *)&w;
            vkao_result result =
                possible ? vkao_frame_create(w.ctx, &w.frame_info, &w.frame) : VKAO_SUCCESS;
            w.frame = possible ? w.frame : NULL;
            done = !possible || (host ? w.host.total < w.host.fail_at : !w.fake.failed);
            assert_int_equal(result, done   ? VKAO_SUCCESS
                                     : host ? VKAO_ERROR_OUT_OF_HOST_MEMORY
                                            : VKAO_ERROR_VULKAN);
            assert_int_equal(w.log.errors, done ? 0 : 1);
            if (!done) {
                assert_null(w.frame);
                assert_int_equal(fake_live(&w.fake), before);
                if (!host)
                    assert_non_null(strstr(w.log.last_error, w.fake.failed));
            }
            world_close(&w);
        }
    }
}

/* --- The blur's strips --- */

static const struct vkao_rect nowhere = {0, 0, 0, 0};

/* What the ring holds: the image's row in each of its rows, or -1. */
struct ring {
    long rows[VKAO_RING_ROWS];
    struct vkao_rect written; /* between the directions */
    struct vkao_rect done;
};

static struct vkao_rect unpack(const uint32_t packed[2])
{
    return (struct vkao_rect){packed[0] & 0xffff, packed[0] >> 16, packed[1] & 0xffff,
                              packed[1] >> 16};
}

/* As blur_window.glsl has it. */
static long ring_row(const struct vkao_blur_block *block, long y)
{
    const long row = y - (long)(int32_t)block->ring_row;
    if (row < 0 || row >= 2 * VKAO_RING_ROWS)
        fail_msg("row %ld: the ring begins at row %d", y, (int)(int32_t)block->ring_row);
    return row >= VKAO_RING_ROWS ? row - VKAO_RING_ROWS : row;
}

/* Appends rows to those that are there. */
static void extend(struct vkao_rect *all, struct vkao_rect part)
{
    if (part.y0 == part.y1)
        return;
    if (all->y0 == all->y1) {
        *all = part;
        return;
    }
    assert_int_equal(part.x0, all->x0);
    assert_int_equal(part.x1, all->x1);
    assert_int_equal(part.y0, all->y1);
    all->y1 = part.y1;
}

static void run_direction(struct ring *ring, const struct vkao_blur_block *block, bool vertical)
{
    const struct vkao_rect rect = unpack(block->rect), valid = unpack(block->valid);
    const long radius = (long)block->radius;
    if (!vertical) {
        for (uint32_t y = rect.y0; y < rect.y1; ++y)
            ring->rows[ring_row(block, (long)y)] = (long)y;
        extend(&ring->written, rect);
        return;
    }
    /* Windows are of whole invocations: their last rows may lie below the rect, and are unused. */
    const uint32_t height = VKAO_BLUR_Y_HEIGHT;
    const uint32_t y1 = rect.y0 + (rect.y1 - rect.y0 + height - 1) / height * height;
    for (long y = (long)rect.y0 - radius; y < (long)y1 + radius; ++y) {
        const long row = ring_row(block, y);
        const bool used = y >= (long)valid.y0 && y < (long)valid.y1 && y < (long)rect.y1 + radius;
        if (used && ring->rows[row] != y)
            fail_msg("rows %u..%u, radius %ld: the ring has row %ld where %ld is read", rect.y0,
                     rect.y1, radius, ring->rows[row], y);
    }
    extend(&ring->done, rect);
}

/* Which stage a dispatch is of. */
static enum pipeline which_of(const struct world *w, uint64_t pipeline)
{
    const struct pipeline_entry *entry = entry_of(w->ctx, pipeline);
    assert_non_null(entry);
    assert_true(entry_is_general(entry) && !entry->bent);
    return entry->which;
}

/* Invocations begin at multiples of what the shader rounds to. */
static void check_cover(const struct world *w, const struct fake_call *dispatch,
                        enum pipeline which, struct vkao_rect rect)
{
    const VkExtent2D texels = pipeline_texels(w->ctx, which), group = pipeline_group(w->ctx, which);
    const uint32_t rows = which == PIPELINE_PACKED_UPSAMPLE ? texels.height : 1;
    const uint32_t x0 = rect.x0 / texels.width * texels.width, y0 = rect.y0 / rows * rows;
    if (x0 + dispatch->groups[0] * group.width * texels.width < rect.x1 ||
        y0 + dispatch->groups[1] * group.height * texels.height < rect.y1)
        fail_msg("pipeline %d: %ux%u groups do not cover (%u,%u)..(%u,%u)", (int)which,
                 dispatch->groups[0], dispatch->groups[1], rect.x0, rect.y0, rect.x1, rect.y1);
}

/* Follows a recorded blur. */
static void follow(const struct world *w, struct ring *ring, struct vkao_rect *upsampled)
{
    bool barrier = false;
    struct vkao_blur_block block;
    const struct fake_call *push = NULL;
    for (int i = 0; i < VKAO_RING_ROWS; ++i)
        ring->rows[i] = -1;
    ring->written = ring->done = *upsampled = nowhere;
    for (size_t i = 0; i < w->fake.call_count; ++i) {
        const struct fake_call *call = &w->fake.calls[i];
        barrier = barrier || strcmp(call->name, "vkCmdPipelineBarrier") == 0;
        push = strcmp(call->name, "vkCmdPushConstants") == 0 ? call : push;
        if (strcmp(call->name, "vkCmdDispatch") != 0)
            continue;
        assert_true(barrier);
        barrier = false;
        const enum pipeline which = which_of(w, call->handle);
        if (which == PIPELINE_PACKED_UPSAMPLE) {
            struct vkao_upsample_block last;
            memcpy(&last, push->push, sizeof last);
            *upsampled = unpack(last.rect);
            check_cover(w, call, which, *upsampled);
            continue;
        }
        assert_true(which == PIPELINE_PACKED_BLUR_X || which == PIPELINE_PACKED_BLUR_Y);
        assert_int_equal(push->push_bytes, sizeof block);
        memcpy(&block, push->push, sizeof block);
        check_cover(w, call, which, unpack(block.rect));
        run_direction(ring, &block, which == PIPELINE_PACKED_BLUR_Y);
    }
}

static void open_tall(struct world *w, VkExtent2D extent, bool half)
{
    init(w);
    open_context(w);
    w->frame_info.stages = VKAO_STAGE_SSAO | VKAO_STAGE_BLUR;
    w->images.ao =
        (vkao_image){fake_caller_view(&w->fake), VK_IMAGE_LAYOUT_GENERAL, VK_FORMAT_R32_SFLOAT};
    w->frame_info.extent = extent;
    w->frame_info.half_resolution = half;
    assert_int_equal(vkao_frame_create(w->ctx, &w->frame_info, &w->frame), VKAO_SUCCESS);
}

static void check_strips(struct world *w, uint32_t radius)
{
    struct ring ring;
    struct vkao_rect upsampled;
    struct view_constants view;
    w->blur.radius = radius;
    fake_forget_calls(&w->fake);
    assert_int_equal(vkao_cmd_blur(w->frame, world_cmd(w), &w->view, &w->blur), VKAO_SUCCESS);
    follow(w, &ring, &upsampled);
    assert_int_equal(
        frame_view_check(w->frame, world_cmd(w), "test", VKAO_STAGE_BLUR, &w->view, &view),
        VKAO_SUCCESS);
    const struct view_constants grid = frame_grid(w->frame, &view);
    const struct vkao_rect halfway = rect_grow(grid.rect, 0, radius, grid.valid);
    assert_memory_equal(&ring.done, &grid.rect, sizeof ring.done);
    assert_memory_equal(&ring.written, &halfway, sizeof ring.written);
    if (w->frame_info.half_resolution)
        assert_memory_equal(&upsampled, &view.rect, sizeof upsampled);
}

static void strips_cover_all_rows_once_in_order(void **state)
{
    (void)state;
    static const struct {
        uint32_t height;
        VkRect2D valid, rect;
    } cases[] = {
        {700, {{0, 0}, {0, 0}}, {{0, 0}, {0, 0}}},
        {700, {{0, 0}, {0, 0}}, {{0, 300}, {100, 260}}},
        {700, {{0, 0}, {0, 0}}, {{33, 287}, {7, 300}}},
        {700, {{0, 0}, {0, 0}}, {{33, 699}, {7, 1}}},
        {700, {{4, 290}, {90, 400}}, {{0, 0}, {0, 0}}},
        {700, {{4, 10}, {90, 600}}, {{5, 11}, {80, 259}}},
        {VKAO_STRIP_ROWS, {{0, 0}, {0, 0}}, {{0, 0}, {0, 0}}},
        {VKAO_STRIP_ROWS + 1, {{0, 0}, {0, 0}}, {{0, 0}, {0, 0}}},
        {VKAO_RING_ROWS, {{0, 0}, {0, 0}}, {{0, 0}, {0, 0}}},
        {513, {{0, 0}, {0, 0}}, {{0, 1}, {1, 512}}},
        {1, {{0, 0}, {0, 0}}, {{0, 0}, {0, 0}}},
        {4096, {{0, 0}, {0, 0}}, {{0, 0}, {0, 0}}},
    };
    for (size_t i = 0; i < COUNT(cases) * 2; ++i) {
        struct world w;
        open_tall(&w, (VkExtent2D){100, cases[i / 2].height}, i & 1);
        w.view.valid = cases[i / 2].valid;
        w.view.rect = cases[i / 2].rect;
        for (uint32_t radius = 0; radius <= 16; ++radius)
            check_strips(&w, radius);
        world_close(&w);
    }
}

/* Every offset of a short rect, also where strips and groups begin. */
static void strips_begin_anywhere(void **state)
{
    (void)state;
    for (int half = 0; half < 2; ++half) {
        struct world w;
        open_tall(&w, (VkExtent2D){100, 700}, half);
        for (int32_t y = 0; y < 700 - 272; ++y) {
            const uint32_t heights[] = {1, 16, 17, 256, 272};
            w.view.rect = (VkRect2D){{y % 80, y}, {16, heights[y % 5]}};
            check_strips(&w, (uint32_t)y % 17);
            w.view.rect = (VkRect2D){{y % 80, y}, {17, 16}};
            check_strips(&w, 16);
        }
        world_close(&w);
    }
}

/* Windows of blur_x_buffers.comp are of whole words and invocations; those of the last row must not
 * leave the part. */
static void windows_stay_inside_their_rows(void **state)
{
    (void)state;
    for (uint32_t width = 1; width < 70; ++width) {
        struct world w;
        open_tall(&w, (VkExtent2D){width, 3}, false);
        const struct scratch_buffer *buffer = &w.frame->scratch.buffer;
        const uint32_t windows = (width + VKAO_BLUR_X_WIDTH - 1) / VKAO_BLUR_X_WIDTH;
        const uint32_t reach = 16; /* of the largest radius, in whole words */
        assert_true(VKAO_BUFFER_PAD >= reach);
        assert_true(VKAO_BUFFER_PAD + windows * VKAO_BLUR_X_WIDTH + reach <= buffer->stride);
        assert_int_equal(buffer->parts[PART_PACKED].bytes, buffer->stride * 3);
        assert_int_equal(buffer->parts[PART_VIEW_Z].bytes, buffer->stride * 5 * 4);
        world_close(&w);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(layout_follows_device_and_info),
        cmocka_unit_test(impossible_layouts_are_refused_and_named),
        cmocka_unit_test(frames_have_one_buffer_and_no_view_z_image),
        cmocka_unit_test(frames_lie_in_memory_that_is_lent),
        cmocka_unit_test(too_large_frames_are_unsupported),
        cmocka_unit_test(sizes_do_not_overflow),
        cmocka_unit_test(failing_nth_call_leaks_nothing),
        cmocka_unit_test(strips_cover_all_rows_once_in_order),
        cmocka_unit_test(strips_begin_anywhere),
        cmocka_unit_test(windows_stay_inside_their_rows),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
