/* SPDX-License-Identifier: MIT
 *
 * View z in 16-bit floats: the same promises, at half the memory. */
#include "fixture.h"

#include <math.h>
#include <stdio.h>

static const struct {
    const char *name;
    vkao_ssao_method method;
    double difference; /* mean, from 32-bit view z */
} methods[] = {
    {"sphere", VKAO_SSAO_SPHERE, 0.004}, {"hemisphere", VKAO_SSAO_HEMISPHERE, 0.002},
    {"hbao", VKAO_SSAO_HBAO, 0.002},     {"gtao", VKAO_SSAO_GTAO, 0.008},
    {"vbao", VKAO_SSAO_VBAO, 0.002},     {"raymarch", VKAO_SSAO_RAYMARCH, 0.008},
};
enum { METHODS = sizeof methods / sizeof methods[0] };

static vkao_context *half_context(void)
{
    vkao_context *context = NULL;
    vkao_context_info info = fixture_context_info();
    info.half_view_z = VK_TRUE;
    check_vkao(vkao_context_create(&info, &context));
    return context;
}

/* Runs the picture with the context in the fixture's place. */
static void run_with(vkao_context *context, struct picture *p)
{
    vkao_context *kept = fixture.context;
    fixture.context = context;
    picture_run(p);
    fixture.context = kept;
}

static void make(struct picture *p, int method, const struct scene *scene)
{
    picture_make(p, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR, scene);
    p->ssao.method = methods[method].method;
    p->ssao.sample_count = 32;
}

static void tilted_planes_are_open(void **state)
{
    (void)state;
    vkao_context *context = half_context();
    for (int i = 0; i < METHODS * 5; ++i) {
        struct picture p;
        const struct scene wall = scene_tilted_plane(20.0 * (i / METHODS), 25.0);
        make(&p, i % METHODS, &wall);
        run_with(context, &p);
        for (size_t t = 0; t < picture_texels(&p); ++t) {
            if (fabs(p.values[SLOT_AO][t] - 1.0) > 0.002)
                fail_msg("%s, %g degrees: texel %zu is %g", methods[i % METHODS].name,
                         20.0 * (i / METHODS), t, p.values[SLOT_AO][t]);
        }
        picture_free(&p);
    }
    vkao_context_destroy(context);
}

static void ao_is_that_of_full_precision(void **state)
{
    (void)state;
    vkao_context *context = half_context();
    const struct scene scene = scene_corner();
    for (int i = 0; i < METHODS; ++i) {
        struct picture full, half;
        double sum = 0.0;
        make(&full, i, &scene);
        make(&half, i, &scene);
        picture_run(&full);
        run_with(context, &half);
        for (size_t t = 0; t < picture_texels(&full); ++t)
            sum += fabs(full.values[SLOT_AO][t] - half.values[SLOT_AO][t]);
        double mean = sum / (double)picture_texels(&full);
        print_message("    %-10s mean difference %.5f\n", methods[i].name, mean);
        assert_true(mean > 0.0 && mean < methods[i].difference);
        picture_free(&full);
        picture_free(&half);
    }
    vkao_context_destroy(context);
}

static VkDeviceSize scratch_bytes(vkao_context *context)
{
    vkao_images images = vkao_images_default();
    VkMemoryRequirements need;
    images.depth.format = images.ao.format = VK_FORMAT_R32_SFLOAT;
    images.depth.layout = images.ao.layout = VK_IMAGE_LAYOUT_GENERAL;
    check_vkao(vkao_frame_scratch(context,
                                  &(vkao_frame_info){
                                      .struct_size = sizeof(vkao_frame_info),
                                      .stages = VKAO_STAGE_SSAO,
                                      .extent = {1920, 1080},
                                      .images = &images,
                                  },
                                  &need));
    return need.size;
}

static void scratch_is_half(void **state)
{
    (void)state;
    vkao_context *context = half_context();
    /* Without a blur view z is all there is; drivers may pad a little. */
    assert_true(scratch_bytes(context) * 100 < scratch_bytes(fixture.context) * 51);
    vkao_context_destroy(context);
}

static void the_feature_must_be_enabled(void **state)
{
    (void)state;
    vkao_context *context = NULL;
    VkPhysicalDeviceFeatures features = {0};
    vkao_add_required_features(&features);
    vkao_context_info info = fixture_context_info();
    info.enabled_features = &features;
    info.half_view_z = VK_TRUE;
    assert_int_equal(vkao_context_create(&info, &context), VKAO_ERROR_UNSUPPORTED);
    assert_null(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        gpu_test(tilted_planes_are_open),
        gpu_test(ao_is_that_of_full_precision),
        gpu_test(scratch_is_half),
        gpu_test(the_feature_must_be_enabled),
    };
    return fixture_run(tests);
}
