/* SPDX-License-Identifier: MIT
 *
 * Variants: which pipelines they make, which recordings take them, and what a context that has
 * nothing else refuses. Which settings they serve is in test_has_variant.c. */
#include "pipelines.h"
#include "settings.h"

#include <stdio.h>
#include <string.h>

enum { FULL = 0, HALF = 1, BENT = 2, NO_BLUR = 4, OTHER_METHOD = 8, OTHER_RADIUS = 16 };

static void settings_with(const struct world *w, unsigned what, struct settings *s)
{
    settings_of(w, s);
    s->variant.half_resolution = what & HALF ? VK_TRUE : VK_FALSE;
    s->variant.bent_normals = what & BENT ? VK_TRUE : VK_FALSE;
    s->ssao.method = what & OTHER_METHOD ? VKAO_SSAO_VBAO : s->ssao.method;
    s->blur.radius += what & OTHER_RADIUS ? 1 : 0;
    s->variant.blur = what & NO_BLUR ? NULL : &s->blur;
}

/* With variants_only there are composite and debug besides. */
static void variants_make_their_own_pipelines_once(void **state)
{
    (void)state;
    static const struct {
        size_t count;
        unsigned what[3];
        size_t images, buffers; /* pipelines */
    } cases[] = {
        {0, {0}, 0, 0},
        {1, {FULL}, 4, 5}, /* prepare, ssao, blur x, blur y; in buffers the tiles of ssao */
        {1, {HALF}, 5, 6}, /* and upsample */
        {1, {BENT}, 4, 5},
        {1, {BENT | HALF}, 5, 6},
        {1, {NO_BLUR}, 2, 3},
        {2, {FULL, FULL}, 4, 5},
        {3, {HALF, HALF, HALF}, 5, 6},
        {2, {FULL, HALF}, 9, 10}, /* of one kind of tiles */
        {2, {BENT, BENT | HALF}, 9, 10},
        {2, {FULL, OTHER_METHOD}, 5, 6},
        {2, {FULL, BENT}, 7, 9},
        {2, {BENT, NO_BLUR}, 5, 7},      /* tiles that are open have a bent normal, or none */
        {2, {FULL, OTHER_RADIUS}, 4, 7}, /* loops over the radius are unrolled in buffers */
        {2, {FULL, NO_BLUR}, 4, 7}, /* ssao and its tiles write to the buffer or to the image */
        {3, {FULL, FULL, OTHER_METHOD}, 5, 6},
    };
    for (size_t i = 0; i < COUNT(cases) * 4; ++i) {
        const bool cpu = i & 1, only = i & 2;
        const size_t general = only ? 2 : cpu ? 23 : 18;
        struct world w;
        struct settings s, each[3];
        vkao_variant variants[3];
        settings_init(&w, &s, cpu);
        for (size_t k = 0; k < cases[i / 4].count; ++k) {
            settings_with(&w, cases[i / 4].what[k], &each[k]);
            variants[k] = each[k].variant;
        }
        settings_open(&w, variants, (uint32_t)cases[i / 4].count, only);
        assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_PIPELINE),
                         general + (cpu ? cases[i / 4].buffers : cases[i / 4].images));
        assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_SHADER_MODULE), 0);
        for (size_t k = 0; k < cases[i / 4].count; ++k)
            assert_int_equal(vkao_context_has_variant(w.ctx, &variants[k]), VK_TRUE);
        if (!cases[i / 4].count)
            assert_int_equal(vkao_context_has_variant(w.ctx, &s.variant), VK_FALSE);
        world_close(&w);
    }
}

static void sixty_four_variants_fit(void **state)
{
    (void)state;
    struct world w;
    struct settings s, each[64];
    vkao_variant variants[64];
    settings_init(&w, &s, false);
    for (uint32_t i = 0; i < COUNT(variants); ++i) {
        settings_with(&w, FULL, &each[i]);
        each[i].ssao.slice_count = 1;
        each[i].ssao.step_count = i + 1;
        variants[i] = each[i].variant;
    }
    settings_open(&w, variants, COUNT(variants), true);
    assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_PIPELINE), 2 + 3 + 64);
    world_close(&w);
}

/* Ways to spoil settings, and what the log then names. */
static const struct {
    const char *name, *value;
    size_t offset;
    uint64_t v;
    size_t bytes;
} spoils[] = {
    {"variant.struct_size", "8", offsetof(struct settings, variant.struct_size), 8, 4},
    {"variant.half_resolution", "2", offsetof(struct settings, variant.half_resolution), 2, 4},
    {"bent_normals", "3", offsetof(struct settings, variant.bent_normals), 3, 4},
    {"staged_ao", "7", offsetof(struct settings, variant.staged_ao), 7, 4},
    {"variant.view", "NULL", offsetof(struct settings, variant.view), 0, sizeof(void *)},
    {"ssao", "NULL", offsetof(struct settings, variant.ssao), 0, sizeof(void *)},
    {"variant.view.struct_size", "0", offsetof(struct settings, view.struct_size), 0, 4},
    {"view.projection", "neither", offsetof(struct settings, view.projection[11]), 0, 4},
    {"view.depth_encoding", "9", offsetof(struct settings, view.depth_encoding), 9, 4},
    {"view.valid", "5000x0", offsetof(struct settings, view.valid.extent.width), 5000, 4},
    {"ssao.method", "6", offsetof(struct settings, ssao.method), 6, 4},
    {"ssao.sample_count", "1025", offsetof(struct settings, ssao.sample_count), 1025, 4},
    {"method_mask", "0x8", offsetof(struct settings, ssao.method), VKAO_SSAO_HBAO, 4},
    {"blur.radius", "17", offsetof(struct settings, blur.radius), 17, 4},
};

static void bad_variants_are_refused_and_named(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(spoils); ++i) {
        struct world w;
        struct settings s, bad;
        settings_init(&w, &s, i & 1);
        settings_of(&w, &bad);
        memcpy((char *)&bad + spoils[i].offset, &spoils[i].v, spoils[i].bytes);
        const vkao_variant variants[2] = {s.variant, bad.variant};
        w.info.method_mask = 1u << VKAO_SSAO_GTAO;
        w.info.variants = variants;
        w.info.variant_count = 2;
        w.ctx = (vkao_context *)&w;
        vkao_result result = vkao_context_create(&w.info, &w.ctx);
        assert_null(w.ctx);
        expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, result, spoils[i].name, spoils[i].value);
        assert_int_equal(fake_count(&w.fake, "vkCreateComputePipelines"), 0);
        /* has_variant just says no. */
        settings_open(&w, &s.variant, 1, true);
        assert_int_equal(vkao_context_has_variant(w.ctx, &bad.variant), VK_FALSE);
        assert_int_equal(w.log.lines, 0);
        world_close(&w);
    }
}

static void bent_normals_need_a_method_that_has_them(void **state)
{
    (void)state;
    for (int method = 0; method < VKAO_METHOD_COUNT; ++method) {
        const bool has = VKAO_BENT_METHODS >> method & 1u;
        struct world w;
        struct settings s;
        settings_init(&w, &s, false);
        s.ssao.method = (vkao_ssao_method)method;
        s.variant.bent_normals = VK_TRUE;
        w.info.variants = &s.variant;
        w.info.variant_count = 1;
        vkao_result result = vkao_context_create(&w.info, &w.ctx);
        if (has)
            assert_int_equal(result, VKAO_SUCCESS);
        else
            expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, result, "ssao.method", "bent");
        world_close(&w);
    }
}

static void bad_lists_are_refused_and_named(void **state)
{
    (void)state;
    struct settings s;
    static const struct {
        const char *name, *value;
        uint32_t count, only;
        bool list;
    } cases[] = {
        {"context.variant_count", "65", 65, 0, true},
        {"context.variant_count", "4294967295", UINT32_MAX, 0, true},
        {"context.variants", "1", 1, 0, false},
        {"variants_only", "2", 0, 2, true},
    };
    for (size_t i = 0; i < COUNT(cases); ++i) {
        struct world w;
        settings_init(&w, &s, false);
        w.info.variants = cases[i].list ? &s.variant : NULL;
        w.info.variant_count = cases[i].count;
        w.info.variants_only = cases[i].only;
        expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, vkao_context_create(&w.info, &w.ctx),
                       cases[i].name, cases[i].value);
        assert_int_equal(w.fake.call_count, 0);
        world_close(&w);
    }
}

static void failing_nth_call_leaks_nothing(void **state)
{
    (void)state;
    for (int i = 0; i < 4; ++i) {
        unsigned n = 0;
        for (bool done = false; !done;) {
            struct world w;
            struct settings s;
            settings_init(&w, &s, i & 1);
            s.variant.half_resolution = VK_TRUE;
            w.info.variants = &s.variant;
            w.info.variant_count = 1;
            w.info.variants_only = VK_TRUE;
            if (i & 2)
                w.host.fail_at = ++n;
            else
                w.fake.fail_at = ++n;
            vkao_result result = vkao_context_create(&w.info, &w.ctx);
            done = i & 2 ? w.host.total < n : !w.fake.failed;
            assert_int_equal(result, done    ? VKAO_SUCCESS
                                     : i & 2 ? VKAO_ERROR_OUT_OF_HOST_MEMORY
                                             : VKAO_ERROR_VULKAN);
            assert_true(done == (w.ctx != NULL));
            assert_int_equal(w.log.errors, done ? 0 : 1);
            world_close(&w);
        }
        /* Two layouts, a module for each of 7 pipelines, or 8 in buffers; on the host two blocks
         * too. */
        assert_int_equal(n, 1 + 2 + (i & 1 ? 16 : 14) + (i & 2 ? 2 : 0));
    }
}

static bool is_variant(const struct world *w, uint64_t pipeline)
{
    const struct pipeline_entry *entry = entry_of(w->ctx, pipeline);
    assert_non_null(entry);
    return !entry_is_general(entry);
}

/* Bound since fake_forget_calls: pipelines of variants. */
static size_t bound_variants(const struct world *w)
{
    size_t count = 0;
    const struct fake_call *call;
    for (size_t i = 0; (call = fake_nth(&w->fake, "vkCmdBindPipeline", i)) != NULL; ++i)
        count += is_variant(w, call->handle);
    return count;
}

static void create_frame(struct world *w, vkao_stage_flags stages, bool half)
{
    w->frame_info.stages = stages;
    w->frame_info.half_resolution = half;
    assert_int_equal(vkao_frame_create(w->ctx, &w->frame_info, &w->frame), VKAO_SUCCESS);
    fake_forget_calls(&w->fake);
}

static void recordings_bind_the_variant_that_fits(void **state)
{
    (void)state;
    for (int i = 0; i < 16; ++i) {
        const bool cpu = i & 1, half = i & 2, bent = i & 4, only = i & 8;
        struct world w;
        struct settings s;
        settings_init(&w, &s, cpu);
        s.variant.half_resolution = half;
        s.variant.bent_normals = bent;
        settings_open(&w, &s.variant, 1, only);
        if (bent)
            world_use_bent_normals(&w);
        create_frame(&w, VKAO_STAGE_ALL, half);
        w.ssao.radius = 3.0f;
        w.blur.sharpness = 100.0f;
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        const size_t stages = (half ? 5u : 4u) + (cpu ? 1u : 0u); /* in buffers tiles too */
        assert_int_equal(bound_variants(&w), stages);
        assert_int_equal(fake_count(&w.fake, "vkCmdBindPipeline"), stages + 1); /* composite */
        fake_forget_calls(&w.fake);
        assert_int_equal(vkao_cmd_prepare(w.frame, world_cmd(&w), &w.view), VKAO_SUCCESS);
        assert_int_equal(vkao_cmd_ssao(w.frame, world_cmd(&w), &w.view, &w.ssao), VKAO_SUCCESS);
        assert_int_equal(vkao_cmd_blur(w.frame, world_cmd(&w), &w.view, &w.blur), VKAO_SUCCESS);
        assert_int_equal(bound_variants(&w), stages);
        world_close(&w);
    }
}

static void other_settings_take_the_general_pipelines(void **state)
{
    (void)state;
    for (int cpu = 0; cpu < 2; ++cpu) {
        struct world w;
        struct settings s;
        settings_init(&w, &s, cpu);
        settings_open(&w, &s.variant, 1, false);
        create_frame(&w, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR, false);
        w.ssao.step_count = 7; /* the other stages still find theirs */
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        assert_int_equal(bound_variants(&w), cpu ? 4 : 3); /* tiles know no steps */
        assert_int_equal(fake_count(&w.fake, "vkCmdBindPipeline"), cpu ? 5 : 4);
        world_close(&w);
    }
}

static void variants_only_refuses_other_settings(void **state)
{
    (void)state;
    for (int cpu = 0; cpu < 2; ++cpu) {
        struct world w;
        struct settings s;
        settings_init(&w, &s, cpu);
        settings_open(&w, &s.variant, 1, true);
        create_frame(&w, VKAO_STAGE_ALL, false);
        const VkCommandBuffer cmd = world_cmd(&w);
        const vkao_result refused = VKAO_ERROR_INVALID_ARGUMENT;
        s.view.depth_encoding = VKAO_DEPTH_VIEW_Z;
        s.ssao.falloff = VKAO_FALLOFF_THRESHOLD;
        s.blur.intensity = 2.0f;
        expect_refused(&w, refused, vkao_cmd_prepare(w.frame, cmd, &s.view), "variants_only",
                       "prepare");
        expect_refused(&w, refused, vkao_cmd_ssao(w.frame, cmd, &w.view, &s.ssao), "variants_only",
                       "ssao_gtao");
        expect_refused(&w, refused, vkao_cmd_blur(w.frame, cmd, &w.view, &s.blur), "variants_only",
                       "blur");
        expect_refused(&w, refused,
                       vkao_cmd_all(w.frame, cmd, &s.view, &w.ssao, &w.blur, &w.composite),
                       "variants_only", "prepare");
        expect_refused(&w, refused,
                       vkao_cmd_all(w.frame, cmd, &w.view, &s.ssao, &w.blur, &w.composite),
                       "variants_only", "ssao_gtao");
        expect_refused(&w, refused,
                       vkao_cmd_all(w.frame, cmd, &w.view, &w.ssao, &s.blur, &w.composite),
                       "variants_only", "blur");
        expect_nothing_recorded(&w);
        assert_int_equal(vkao_cmd_composite(w.frame, cmd, &w.view, &w.composite), VKAO_SUCCESS);
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        world_close(&w);
    }
}

/* Noisy AO that the caller wants to see goes through images. */
static void variants_in_buffers_are_for_frames_without_ao_noisy(void **state)
{
    (void)state;
    for (int cpu = 0; cpu < 2; ++cpu) {
        struct world w;
        struct settings s;
        settings_init(&w, &s, cpu);
        settings_open(&w, &s.variant, 1, true);
        w.images.ao_noisy =
            (vkao_image){fake_caller_view(&w.fake), VK_IMAGE_LAYOUT_GENERAL, VK_FORMAT_R8_UNORM};
        create_frame(&w, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR, false);
        vkao_result result = world_record_all(&w);
        if (cpu) {
            expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, result, "variants_only", "ssao_gtao");
            expect_nothing_recorded(&w);
        } else {
            assert_int_equal(result, VKAO_SUCCESS);
        }
        world_close(&w);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(variants_make_their_own_pipelines_once),
        cmocka_unit_test(sixty_four_variants_fit),
        cmocka_unit_test(bad_variants_are_refused_and_named),
        cmocka_unit_test(bent_normals_need_a_method_that_has_them),
        cmocka_unit_test(bad_lists_are_refused_and_named),
        cmocka_unit_test(failing_nth_call_leaks_nothing),
        cmocka_unit_test(recordings_bind_the_variant_that_fits),
        cmocka_unit_test(other_settings_take_the_general_pipelines),
        cmocka_unit_test(variants_only_refuses_other_settings),
        cmocka_unit_test(variants_in_buffers_are_for_frames_without_ao_noisy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
