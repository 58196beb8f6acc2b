/* SPDX-License-Identifier: MIT
 *
 * Tiles of SSAO, where scratch is in buffers: the list that starts anew before each SSAO, the
 * barriers around those who write and read it, and the tiles that may come to be in it. */
#include "pipelines.h"
#include "world.h"

#include <stdlib.h>
#include <string.h>

enum kind { PACKED, NOISY, BENT, ALONE, COMPOSITED, KINDS };

/* A CPU, with the context and a frame. */
static void open(struct world *w, VkExtent2D extent, enum kind kind, bool half)
{
    const vkao_image ao = {fake_caller_view(&w->fake), VK_IMAGE_LAYOUT_GENERAL, VK_FORMAT_R8_UNORM};
    w->fake.device_type = VK_PHYSICAL_DEVICE_TYPE_CPU;
    w->images.ao = w->images.ao_noisy = (vkao_image){0};
    w->frame_info.stages = VKAO_STAGE_SSAO | VKAO_STAGE_BLUR;
    w->frame_info.extent = extent;
    w->frame_info.half_resolution = half;
    if (kind == COMPOSITED)
        w->frame_info.stages = VKAO_STAGE_ALL;
    else
        w->images.ao = ao;
    if (kind == ALONE)
        w->frame_info.stages = VKAO_STAGE_SSAO;
    if (kind == NOISY)
        w->images.ao_noisy = ao;
    if (kind == BENT)
        w->images.bent_normals = w->bent_normals;
    assert_int_equal(vkao_context_create(&w->info, &w->ctx), VKAO_SUCCESS);
    assert_int_equal(vkao_frame_create(w->ctx, &w->frame_info, &w->frame), VKAO_SUCCESS);
    fake_forget_calls(&w->fake);
}

/* Of each kind of frame and each method that it has, at both resolutions if it has them. */
static bool next_world(struct world *w, unsigned i)
{
    const vkao_ssao_method method = (vkao_ssao_method)(i % VKAO_METHOD_COUNT);
    const enum kind kind = (enum kind)(i / VKAO_METHOD_COUNT % KINDS);
    const bool half = i / VKAO_METHOD_COUNT / KINDS;
    if ((half && (kind == NOISY || kind == ALONE)) ||
        (kind == BENT && !(VKAO_BENT_METHODS >> method & 1u)))
        return false;
    world_init(w, true);
    open(w, (VkExtent2D){101, 61}, kind, half);
    w->ssao.method = method;
    return true;
}
enum { WORLDS = VKAO_METHOD_COUNT * KINDS * 2 };

static bool is(const struct fake_call *call, const char *name)
{
    return strcmp(call->name, name) == 0;
}

static enum pipeline which_of(const struct world *w, const struct fake_call *dispatch)
{
    const struct pipeline_entry *entry = entry_of(w->ctx, dispatch->handle);
    assert_non_null(entry);
    return entry->which;
}

/* Where in the recording the parts of one SSAO are. */
struct parts {
    size_t prepare, update, tiles, ssao, after; /* after: the next dispatch, or the end */
};

/* From a call on. */
static struct parts find_parts(const struct world *w, size_t from)
{
    const size_t end = w->fake.call_count;
    struct parts p = {end, end, end, end, end};
    for (size_t i = from; i < end && p.after == end; ++i) {
        const struct fake_call *call = &w->fake.calls[i];
        if (is(call, "vkCmdUpdateBuffer")) {
            assert_true(p.update == end && p.tiles == end);
            p.update = i;
        } else if (is(call, "vkCmdDispatchIndirect")) {
            assert_true(p.ssao == end && p.tiles < i);
            p.ssao = i;
        } else if (is(call, "vkCmdDispatch")) {
            size_t *part = p.ssao < end                            ? &p.after
                           : which_of(w, call) == PIPELINE_PREPARE ? &p.prepare
                                                                   : &p.tiles;
            assert_true(*part == end);
            *part = i;
        }
    }
    assert_true(p.prepare < p.update && p.update < p.tiles && p.tiles < p.ssao && p.ssao < end);
    assert_int_equal(which_of(w, &w->fake.calls[p.tiles]), PIPELINE_TILES);
    assert_int_equal(which_of(w, &w->fake.calls[p.ssao]), PIPELINE_SSAO + (int)w->ssao.method);
    return p;
}

/* --- The list's head --- */

static void every_ssao_begins_a_list(void **state)
{
    (void)state;
    for (unsigned i = 0; i < WORLDS; ++i) {
        struct world w;
        if (!next_world(&w, i))
            continue;
        const struct scratch_buffer *buffer = &w.frame->scratch.buffer;
        const uint64_t handle = (uint64_t)(uintptr_t)buffer->buffer;
        const VkDeviceSize offset = buffer->parts[PART_TILES].offset;
        const struct vkao_tiles_head want = {8, 0, 1, 0};
        assert_int_equal(sizeof want, 16); /* then tiles, as std430 lays them out */
        assert_int_equal(VKAO_TILE_HEIGHT, 8);
        for (unsigned n = 0; n < 2; ++n) {
            fake_forget_calls(&w.fake);
            assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
            const struct parts p = find_parts(&w, 0);
            const struct fake_call *update = &w.fake.calls[p.update];
            assert_true(update->source == handle && update->offset == offset);
            assert_int_equal(update->size, sizeof want);
            assert_memory_equal(update->update, &want, sizeof want);
            /* Tiles are an indirect dispatch's groups in y, rows of a tile those in x. */
            assert_int_equal(offsetof(struct vkao_tiles_head, group_rows),
                             offsetof(VkDispatchIndirectCommand, x));
            assert_int_equal(offsetof(struct vkao_tiles_head, count),
                             offsetof(VkDispatchIndirectCommand, y));
            const struct fake_call *ssao = &w.fake.calls[p.ssao];
            assert_true(ssao->source == handle && ssao->offset == offset);
        }
        world_close(&w);
    }
}

static void images_have_no_lists(void **state)
{
    (void)state;
    for (vkao_stage_flags stages = 1; stages <= VKAO_STAGE_ALL; ++stages) {
        struct world w;
        world_open_frame(&w, stages);
        assert_null(general_entry(w.ctx, PIPELINE_TILES, false));
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        assert_int_equal(fake_count(&w.fake, "vkCmdUpdateBuffer"), 0);
        assert_int_equal(fake_count(&w.fake, "vkCmdDispatchIndirect"), 0);
        world_close(&w);
    }
}

/* --- Barriers --- */

struct scope {
    VkPipelineStageFlags stages;
    VkAccessFlags access;
};
static const struct scope shader_write = {VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                                          VK_ACCESS_SHADER_WRITE_BIT},
                          shader_any = {VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                                        VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT},
                          transfer_write = {VK_PIPELINE_STAGE_TRANSFER_BIT,
                                            VK_ACCESS_TRANSFER_WRITE_BIT},
                          indirect_read = {VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT,
                                           VK_ACCESS_INDIRECT_COMMAND_READ_BIT};

/* Whether one of the barriers between two calls makes the second scope wait for the first. */
static bool waits(const struct world *w, size_t from, size_t to, struct scope before,
                  struct scope after)
{
    for (size_t i = from; i < to; ++i) {
        const struct fake_call *call = &w->fake.calls[i];
        if (is(call, "vkCmdPipelineBarrier") && call->memory_barrier_count == 1 &&
            (call->src_stages & before.stages) == before.stages &&
            (call->dst_stages & after.stages) == after.stages &&
            (call->memory_barrier.srcAccessMask & before.access) == before.access &&
            (call->memory_barrier.dstAccessMask & after.access) == after.access)
            return true;
    }
    return false;
}

static void check_barriers(const struct world *w, const struct parts *p, size_t begin)
{
    /* What read and wrote the list last, maybe in another submit -> its new head */
    assert_true(waits(w, begin, p->update, shader_write, transfer_write));
    /* The head -> what counts in it */
    assert_true(waits(w, p->update, p->tiles, transfer_write, shader_any));
    /* View z -> what looks for sky in it; the last readers of AO -> what writes it */
    assert_true(waits(w, p->prepare, p->tiles, shader_write, shader_any));
    /* The count -> the dispatch by it; the list and open tiles -> SSAO */
    assert_true(waits(w, p->tiles, p->ssao, shader_write, indirect_read));
    assert_true(waits(w, p->tiles, p->ssao, shader_write, shader_any));
    /* AO -> its readers */
    if (p->after < w->fake.call_count)
        assert_true(waits(w, p->ssao, p->after, shader_write, shader_any));
}

static void lists_are_written_and_read_in_order(void **state)
{
    (void)state;
    for (unsigned i = 0; i < WORLDS; ++i) {
        struct world w;
        if (!next_world(&w, i))
            continue;
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        const size_t again = w.fake.call_count;
        const struct parts first = find_parts(&w, 0);
        check_barriers(&w, &first, 0);
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        const struct parts second = find_parts(&w, again);
        check_barriers(&w, &second, first.ssao);
        world_close(&w);
    }
}

/* Two of them without a prepare between. */
static void ssao_waits_for_the_ssao_before(void **state)
{
    (void)state;
    struct world w;
    world_init(&w, true);
    open(&w, (VkExtent2D){64, 64}, PACKED, false);
    assert_int_equal(vkao_cmd_ssao(w.frame, world_cmd(&w), &w.view, &w.ssao), VKAO_SUCCESS);
    size_t last = w.fake.call_count, update = 0;
    while (!is(&w.fake.calls[--last], "vkCmdDispatchIndirect"))
        continue;
    assert_int_equal(vkao_cmd_ssao(w.frame, world_cmd(&w), &w.view, &w.ssao), VKAO_SUCCESS);
    for (update = last; !is(&w.fake.calls[update], "vkCmdUpdateBuffer"); ++update)
        assert_true(update + 1 < w.fake.call_count);
    assert_true(waits(&w, last, update, shader_write, transfer_write));
    world_close(&w);
}

/* --- Tiles --- */

static struct vkao_rect unpack(const uint32_t packed[2])
{
    return (struct vkao_rect){packed[0] & 0xffff, packed[0] >> 16, packed[1] & 0xffff,
                              packed[1] >> 16};
}

/* What the invocations of tiles.comp look at: every tile once, and nothing else. */
static void run_tiles(const struct vkao_tiles_block *b, const struct fake_call *dispatch)
{
    const uint32_t columns = b->tiles[0], rows = b->tiles[1];
    unsigned char *seen = calloc(columns * rows, 1);
    uint32_t count = 0;
    assert_non_null(seen);
    for (uint32_t id = 0; id < dispatch->groups[0] * VKAO_ROW_GROUP_WIDTH; ++id) {
        const uint32_t strip = id / (b->strip_columns * rows), x0 = strip * b->strip_columns;
        const uint32_t left = id % (b->strip_columns * rows), there = columns < x0 ? columns : x0;
        uint32_t width = columns - there;
        width = width < b->strip_columns ? width : b->strip_columns;
        if (!width || left >= width * rows)
            continue;
        const uint32_t x = x0 + left % width, y = left / width;
        assert_true(x < columns && y < rows);
        assert_false(seen[y * columns + x]);
        seen[y * columns + x] = 1;
        ++count;
    }
    free(seen);
    assert_int_equal(count, columns * rows);
}

/* Tiles begin at a word of AO codes, as windows of the blur do. */
static void check_tiles(struct world *w, bool run)
{
    struct view_constants view;
    struct vkao_tiles_block b;
    struct vkao_ssao_block ssao;
    fake_forget_calls(&w->fake);
    assert_int_equal(world_record_all(w), VKAO_SUCCESS);
    const struct parts p = find_parts(w, 0);
    const struct fake_call *dispatch = &w->fake.calls[p.tiles];
    assert_true(is(&dispatch[-1], "vkCmdPushConstants"));
    assert_int_equal(dispatch[-1].push_bytes, sizeof b);
    memcpy(&b, dispatch[-1].push, sizeof b);
    assert_true(is(&w->fake.calls[p.ssao - 1], "vkCmdPushConstants"));
    memcpy(&ssao, w->fake.calls[p.ssao - 1].push, sizeof ssao);
    assert_int_equal(
        frame_view_check(w->frame, world_cmd(w), "test", VKAO_STAGE_SSAO, &w->view, &view),
        VKAO_SUCCESS);
    const struct view_constants grid = frame_grid(w->frame, &view);
    const uint32_t border = w->frame_info.stages & VKAO_STAGE_BLUR ? w->blur.radius : 0;
    const struct vkao_rect want = rect_grow(grid.rect, border, border, grid.valid);
    const struct vkao_rect rect = unpack(b.rect), same = unpack(ssao.rect);
    assert_memory_equal(&rect, &want, sizeof want);
    assert_memory_equal(&same, &want, sizeof want);
    assert_int_equal(b.flags, ssao.flags);
    assert_int_equal(b.stride, w->frame->scratch.buffer.stride);
    /* Exactly as many as cover the rect, each as wide as a group of SSAO is. */
    const enum pipeline which = which_of(w, &w->fake.calls[p.ssao]);
    const uint32_t width =
        which == PIPELINE_SSAO + VKAO_SSAO_SPHERE || which == PIPELINE_SSAO + VKAO_SSAO_RAYMARCH
            ? 64
            : 128;
    const uint32_t x0 = rect.x0 / 4 * 4, height = b.tile_height;
    struct vkao_tiles_head head;
    memcpy(&head, w->fake.calls[p.update].update, sizeof head);
    assert_int_equal(head.group_rows, height);
    assert_true(b.tiles[0] * b.tiles[1] <= 65535); /* maxComputeWorkGroupCount of every device */
    assert_true(height == VKAO_TILE_HEIGHT || b.tiles[0] * b.tiles[1] > 65535 / 2 - b.tiles[0]);
    assert_int_equal(b.tile_width, width);
    assert_int_equal(b.strip_columns, VKAO_STRIP_TEXELS / width);
    assert_true(x0 + b.tiles[0] * width >= rect.x1 && x0 + (b.tiles[0] - 1) * width < rect.x1);
    assert_true(rect.y0 + b.tiles[1] * height >= rect.y1 &&
                rect.y0 + (b.tiles[1] - 1) * height < rect.y1);
    assert_int_equal(dispatch->groups[1], 1);
    assert_int_equal(dispatch->groups[2], 1);
    const VkDeviceSize list = (VkDeviceSize)b.tiles[0] * b.tiles[1] * 4;
    assert_true(sizeof(struct vkao_tiles_head) + list <=
                w->frame->scratch.buffer.parts[PART_TILES].bytes);
    if (run)
        run_tiles(&b, dispatch);
}

static void check_rects(struct world *w, VkExtent2D e)
{
    const uint32_t lows[] = {0, 1, 2, 3, 4, 7, 61, 64, 127, 130, 637};
    for (size_t i = 0; i < COUNT(lows) * COUNT(lows); ++i) {
        const uint32_t x0 = lows[i % COUNT(lows)], y0 = lows[i / COUNT(lows)];
        if (x0 >= e.width || y0 >= e.height)
            continue;
        const VkOffset2D low = {(int32_t)x0, (int32_t)y0};
        const VkExtent2D extents[] = {{e.width - x0, e.height - y0},
                                      {1, 1},
                                      {(e.width - x0 + 1) / 2, (e.height - y0 + 1) / 2}};
        for (size_t k = 0; k < COUNT(extents); ++k) {
            w->view.rect = (VkRect2D){low, extents[k]};
            w->blur.radius = (uint32_t)(i + k) % 17;
            check_tiles(w, true);
        }
        if (w->frame_info.half_resolution && ((x0 | y0) & 1))
            continue;
        w->view.valid = w->view.rect = (VkRect2D){low, extents[0]};
        check_tiles(w, true);
        w->view.valid = (VkRect2D){{0, 0}, {0, 0}};
    }
}

static void tiles_cover_every_rect_once(void **state)
{
    (void)state;
    static const uint32_t widths[] = {1, 3, 61, 64, 65, 127, 129, 639, 641, 1283},
                          heights[] = {1, 8, 9, 135};
    for (size_t i = 0; i < COUNT(widths) * COUNT(heights) * 4; ++i) {
        const VkExtent2D e = {widths[i / 4 % COUNT(widths)], heights[i / 4 / COUNT(widths)]};
        struct world w;
        world_init(&w, true);
        open(&w, e, i & 1 ? PACKED : i & 2 ? ALONE : NOISY, (i & 3) == 3);
        for (int sphere = 0; sphere < 2; ++sphere) {
            w.ssao.method = sphere ? VKAO_SSAO_SPHERE : VKAO_SSAO_VBAO;
            check_rects(&w, e);
        }
        world_close(&w);
    }
}

/* Of every width, and of rects that begin in every texel of a narrow tile. */
static void lists_hold_all_tiles_of_any_rect(void **state)
{
    (void)state;
    for (uint32_t i = 1; i <= 400; ++i) {
        const VkExtent2D e = {i < 280 ? i : i * 10, 1 + i * 7 % 300};
        struct world w;
        world_init(&w, true);
        open(&w, e, PACKED, i & 1);
        for (int method = 0; method < VKAO_METHOD_COUNT; ++method) {
            w.ssao.method = (vkao_ssao_method)method;
            for (uint32_t x = 0; x < 64 && x < e.width; x += 1 + x / 8) {
                w.view.rect = (VkRect2D){{(int32_t)x, 0}, {e.width - x, e.height}};
                w.blur.radius = x % 17;
                check_tiles(&w, false);
            }
        }
        world_close(&w);
    }
}

/* Higher tiles, where those of the usual height are more than a dispatch may have. */
static void large_frames_dispatch_no_more_than_devices_can(void **state)
{
    (void)state;
    static const VkExtent2D extents[] = {{8192, 8192}, {16384, 8192}, {64, 65535},  {7680, 8738},
                                         {7681, 8738}, {4097, 8065},  {65535, 1800}};
    for (size_t i = 0; i < COUNT(extents); ++i) {
        struct world w;
        world_init(&w, true);
        w.fake.max_dimension = UINT16_MAX;
        w.fake.max_texels = UINT32_C(1) << 28;
        w.fake.max_buffer = UINT32_C(1) << 30;
        open(&w, extents[i], ALONE, false);
        for (int method = 0; method < VKAO_METHOD_COUNT; ++method) {
            w.ssao.method = (vkao_ssao_method)method;
            check_tiles(&w, true);
        }
        world_close(&w);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_ssao_begins_a_list),
        cmocka_unit_test(images_have_no_lists),
        cmocka_unit_test(lists_are_written_and_read_in_order),
        cmocka_unit_test(ssao_waits_for_the_ssao_before),
        cmocka_unit_test(tiles_cover_every_rect_once),
        cmocka_unit_test(lists_hold_all_tiles_of_any_rect),
        cmocka_unit_test(large_frames_dispatch_no_more_than_devices_can),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
