/* SPDX-License-Identifier: MIT
 *
 * Staged AO: strips of words that are copied into the caller's image, where scratch is in buffers
 * and nothing else keeps them from being the last thing that BLUR does. */
#include "pipelines.h"
#include "settings.h"

#include <stdio.h>
#include <string.h>

static const struct format {
    VkFormat format;
    uint32_t bytes, staged;
} formats[] = {
    {VK_FORMAT_R8_UNORM, 1, VKAO_STAGED_UNORM8},
    {VK_FORMAT_R16_UNORM, 2, VKAO_STAGED_UNORM16},
    {VK_FORMAT_R16_SFLOAT, 2, VKAO_STAGED_FLOAT16},
    {VK_FORMAT_R32_SFLOAT, 4, VKAO_STAGED_FLOAT32},
};

/* An image whose level `mip` has the extent. */
static VkImage add_image(struct world *w, VkFormat format, VkExtent2D extent, uint32_t mip,
                         uint32_t layer)
{
    return fake_caller_image(&w->fake, &(VkImageCreateInfo){
                                           .format = format,
                                           .extent = {extent.width << mip, extent.height << mip, 1},
                                           .mipLevels = mip + 1,
                                           .arrayLayers = layer + 1,
                                       });
}

/* A CPU, SSAO and BLUR with ao_image; without a frame yet. */
static void init(struct world *w, VkFormat format, VkExtent2D extent, bool half)
{
    world_init(w, true);
    w->fake.device_type = VK_PHYSICAL_DEVICE_TYPE_CPU;
    w->images.ao_noisy = (vkao_image){0};
    w->images.ao.format = format;
    w->images.ao_image = add_image(w, format, extent, 0, 0);
    w->frame_info.stages = VKAO_STAGE_SSAO | VKAO_STAGE_BLUR;
    w->frame_info.extent = extent;
    w->frame_info.half_resolution = half;
}

static void open_context(struct world *w)
{
    assert_int_equal(vkao_context_create(&w->info, &w->ctx), VKAO_SUCCESS);
}

static void open_frame(struct world *w)
{
    assert_int_equal(vkao_frame_create(w->ctx, &w->frame_info, &w->frame), VKAO_SUCCESS);
    fake_forget_calls(&w->fake);
}

/* --- Copies --- */

static bool is(const struct fake_call *call, const char *name)
{
    return strcmp(call->name, name) == 0;
}

static void check_barrier(const struct fake_call *call, bool before)
{
    const VkPipelineStageFlags compute = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                               transfer = VK_PIPELINE_STAGE_TRANSFER_BIT;
    const VkMemoryBarrier *b = &call->memory_barrier;
    assert_string_equal(call->name, "vkCmdPipelineBarrier");
    assert_int_equal(call->memory_barrier_count, 1);
    assert_int_equal(call->src_stages, before ? compute : transfer);
    assert_int_equal(call->dst_stages, before ? transfer : compute);
    assert_int_equal(b->srcAccessMask,
                     before ? VK_ACCESS_SHADER_WRITE_BIT : VK_ACCESS_TRANSFER_WRITE_BIT);
    assert_int_equal(b->dstAccessMask,
                     before ? VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_TRANSFER_WRITE_BIT
                            : VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
}

/* What the shader that wrote a strip was told. */
struct written {
    uint32_t rect[2], flags, stride;
};

static struct written written_by(const struct fake_call *push, bool half)
{
    struct vkao_blur_block blur = {0};
    struct vkao_upsample_block upsample = {0};
    assert_int_equal(push->push_bytes, half ? sizeof upsample : sizeof blur);
    memcpy(half ? (void *)&upsample : (void *)&blur, push->push, push->push_bytes);
    return half ? (struct written){{upsample.rect[0], upsample.rect[1]},
                                   upsample.flags,
                                   upsample.staged_stride}
                : (struct written){{blur.rect[0], blur.rect[1]}, blur.flags, blur.staged_stride};
}

/* One copy, of a strip that begins at row y0; returns the row after it. */
static uint32_t check_copy(const struct world *w, const struct fake_call *copy,
                           const struct written *by, VkRect2D rect, const struct format *f,
                           uint32_t y0)
{
    const struct scratch_buffer *buffer = &w->frame->scratch.buffer;
    const VkBufferImageCopy *r = &copy->copy;
    const uint32_t x0 = (uint32_t)rect.offset.x, x1 = x0 + rect.extent.width;
    const uint32_t end = (uint32_t)rect.offset.y + rect.extent.height, most = VKAO_STRIP_ROWS;
    const uint32_t y1 = end - y0 < most ? end : y0 + most;
    assert_true(copy->source == (uint64_t)(uintptr_t)buffer->buffer);
    assert_true(copy->handle == (uint64_t)(uintptr_t)w->images.ao_image);
    assert_int_equal(copy->layout, VK_IMAGE_LAYOUT_GENERAL);
    assert_int_equal(r->imageSubresource.aspectMask, VK_IMAGE_ASPECT_COLOR_BIT);
    assert_int_equal(r->imageSubresource.mipLevel, w->images.ao_mip_level);
    assert_int_equal(r->imageSubresource.baseArrayLayer, w->images.ao_array_layer);
    assert_int_equal(r->imageSubresource.layerCount, 1);
    assert_int_equal(r->imageOffset.x, x0);
    assert_int_equal(r->imageOffset.y, y0);
    assert_int_equal(r->imageExtent.width, rect.extent.width);
    assert_int_equal(r->imageExtent.height, y1 - y0);
    /* Row 0 of the part is the strip's first, and its columns are the image's. */
    assert_int_equal(r->bufferOffset, buffer->parts[PART_STAGED].offset + x0 * f->bytes);
    assert_int_equal(r->bufferRowLength, by->stride);
    assert_true(by->stride >= w->frame_info.extent.width && by->stride % 8 == 0);
    assert_true((uint64_t)by->stride * (y1 - y0) * f->bytes <= buffer->parts[PART_STAGED].bytes);
    assert_int_equal(by->rect[0], x0 | y0 << 16);
    assert_int_equal(by->rect[1], x1 | y1 << 16);
    assert_int_equal(by->flags >> VKAO_FLAG_STAGED_SHIFT & 7u, f->staged);
    return y1;
}

/* Every copy comes between two barriers, after the shader that wrote its strip. */
static void check_copies(struct world *w, VkRect2D rect, const struct format *f)
{
    const bool half = w->frame_info.half_resolution;
    const enum pipeline last = half ? PIPELINE_PACKED_UPSAMPLE : PIPELINE_PACKED_BLUR_Y;
    const uint64_t writer = entry_handle(general_entry(w->ctx, last, false));
    uint32_t y = (uint32_t)rect.offset.y;
    const struct fake_call *push = NULL;
    w->view.rect = rect;
    fake_forget_calls(&w->fake);
    assert_int_equal(world_record_all(w), VKAO_SUCCESS);
    for (size_t i = 0; i < w->fake.call_count; ++i) {
        const struct fake_call *call = &w->fake.calls[i];
        push = is(call, "vkCmdPushConstants") ? call : push;
        if (!is(call, "vkCmdCopyBufferToImage"))
            continue;
        assert_true(i >= 2 && i + 1 < w->fake.call_count);
        assert_string_equal(call[-2].name, "vkCmdDispatch");
        assert_true(call[-2].handle == writer);
        check_barrier(&call[-1], true);
        check_barrier(&call[1], false);
        const struct written by = written_by(push, half);
        y = check_copy(w, call, &by, rect, f, y);
    }
    assert_int_equal(y, (uint32_t)rect.offset.y + rect.extent.height);
}

static void strips_are_copied_to_where_they_belong(void **state)
{
    (void)state;
    static const VkRect2D rects[] = {
        {{0, 0}, {201, 700}}, {{33, 287}, {7, 300}},  {{1, 1}, {200, 128}},
        {{200, 699}, {1, 1}}, {{17, 101}, {64, 129}}, {{5, 3}, {3, 256}},
    };
    for (size_t i = 0; i < COUNT(formats) * COUNT(rects) * 2; ++i) {
        const struct format *f = &formats[i % COUNT(formats)];
        const uint32_t mip = (uint32_t)(i % 3), layer = (uint32_t)(i % 5);
        const VkExtent2D extent = {201, 700};
        struct world w;
        init(&w, f->format, extent, i / COUNT(formats) & 1);
        w.images.ao_image = add_image(&w, f->format, extent, mip, layer);
        w.images.ao_mip_level = mip;
        w.images.ao_array_layer = layer;
        w.fake.max_dimension = 4096;
        open_context(&w);
        open_frame(&w);
        check_copies(&w, rects[i / COUNT(formats) / 2], f);
        world_close(&w);
    }
}

/* A strip's copy reads words of its own rows alone. */
static void images_of_any_size_are_copied_whole(void **state)
{
    (void)state;
    static const VkExtent2D extents[] = {{1, 1}, {3, 1}, {1, 300}, {13, 127}, {4, 128}, {9, 129}};
    for (size_t i = 0; i < COUNT(formats) * COUNT(extents) * 2; ++i) {
        const VkExtent2D extent = extents[i / COUNT(formats) / 2];
        struct world w;
        init(&w, formats[i % COUNT(formats)].format, extent, i / COUNT(formats) & 1);
        open_context(&w);
        open_frame(&w);
        check_copies(&w, (VkRect2D){{0, 0}, extent}, &formats[i % COUNT(formats)]);
        world_close(&w);
    }
}

static void blur_alone_copies_as_the_whole_line_does(void **state)
{
    (void)state;
    for (int half = 0; half < 2; ++half) {
        struct world w;
        init(&w, VK_FORMAT_R8_UNORM, (VkExtent2D){40, 300}, half);
        open_context(&w);
        open_frame(&w);
        assert_int_equal(vkao_cmd_ssao(w.frame, world_cmd(&w), &w.view, &w.ssao), VKAO_SUCCESS);
        assert_int_equal(fake_count(&w.fake, "vkCmdCopy"), 0);
        assert_int_equal(vkao_cmd_blur(w.frame, world_cmd(&w), &w.view, &w.blur), VKAO_SUCCESS);
        assert_int_equal(fake_count(&w.fake, "vkCmdCopy"), 3);
        world_close(&w);
    }
}

/* --- Memory --- */

static VkDeviceSize scratch_size(struct world *w)
{
    VkMemoryRequirements need = {0};
    assert_int_equal(vkao_frame_scratch(w->ctx, &w->frame_info, &need), VKAO_SUCCESS);
    return need.size;
}

static void scratch_grows_by_one_strip(void **state)
{
    (void)state;
    static const VkExtent2D extents[] = {{1, 1}, {201, 60}, {1920, 128}, {1921, 1080}};
    for (size_t i = 0; i < COUNT(formats) * COUNT(extents) * 2; ++i) {
        const struct format *f = &formats[i % COUNT(formats)];
        const VkExtent2D e = extents[i / COUNT(formats) / 2];
        struct world w;
        init(&w, f->format, e, i / COUNT(formats) & 1);
        open_context(&w);
        const VkDeviceSize with = scratch_size(&w);
        open_frame(&w);
        const VkDeviceSize rows = e.height < VKAO_STRIP_ROWS ? e.height : VKAO_STRIP_ROWS;
        const VkDeviceSize strip = (e.width + 7) / 8 * 8 * rows * f->bytes;
        assert_int_equal(w.frame->scratch.buffer.parts[PART_STAGED].bytes, strip);
        assert_int_equal(w.frame->scratch.buffer.parts[PART_STAGED].offset % 256, 0);
        w.images.ao_image = VK_NULL_HANDLE;
        /* Descriptors want a few bytes there also if it is not used. */
        assert_int_equal(with - scratch_size(&w), (strip + 255) / 256 * 256 - 256);
        world_close(&w);
    }
}

static void failing_nth_call_leaks_nothing(void **state)
{
    (void)state;
    unsigned n = 0;
    for (bool done = false; !done;) {
        struct world w;
        init(&w, VK_FORMAT_R8_UNORM, (VkExtent2D){100, 300}, true);
        open_context(&w);
        const size_t before = fake_live(&w.fake);
        w.fake.fail_at = w.fake.result_calls + ++n;
        vkao_result result = vkao_frame_create(w.ctx, &w.frame_info, &w.frame);
        done = !w.fake.failed;
        assert_int_equal(result, done ? VKAO_SUCCESS : VKAO_ERROR_VULKAN);
        assert_int_equal(w.log.errors, done ? 0 : 1);
        if (!done)
            assert_int_equal(fake_live(&w.fake), before);
        world_close(&w);
    }
    assert_true(n > 9); /* buffer, memory, its views, pool, set */
}

/* --- Where it is ignored --- */

enum way { IN_IMAGES, WITH_NOISY, WITH_BENT, WITHOUT_BLUR, WITHOUT_SSAO, WITHOUT_AO, WAYS };

static void choose(struct world *w, enum way way)
{
    const vkao_image noisy = {fake_caller_view(&w->fake), VK_IMAGE_LAYOUT_GENERAL,
                              VK_FORMAT_R8_UNORM};
    if (way == IN_IMAGES)
        w->info.scratch_layout = VKAO_SCRATCH_IMAGES;
    if (way == WITH_NOISY || way == WITHOUT_SSAO)
        w->images.ao_noisy = noisy;
    if (way == WITH_BENT)
        w->images.bent_normals = w->bent_normals;
    if (way == WITHOUT_BLUR)
        w->frame_info.stages = VKAO_STAGE_SSAO;
    if (way == WITHOUT_SSAO)
        w->frame_info.stages = VKAO_STAGE_BLUR;
    if (way == WITHOUT_AO) {
        w->frame_info.stages = VKAO_STAGE_ALL;
        w->images.ao = (vkao_image){0};
    }
}

/* Nothing waits for transfers, nor do transfers, but for what SSAO tells its tiles. */
static void check_no_barrier_for_copies(const struct world *w)
{
    const VkPipelineStageFlags transfer = VK_PIPELINE_STAGE_TRANSFER_BIT;
    for (size_t i = 0; i < w->fake.call_count; ++i) {
        const struct fake_call *call = &w->fake.calls[i];
        if (!is(call, "vkCmdPipelineBarrier"))
            continue;
        if (call->dst_stages & transfer)
            assert_true(i + 1 < w->fake.call_count && is(&call[1], "vkCmdUpdateBuffer"));
        if (call->src_stages & transfer)
            assert_true(i && is(&call[-1], "vkCmdUpdateBuffer"));
    }
}

static void ao_image_is_ignored_elsewhere(void **state)
{
    (void)state;
    for (int i = 0; i < WAYS * 2; ++i) {
        const enum way way = (enum way)(i / 2);
        const bool half = i & 1, can_be_half = way == IN_IMAGES || way == WITH_BENT;
        struct world w;
        init(&w, VK_FORMAT_R16_UNORM, (VkExtent2D){100, 300}, half && can_be_half);
        choose(&w, way);
        open_context(&w);
        const VkDeviceSize with = scratch_size(&w);
        open_frame(&w);
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        assert_true(fake_count(&w.fake, "vkCmdDispatch") > 0);
        assert_int_equal(fake_count(&w.fake, "vkCmdCopy"), 0);
        check_no_barrier_for_copies(&w);
        w.images.ao_image = VK_NULL_HANDLE;
        assert_int_equal(scratch_size(&w), with);
        world_close(&w);
    }
}

/* --- Updates --- */

static void updates_cannot_begin_or_end_staging(void **state)
{
    (void)state;
    for (int staged = 0; staged < 2; ++staged) {
        struct world w;
        init(&w, VK_FORMAT_R8_UNORM, (VkExtent2D){64, 64}, false);
        const VkImage image = w.images.ao_image;
        w.images.ao_image = staged ? image : VK_NULL_HANDLE;
        open_context(&w);
        open_frame(&w);
        w.images.ao_image = staged ? VK_NULL_HANDLE : image;
        expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, vkao_frame_update(w.frame, &w.images),
                       "images.ao_image", staged ? "VK_NULL_HANDLE" : "given");
        assert_int_equal(w.fake.call_count, 0);
        /* The frame is as it was. */
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        assert_int_equal(fake_count(&w.fake, "vkCmdCopy"), staged);
        if (staged)
            assert_true(fake_nth(&w.fake, "vkCmdCopyBufferToImage", 0)->handle ==
                        (uint64_t)(uintptr_t)image);
        world_close(&w);
    }
}

static void copies_go_to_the_image_of_the_last_update(void **state)
{
    (void)state;
    const VkExtent2D extent = {64, 200};
    struct world w;
    init(&w, VK_FORMAT_R16_SFLOAT, extent, false);
    open_context(&w);
    open_frame(&w);
    w.images.ao_image = add_image(&w, VK_FORMAT_R16_SFLOAT, extent, 2, 3);
    w.images.ao_mip_level = 2;
    w.images.ao_array_layer = 3;
    assert_int_equal(vkao_frame_update(w.frame, &w.images), VKAO_SUCCESS);
    check_copies(&w, (VkRect2D){{3, 5}, {61, 195}}, &formats[2]);
    world_close(&w);
}

/* --- Variants --- */

/* A context for AO that is staged as `from` has a variant for what is staged as `to`. */
static void variants_are_of_one_staged_format(void **state)
{
    (void)state;
    static const VkFormat any[] = {VK_FORMAT_UNDEFINED, VK_FORMAT_R8_UNORM, VK_FORMAT_R16_UNORM,
                                   VK_FORMAT_R16_SFLOAT, VK_FORMAT_R32_SFLOAT};
    enum { IMAGES, HALF_IMAGES, BUFFERS, HALF, BENT, HALF_BENT, NO_BLUR, KINDS };
    for (size_t i = 0; i < KINDS * COUNT(any); ++i) {
        const size_t kind = i % KINDS, from = i / KINDS;
        struct world w;
        struct settings s;
        settings_init(&w, &s, kind > HALF_IMAGES);
        s.variant.half_resolution = kind == HALF_IMAGES || kind == HALF || kind == HALF_BENT;
        s.variant.bent_normals = kind == BENT || kind == HALF_BENT;
        s.variant.blur = kind == NO_BLUR ? NULL : &s.blur;
        s.variant.staged_ao = any[from];
        settings_open(&w, &s.variant, 1, true);
        for (size_t to = 0; to < COUNT(any); ++to) {
            const bool has = to == from || (kind != BUFFERS && kind != HALF);
            s.variant.staged_ao = any[to];
            assert_int_equal(vkao_context_has_variant(w.ctx, &s.variant), has ? VK_TRUE : VK_FALSE);
        }
        assert_int_equal(w.log.lines, 0);
        world_close(&w);
    }
}

static void frames_are_recorded_by_variants_of_their_kind_alone(void **state)
{
    (void)state;
    for (int i = 0; i < 8; ++i) {
        const bool half = i & 1, compiled = i & 2, staged = i & 4;
        struct world w;
        struct settings s;
        settings_init(&w, &s, true);
        s.variant.half_resolution = half;
        s.variant.staged_ao = compiled ? w.images.ao.format : VK_FORMAT_UNDEFINED;
        settings_open(&w, &s.variant, 1, true);
        w.frame_info.stages = VKAO_STAGE_SSAO | VKAO_STAGE_BLUR;
        w.frame_info.half_resolution = half;
        if (staged)
            w.images.ao_image = add_image(&w, w.images.ao.format, w.frame_info.extent, 0, 0);
        open_frame(&w);
        const vkao_result result = world_record_all(&w);
        if (staged == compiled) {
            assert_int_equal(result, VKAO_SUCCESS);
        } else {
            expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, result, "variants_only", "");
            expect_nothing_recorded(&w);
        }
        world_close(&w);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(strips_are_copied_to_where_they_belong),
        cmocka_unit_test(images_of_any_size_are_copied_whole),
        cmocka_unit_test(blur_alone_copies_as_the_whole_line_does),
        cmocka_unit_test(scratch_grows_by_one_strip),
        cmocka_unit_test(failing_nth_call_leaks_nothing),
        cmocka_unit_test(ao_image_is_ignored_elsewhere),
        cmocka_unit_test(updates_cannot_begin_or_end_staging),
        cmocka_unit_test(copies_go_to_the_image_of_the_last_update),
        cmocka_unit_test(variants_are_of_one_staged_format),
        cmocka_unit_test(frames_are_recorded_by_variants_of_their_kind_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
