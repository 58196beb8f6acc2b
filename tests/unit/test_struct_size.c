/* SPDX-License-Identifier: MIT
 *
 * The struct rule of vkao.h, for every struct that has a struct_size: smaller than known is
 * refused, larger is accepted if and only if the rest is zero. */
#include "world.h"

#include <stdio.h>
#include <string.h>

enum { TAIL = 24, LARGEST = 512 };

/* Each gives the struct of this name to a call that takes it. */
static vkao_result give_context(struct world *w, const void *copy)
{
    vkao_context *ctx = NULL;
    vkao_result result = vkao_context_create(copy, &ctx);
    assert_true((result == VKAO_SUCCESS) == (ctx != NULL));
    vkao_context_destroy(ctx);
    (void)w;
    return result;
}

static vkao_result give_frame(struct world *w, const void *copy)
{
    vkao_frame *frame = NULL;
    vkao_result result = vkao_frame_create(w->ctx, copy, &frame);
    assert_true((result == VKAO_SUCCESS) == (frame != NULL));
    vkao_frame_destroy(frame);
    return result;
}

static vkao_result give_frame_to_query(struct world *w, const void *copy)
{
    VkMemoryRequirements out;
    return vkao_frame_scratch(w->ctx, copy, &out);
}

static vkao_result give_images(struct world *w, const void *copy)
{
    vkao_frame_info info = w->frame_info;
    info.images = copy;
    return give_frame(w, &info);
}

static vkao_result give_images_to_update(struct world *w, const void *copy)
{
    return vkao_frame_update(w->frame, copy);
}

static vkao_result give_view_to_prepare(struct world *w, const void *copy)
{
    return vkao_cmd_prepare(w->frame, world_cmd(w), copy);
}

static vkao_result give_view_to_composite(struct world *w, const void *copy)
{
    return vkao_cmd_composite(w->frame, world_cmd(w), copy, &w->composite);
}

static vkao_result give_ssao(struct world *w, const void *copy)
{
    return vkao_cmd_ssao(w->frame, world_cmd(w), &w->view, copy);
}

static vkao_result give_ssao_to_all(struct world *w, const void *copy)
{
    return vkao_cmd_all(w->frame, world_cmd(w), &w->view, copy, &w->blur, &w->composite);
}

static vkao_result give_blur(struct world *w, const void *copy)
{
    return vkao_cmd_blur(w->frame, world_cmd(w), &w->view, copy);
}

static vkao_result give_blur_to_all(struct world *w, const void *copy)
{
    return vkao_cmd_all(w->frame, world_cmd(w), &w->view, &w->ssao, copy, &w->composite);
}

static vkao_result give_composite(struct world *w, const void *copy)
{
    return vkao_cmd_composite(w->frame, world_cmd(w), &w->view, copy);
}

static vkao_result give_composite_to_all(struct world *w, const void *copy)
{
    return vkao_cmd_all(w->frame, world_cmd(w), &w->view, &w->ssao, &w->blur, copy);
}

static const struct {
    const char *name;
    size_t offset, known; /* in struct world */
    vkao_result (*give)(struct world *w, const void *copy);
} structs[] = {
    {"context", offsetof(struct world, info), sizeof(vkao_context_info), give_context},
    {"frame", offsetof(struct world, frame_info), sizeof(vkao_frame_info), give_frame},
    {"frame", offsetof(struct world, frame_info), sizeof(vkao_frame_info), give_frame_to_query},
    {"images", offsetof(struct world, images), sizeof(vkao_images), give_images},
    {"images", offsetof(struct world, images), sizeof(vkao_images), give_images_to_update},
    {"view", offsetof(struct world, view), sizeof(vkao_view), give_view_to_prepare},
    {"view", offsetof(struct world, view), sizeof(vkao_view), give_view_to_composite},
    {"ssao", offsetof(struct world, ssao), sizeof(vkao_ssao_params), give_ssao},
    {"ssao", offsetof(struct world, ssao), sizeof(vkao_ssao_params), give_ssao_to_all},
    {"blur", offsetof(struct world, blur), sizeof(vkao_blur_params), give_blur},
    {"blur", offsetof(struct world, blur), sizeof(vkao_blur_params), give_blur_to_all},
    {"composite", offsetof(struct world, composite), sizeof(vkao_composite_params), give_composite},
    {"composite", offsetof(struct world, composite), sizeof(vkao_composite_params),
     give_composite_to_all},
};

union copy {
    unsigned char bytes[LARGEST];
    uint32_t struct_size;
    uint64_t alignment;
};

/* The struct with another size, and a tail of zeros. */
static union copy with_size(const struct world *w, size_t index, uint32_t size)
{
    union copy copy;
    memset(&copy, 0, sizeof copy);
    memcpy(copy.bytes, (const unsigned char *)w + structs[index].offset, structs[index].known);
    copy.struct_size = size;
    return copy;
}

static void expect_size_refused(struct world *w, size_t index, const union copy *copy)
{
    size_t live = fake_live(&w->fake);
    fake_forget_calls(&w->fake);
    vkao_result result = structs[index].give(w, copy);
    char value[32];
    snprintf(value, sizeof value, "struct_size is %u,", copy->struct_size);
    /* A context info that is too small has no log to trust. */
    if (structs[index].give == give_context && copy->struct_size < structs[index].known) {
        assert_int_equal(result, VKAO_ERROR_INVALID_ARGUMENT);
        assert_int_equal(w->log.lines, 0);
    } else {
        expect_refused(w, VKAO_ERROR_INVALID_ARGUMENT, result, structs[index].name, value);
    }
    assert_int_equal(fake_live(&w->fake), live);
    assert_int_equal(w->fake.call_count, 0);
}

static void smaller_than_known_is_refused(void **state)
{
    (void)state;
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    for (size_t i = 0; i < COUNT(structs); ++i) {
        const uint32_t sizes[] = {0, 1, 4, (uint32_t)structs[i].known - 4,
                                  (uint32_t)structs[i].known - 1};
        for (size_t k = 0; k < COUNT(sizes); ++k) {
            const union copy copy = with_size(&w, i, sizes[k]);
            expect_size_refused(&w, i, &copy);
        }
    }
    world_close(&w);
}

static void known_size_and_zero_tail_are_accepted(void **state)
{
    (void)state;
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    for (size_t i = 0; i < COUNT(structs); ++i) {
        for (uint32_t tail = 0; tail <= TAIL; tail += 4) {
            const union copy copy = with_size(&w, i, (uint32_t)structs[i].known + tail);
            fake_forget_calls(&w.fake);
            if (structs[i].give(&w, &copy) != VKAO_SUCCESS)
                fail_msg("%s with %u more bytes refused: %s", structs[i].name, tail,
                         w.log.last_error);
        }
    }
    world_close(&w);
}

static void nonzero_tail_is_refused(void **state)
{
    (void)state;
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    for (size_t i = 0; i < COUNT(structs); ++i) {
        for (size_t byte = 0; byte < TAIL; ++byte) {
            union copy copy = with_size(&w, i, (uint32_t)structs[i].known + TAIL);
            copy.bytes[structs[i].known + byte] = 1;
            expect_size_refused(&w, i, &copy);
        }
    }
    world_close(&w);
}

static void bytes_beyond_the_size_are_not_read(void **state)
{
    (void)state;
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    for (size_t i = 0; i < COUNT(structs); ++i) {
        union copy copy = with_size(&w, i, (uint32_t)structs[i].known);
        memset(copy.bytes + structs[i].known, 0xff, LARGEST - structs[i].known);
        fake_forget_calls(&w.fake);
        assert_int_equal(structs[i].give(&w, &copy), VKAO_SUCCESS);
    }
    world_close(&w);
}

static void defaults_set_their_size(void **state)
{
    (void)state;
    assert_int_equal(vkao_images_default().struct_size, sizeof(vkao_images));
    assert_int_equal(vkao_view_default().struct_size, sizeof(vkao_view));
    assert_int_equal(vkao_ssao_params_default().struct_size, sizeof(vkao_ssao_params));
    assert_int_equal(vkao_blur_params_default().struct_size, sizeof(vkao_blur_params));
    assert_int_equal(vkao_composite_params_default().struct_size, sizeof(vkao_composite_params));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(smaller_than_known_is_refused),
        cmocka_unit_test(known_size_and_zero_tail_are_accepted),
        cmocka_unit_test(nonzero_tail_is_refused),
        cmocka_unit_test(bytes_beyond_the_size_are_not_read),
        cmocka_unit_test(defaults_set_their_size),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
