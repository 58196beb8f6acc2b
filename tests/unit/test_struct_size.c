/* SPDX-License-Identifier: MIT
 *
 * The struct rule of vkao.h, in its words: smaller structs of an earlier 0.2 are accepted and their
 * missing bytes are zero, larger ones only with a zero tail, and a size that no version can have is
 * refused and not read past. */
#include "parameters.h"
#include "world.h"

#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

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

static vkao_result give_effect(struct world *w, const void *copy)
{
    vkao_effect *effect = NULL;
    vkao_result result = vkao_effect_create(w->ctx, copy, &effect);
    assert_true((result == VKAO_SUCCESS) == (effect != NULL));
    vkao_effect_destroy(effect);
    return result;
}

static vkao_result give_frame(struct world *w, const void *copy)
{
    vkao_frame *frame = NULL;
    vkao_result result = vkao_frame_create(w->effect, copy, &frame);
    assert_true((result == VKAO_SUCCESS) == (frame != NULL));
    vkao_frame_destroy(frame);
    return result;
}

static vkao_result give_frame_to_query(struct world *w, const void *copy)
{
    VkMemoryRequirements out;
    return vkao_frame_scratch(w->effect, copy, &out);
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

static vkao_result give_view(struct world *w, const void *copy)
{
    return vkao_cmd_record(w->frame, world_cmd(w), copy, &w->params);
}

static vkao_result give_view_to_stage(struct world *w, const void *copy)
{
    return vkao_cmd_stage(w->frame, world_cmd(w), VKAO_STAGE_COMPOSITE, copy, &w->params);
}

static vkao_result give_params(struct world *w, const void *copy)
{
    return vkao_cmd_record(w->frame, world_cmd(w), &w->view, copy);
}

static vkao_result give_params_to_stage(struct world *w, const void *copy)
{
    return vkao_cmd_stage(w->frame, world_cmd(w), VKAO_STAGE_SSAO, &w->view, copy);
}

static const struct {
    const char *name;
    size_t offset, known; /* in struct world */
    vkao_result (*give)(struct world *w, const void *copy);
} structs[] = {
    {"context", offsetof(struct world, info), sizeof(vkao_context_info), give_context},
    {"effect", offsetof(struct world, effect_info), sizeof(vkao_effect_info), give_effect},
    {"frame", offsetof(struct world, frame_info), sizeof(vkao_frame_info), give_frame},
    {"frame", offsetof(struct world, frame_info), sizeof(vkao_frame_info), give_frame_to_query},
    {"images", offsetof(struct world, images), sizeof(vkao_images), give_images},
    {"images", offsetof(struct world, images), sizeof(vkao_images), give_images_to_update},
    {"view", offsetof(struct world, view), sizeof(vkao_view), give_view},
    {"view", offsetof(struct world, view), sizeof(vkao_view), give_view_to_stage},
    {"params", offsetof(struct world, params), sizeof(vkao_params), give_params},
    {"params", offsetof(struct world, params), sizeof(vkao_params), give_params_to_stage},
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
    char value[32];
    snprintf(value, sizeof value, "struct_size is %u,", copy->struct_size);
    fake_forget_calls(&w->fake);
    vkao_result result = structs[index].give(w, copy);
    /* What is too short for a log has none. */
    if (structs[index].give == give_context && copy->struct_size && copy->struct_size < 80)
        assert_int_equal(result, VKAO_ERROR_INVALID_ARGUMENT);
    else
        expect_refused(w, VKAO_ERROR_INVALID_ARGUMENT, result, structs[index].name, value);
    assert_int_equal(fake_live(&w->fake), live);
    assert_int_equal(w->fake.call_count, 0);
}

/* 0.2.0 is the first: what is smaller has no struct of an earlier 0.2 behind it. */
static void smaller_than_the_first_version_is_refused_and_named(void **state)
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

/* The struct lies before a page that nobody may read. */
static void garbage_sizes_are_refused_without_reading_on(void **state)
{
    (void)state;
    static const uint32_t garbage[] = {UINT32_MAX, 0xcdcdcdcdu, 0x7fffffffu, 4096, 2052, 1001};
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);
    unsigned char *pages =
        mmap(NULL, 2 * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    assert_true(pages != MAP_FAILED);
    assert_int_equal(mprotect(pages + page, page, PROT_NONE), 0);
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    for (size_t i = 0; i < COUNT(structs) * COUNT(garbage); ++i) {
        const size_t s = i / COUNT(garbage);
        unsigned char *at = pages + page - structs[s].known;
        memcpy(at, (const unsigned char *)&w + structs[s].offset, structs[s].known);
        memcpy(at, &garbage[i % COUNT(garbage)], sizeof(uint32_t));
        expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, structs[s].give(&w, at), structs[s].name,
                       "struct_size");
    }
    world_close(&w);
    munmap(pages, 2 * page);
}

/* As it will be once a struct has grown. */
static void missing_bytes_of_an_earlier_version_are_zero(void **state)
{
    (void)state;
    const struct vkao_logger silent = {0};
    uint32_t in[4] = {8, 7, 7, 7}, out[4] = {9, 9, 9, 9};
    assert_int_equal(vkao_import_sized(&silent, "x", in, out, 8, 16), VKAO_SUCCESS);
    assert_int_equal(out[0], 8);
    assert_int_equal(out[1], 7);
    assert_int_equal(out[2], 0);
    assert_int_equal(out[3], 0);
    in[0] = 4;
    assert_int_equal(vkao_import_sized(&silent, "x", in, out, 8, 16), VKAO_ERROR_INVALID_ARGUMENT);
    in[0] = 12;
    assert_int_equal(vkao_import_sized(&silent, "x", in, out, 8, 16), VKAO_SUCCESS);
    assert_int_equal(out[2], 7);
    assert_int_equal(out[3], 0);
}

static void defaults_set_their_size(void **state)
{
    (void)state;
    assert_int_equal(vkao_context_info_default().struct_size, sizeof(vkao_context_info));
    assert_int_equal(vkao_effect_info_default().struct_size, sizeof(vkao_effect_info));
    assert_int_equal(vkao_frame_info_default().struct_size, sizeof(vkao_frame_info));
    assert_int_equal(vkao_images_default().struct_size, sizeof(vkao_images));
    assert_int_equal(vkao_view_default().struct_size, sizeof(vkao_view));
    assert_int_equal(vkao_params_default().struct_size, sizeof(vkao_params));
}

/* A program of another version of 0.2 has less of the struct, or more, and that many bytes to
 * spare. */
static void defaults_fit_the_callers_struct(void **state)
{
    (void)state;
    static const struct {
        void (*init)(void *out, uint32_t size);
        uint32_t size;
    } rows[] = {
#define ROW(name) {(void (*)(void *, uint32_t))(void (*)(void))name##_init, sizeof(name)}
        ROW(vkao_context_info), ROW(vkao_effect_info), ROW(vkao_frame_info),
        ROW(vkao_images),       ROW(vkao_view),        ROW(vkao_params),
#undef ROW
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        unsigned char whole[LARGEST], given[LARGEST];
        rows[i].init(whole, rows[i].size);
        for (uint32_t size = 0; size <= rows[i].size + 8; size += 4) {
            const uint32_t known = size < rows[i].size ? size : rows[i].size;
            memset(given, 0xa5, sizeof given);
            rows[i].init(given, size);
            if (size)
                assert_memory_equal(given, &size, sizeof size);
            if (size > 4)
                assert_memory_equal(given + 4, whole + 4, known - 4);
            for (uint32_t k = known; k < sizeof given; ++k)
                assert_int_equal(given[k], k < size ? 0 : 0xa5);
        }
    }
    vkao_effect_info settings;
    memset(&settings, 0xa5, sizeof settings);
    vkao_effect_settings(NULL, &settings, 8);
    assert_int_equal(settings.struct_size, 8);
    assert_int_equal(settings.stages, 0);
    assert_int_equal(((const unsigned char *)&settings)[8], 0xa5);
}

/* The caller has not initialised it. */
static void nothing_is_made_of_what_is_refused(void **state)
{
    (void)state;
    const struct vkao_logger log = {0};
    vkao_params given = vkao_params_default(), params = {0};
    const vkao_params untouched = {0};
    given.struct_size = 0;
    assert_int_equal(vkao_params_check(&log, &given, &params), VKAO_ERROR_INVALID_ARGUMENT);
    assert_memory_equal(&params, &untouched, sizeof params);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(smaller_than_the_first_version_is_refused_and_named),
        cmocka_unit_test(known_size_and_zero_tail_are_accepted),
        cmocka_unit_test(nonzero_tail_is_refused),
        cmocka_unit_test(bytes_beyond_the_size_are_not_read),
        cmocka_unit_test(garbage_sizes_are_refused_without_reading_on),
        cmocka_unit_test(missing_bytes_of_an_earlier_version_are_zero),
        cmocka_unit_test(defaults_set_their_size),
        cmocka_unit_test(defaults_fit_the_callers_struct),
        cmocka_unit_test(nothing_is_made_of_what_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
