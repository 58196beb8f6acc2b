/* SPDX-License-Identifier: MIT
 *
 * AO onto colour. */
#include "fixture.h"
#include "ref_composite.h"

#include <stdlib.h>
#include <string.h>

static void make(struct picture *p, vkao_composite_mode mode, VkFormat format)
{
    picture_init(p, 40, 25, VKAO_STAGE_COMPOSITE);
    size_t texels = picture_texels(p);
    double *values = test_alloc(texels * 4, sizeof *values);
    for (size_t i = 0; i < texels; ++i)
        values[i] = (double)(i % 41) / 40.0;
    picture_set(p, SLOT_AO, VK_FORMAT_R32_SFLOAT, values);
    for (size_t i = 0; i < texels * 4; ++i)
        values[i] = (double)(i % 97) / 64.0;
    picture_set(p, SLOT_COLOR, format, values);
    for (size_t i = 0; i < texels * 4; ++i)
        values[i] = (double)(i % 31) / 64.0;
    picture_set(p, SLOT_DIRECT, format, values);
    free(values);
    p->composite.mode = mode;
    p->composite.strength = 0.75f;
    p->composite.tint[0] = 0.5f;
    p->composite.tint[1] = 0.125f;
}

static double *expected(const struct picture *p)
{
    double *out = test_alloc(picture_texels(p) * 4, sizeof *out);
    for (size_t i = 0; i < picture_texels(p); ++i)
        ref_composite(&p->composite, p->values[SLOT_AO][i], &p->values[SLOT_COLOR][i * 4],
                      &p->values[SLOT_DIRECT][i * 4], &out[i * 4]);
    return out;
}

static void modes_follow_their_formulas_in_every_format(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        VkFormat format;
        double tolerance;
    } rows[] = {
        {"RGBA32F", VK_FORMAT_R32G32B32A32_SFLOAT, 1e-6},
        {"RGBA16F", VK_FORMAT_R16G16B16A16_SFLOAT, 2e-3},
        {"RGBA8", VK_FORMAT_R8G8B8A8_UNORM, 2.1e-3},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0] * 3; ++i) {
        struct picture p;
        make(&p, (vkao_composite_mode)(i % 3), rows[i / 3].format);
        picture_set(&p, SLOT_OUTPUT, rows[i / 3].format, NULL);
        double *want = expected(&p);
        for (size_t v = 0;
             rows[i / 3].format == VK_FORMAT_R8G8B8A8_UNORM && v < picture_texels(&p) * 4; ++v)
            want[v] = want[v] > 1.0 ? 1.0 : want[v];
        picture_run(&p);
        /* Both the mean and all but a hundredth: there is nothing discontinuous here. */
        check_close(rows[i / 3].name, p.values[SLOT_OUTPUT], want, picture_texels(&p) * 4,
                    rows[i / 3].tolerance, rows[i / 3].tolerance, 2.0 * rows[i / 3].tolerance);
        free(want);
        picture_free(&p);
    }
}

static void output_may_be_the_color_image(void **state)
{
    (void)state;
    for (int mode = 0; mode < 3; ++mode) {
        struct picture apart, in_place;
        make(&apart, (vkao_composite_mode)mode, VK_FORMAT_R16G16B16A16_SFLOAT);
        make(&in_place, (vkao_composite_mode)mode, VK_FORMAT_R16G16B16A16_SFLOAT);
        picture_set(&apart, SLOT_OUTPUT, VK_FORMAT_R16G16B16A16_SFLOAT, NULL);
        in_place.output_is_color = true;
        picture_run(&apart);
        picture_run(&in_place);
        check_equal("output", in_place.values[SLOT_COLOR], apart.values[SLOT_OUTPUT],
                    picture_texels(&apart) * 4);
        picture_free(&apart);
        picture_free(&in_place);
    }
}

/* Ambient occlusion has nothing to say about direct light. */
static void indirect_leaves_direct_light_alone(void **state)
{
    (void)state;
    struct picture p;
    make(&p, VKAO_COMPOSITE_INDIRECT, VK_FORMAT_R32G32B32A32_SFLOAT);
    picture_fill(&p, SLOT_COLOR, VK_FORMAT_R32G32B32A32_SFLOAT, 0.0);
    picture_set(&p, SLOT_OUTPUT, VK_FORMAT_R32G32B32A32_SFLOAT, NULL);
    picture_run(&p);
    for (size_t i = 0; i < picture_texels(&p) * 4; ++i)
        assert_true(p.values[SLOT_OUTPUT][i] == (i % 4 == 3 ? 0.0 : p.values[SLOT_DIRECT][i]));
    picture_free(&p);
}

static void rect_leaves_exterior_untouched(void **state)
{
    (void)state;
    struct picture p;
    make(&p, VKAO_COMPOSITE_MULTIPLY, VK_FORMAT_R32G32B32A32_SFLOAT);
    picture_set(&p, SLOT_OUTPUT, VK_FORMAT_R32G32B32A32_SFLOAT, NULL);
    double canary = p.values[SLOT_OUTPUT][0], *want = expected(&p);
    p.view.rect = (VkRect2D){{5, 7}, {19, 11}};
    picture_run(&p);
    for (size_t i = 0; i < picture_texels(&p) * 4; ++i) {
        size_t x = i / 4 % p.width, y = i / 4 / p.width;
        bool inside = x >= 5 && x < 24 && y >= 7 && y < 18;
        double delta = p.values[SLOT_OUTPUT][i] - (inside ? want[i] : canary);
        assert_true(delta < 1e-6 && delta > -1e-6);
    }
    free(want);
    picture_free(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        gpu_test(modes_follow_their_formulas_in_every_format),
        gpu_test(output_may_be_the_color_image),
        gpu_test(indirect_leaves_direct_light_alone),
        gpu_test(rect_leaves_exterior_untouched),
    };
    return fixture_run(tests);
}
