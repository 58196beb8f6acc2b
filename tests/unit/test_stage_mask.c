/* SPDX-License-Identifier: MIT
 *
 * context.stage_mask: which pipelines a context then has, and which frames it refuses. */
#include "pipelines.h"
#include "settings.h"

#include <stdio.h>

/* General pipelines of each stage: in images, and what buffers add. Prepare comes with SSAO and
 * BLUR; three methods, blur x and y and upsample and the tiles have a form with bent normals. */
enum { PREPARE = 1, SSAO = 9, BLUR = 6, COMPOSITE = 2, TILES = 2, PACKED_BLUR = 3 };

static size_t general_count(vkao_stage_flags mask, bool buffers)
{
    mask = mask ? mask : VKAO_STAGE_ALL;
    return (mask & (VKAO_STAGE_SSAO | VKAO_STAGE_BLUR) ? PREPARE : 0u) +
           (mask & VKAO_STAGE_SSAO ? SSAO + (buffers ? TILES : 0u) : 0u) +
           (mask & VKAO_STAGE_BLUR ? BLUR + (buffers ? PACKED_BLUR : 0u) : 0u) +
           (mask & VKAO_STAGE_COMPOSITE ? COMPOSITE : 0u);
}

static void init(struct world *w, bool buffers, vkao_stage_flags mask)
{
    world_init(w, true);
    w->info.scratch_layout = buffers ? VKAO_SCRATCH_BUFFERS : VKAO_SCRATCH_IMAGES;
    w->info.stage_mask = mask;
}

static void pipelines_are_those_of_the_stages(void **state)
{
    (void)state;
    /* What the sums above come to. */
    static const size_t all[2] = {18, 23}, composite = 2;
    for (unsigned i = 0; i < (VKAO_STAGE_ALL + 1) * 2; ++i) {
        const bool buffers = i & 1;
        const vkao_stage_flags mask = i / 2;
        struct world w;
        init(&w, buffers, mask);
        assert_int_equal(vkao_context_create(&w.info, &w.ctx), VKAO_SUCCESS);
        const size_t count = fake_live_of(&w.fake, VK_OBJECT_TYPE_PIPELINE);
        assert_int_equal(count, general_count(mask, buffers));
        assert_int_equal(count, w.ctx->pipelines.count);
        assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_SHADER_MODULE), 0);
        if (!mask || mask == VKAO_STAGE_ALL)
            assert_int_equal(count, all[buffers]);
        if (mask == VKAO_STAGE_COMPOSITE)
            assert_int_equal(count, composite);
        world_close(&w);
    }
}

static void method_mask_counts_within_ssao(void **state)
{
    (void)state;
    for (vkao_stage_flags mask = 1; mask <= VKAO_STAGE_ALL; ++mask) {
        struct world w;
        init(&w, true, mask);
        w.info.method_mask = 1u << VKAO_SSAO_SPHERE;
        assert_int_equal(vkao_context_create(&w.info, &w.ctx), VKAO_SUCCESS);
        assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_PIPELINE),
                         general_count(mask, true) - (mask & VKAO_STAGE_SSAO ? SSAO - 1 : 0));
        world_close(&w);
    }
}

/* What a frame of these stages may not have. */
static void leave_out(struct world *w, vkao_stage_flags stages)
{
    const vkao_stage_flags both = VKAO_STAGE_SSAO | VKAO_STAGE_BLUR;
    w->frame_info.stages = stages;
    if ((stages & both) == both)
        w->images.ao_noisy = (vkao_image){0};
}

static void frames_of_other_stages_are_refused(void **state)
{
    (void)state;
    for (unsigned i = 0; i < (VKAO_STAGE_ALL + 1) * (VKAO_STAGE_ALL + 1) * 2; ++i) {
        const bool buffers = i & 1;
        const vkao_stage_flags stages = i / 2 % (VKAO_STAGE_ALL + 1),
                               mask = i / 2 / (VKAO_STAGE_ALL + 1);
        if (!stages)
            continue;
        struct world w;
        VkMemoryRequirements need;
        init(&w, buffers, mask);
        assert_int_equal(vkao_context_create(&w.info, &w.ctx), VKAO_SUCCESS);
        leave_out(&w, stages);
        const size_t before = fake_live(&w.fake);
        const vkao_result query = vkao_frame_scratch(w.ctx, &w.frame_info, &need);
        if (!mask || !(stages & ~mask)) {
            assert_int_equal(query, VKAO_SUCCESS);
            assert_int_equal(vkao_frame_create(w.ctx, &w.frame_info, &w.frame), VKAO_SUCCESS);
            assert_int_equal(world_record_all(&w), VKAO_SUCCESS); /* by pipelines that live */
            assert_int_equal(w.log.lines, 0);
        } else {
            char value[16];
            snprintf(value, sizeof value, "0x%x", mask);
            expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, query, "frame.stages", value);
            expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT,
                           vkao_frame_create(w.ctx, &w.frame_info, &w.frame), "stage_mask", value);
            assert_null(w.frame);
            assert_int_equal(fake_live(&w.fake), before);
        }
        world_close(&w);
    }
}

static void bits_that_are_no_stages_are_refused(void **state)
{
    (void)state;
    static const struct {
        vkao_stage_flags mask;
        const char *value;
    } cases[] = {{0x8u, "0x8"}, {0xfu, "0xf"}, {0x80000000u, "0x80000000"}};
    for (size_t i = 0; i < COUNT(cases); ++i) {
        struct world w;
        init(&w, false, cases[i].mask);
        w.ctx = (vkao_context *)&w;
        const vkao_result result = vkao_context_create(&w.info, &w.ctx);
        assert_null(w.ctx);
        expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, result, "context.stage_mask",
                       cases[i].value);
        assert_int_equal(w.fake.call_count, 0);
        world_close(&w);
    }
}

/* No frame could run them. */
static void variants_are_compiled_for_the_mask_alone(void **state)
{
    (void)state;
    for (unsigned i = 0; i < (VKAO_STAGE_ALL + 1) * 4; ++i) {
        const bool cpu = i & 1, blur = i & 2;
        const vkao_stage_flags mask = i / 4,
                               wants = VKAO_STAGE_SSAO | (blur ? VKAO_STAGE_BLUR : 0u);
        struct world w;
        struct settings s;
        settings_init(&w, &s, cpu);
        w.info.stage_mask = mask;
        s.variant.half_resolution = blur;
        s.variant.blur = blur ? &s.blur : NULL;
        settings_open(&w, &s.variant, 1, true);
        const vkao_stage_flags made = mask ? mask : VKAO_STAGE_ALL;
        const size_t want = (made & (VKAO_STAGE_SSAO | VKAO_STAGE_BLUR) ? PREPARE : 0u) +
                            (made & VKAO_STAGE_SSAO ? 1u + cpu : 0u) +
                            (made & VKAO_STAGE_BLUR && blur ? 3u : 0u) +
                            (made & VKAO_STAGE_COMPOSITE ? COMPOSITE : 0u);
        const size_t got = fake_live_of(&w.fake, VK_OBJECT_TYPE_PIPELINE);
        if (got != want)
            fail_msg("mask 0x%x: %zu pipelines, want %zu", mask, got, want);
        assert_int_equal(vkao_context_has_variant(w.ctx, &s.variant),
                         wants & ~made ? VK_FALSE : VK_TRUE);
        world_close(&w);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pipelines_are_those_of_the_stages),
        cmocka_unit_test(method_mask_counts_within_ssao),
        cmocka_unit_test(frames_of_other_stages_are_refused),
        cmocka_unit_test(bits_that_are_no_stages_are_refused),
        cmocka_unit_test(variants_are_compiled_for_the_mask_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
