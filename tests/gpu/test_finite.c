/* SPDX-License-Identifier: MIT
 *
 * Whatever depth, normals, noisy AO, reflectance and roughness hold, and however odd the settings
 * are that pass the checks: no output has a NaN or an infinity, and AO is within [0,1]. */
#include "fixture.h"
#include "hostile.h"

#include <float.h>
#include <math.h>

#define COUNT(array) (uint32_t)(sizeof(array) / sizeof(array)[0])
#define PICK(chance, array) (array)[chance_below(chance, COUNT(array))]

static const double pi = 3.14159265358979323846;
static const float tiny = 0x1p-149f;

/* Cases come in groups of the same compiled settings, which are drawn from a sequence of the
 * group's own: a software driver takes longer to compile an effect than to run it. */
enum { GROUP = 25 };

/* --- Settings --- */

static struct lens odd_lens(struct chance *settings, struct chance *chance, double aspect)
{
    static const double degrees[] = {1e-3, 0.1, 40.0, 90.0, 150.0, 179.0, 179.9, 179.99};
    const double half = tan(PICK(chance, degrees) * pi / 360.0);
    struct lens lens = lens_perspective(half, half / aspect);
    if (chance_yes(settings, 0.3)) {
        const double width = chance_magnitude(chance, 1e-7, 1e9);
        lens = lens_orthographic(width, width / aspect);
        lens.near = chance_yes(chance, 0.5) ? 0.0 : -chance_magnitude(chance, 1e-3, 1e6);
        lens.far = chance_magnitude(chance, 1e-2, 1e12) - lens.near;
    } else {
        lens.near = chance_magnitude(chance, 1e-9, 1.0);
        lens.far = chance_yes(chance, 0.3) ? (double)INFINITY
                                           : lens.near * chance_magnitude(chance, 2.0, 1e9);
        lens.x1 *= chance_yes(chance, 0.2) ? 3.0 : 1.0; /* off-centre */
    }
    lens.reversed = chance_yes(chance, 0.5);
    lens.forward = chance_yes(chance, 0.5) ? 1.0 : -1.0;
    if (chance_yes(chance, 0.3)) {
        const double y0 = lens.y0;
        lens.y0 = lens.y1;
        lens.y1 = y0;
    }
    return lens;
}

static void odd_matrix(struct chance *chance, float matrix[9])
{
    static const float scales[] = {0.0f, 1e-38f, -1.0f, 3.0f, 1e30f, FLT_MAX};
    if (chance_yes(chance, 0.6))
        return;
    const float scale = PICK(chance, scales);
    for (int i = 0; i < 9; ++i)
        matrix[i] *= scale;
    if (chance_yes(chance, 0.3)) /* no rotation at all */
        for (int i = 0; i < 9; ++i)
            matrix[i] = (float)chance_between(chance, -1.0, 1.0) * scale;
}

static void odd_ssao(struct chance *settings, struct chance *chance, struct ao_ssao *ssao)
{
    static const float biases[] = {0.0f, 0.005f, 1.0f}, thicknesses[] = {0.0f, tiny, 1.0f, 8.0f},
                       scales[] = {tiny, 50.0f, FLT_MAX}, radii[] = {tiny, 1e-20f, 1e20f, FLT_MAX};
    ssao->method = (vkao_ssao_method)chance_below(settings, VKAO_SSAO_RAYMARCH + 1);
    ssao->falloff = (vkao_falloff)chance_below(settings, 2);
    ssao->sphere_form = (vkao_sphere_form)chance_below(settings, 2);
    ssao->sample_count = 1 + chance_below(settings, 9);
    ssao->slice_count = 1 + chance_below(settings, 3);
    ssao->step_count = 1 + chance_below(settings, 6);
    ssao->noise_index = chance_below(chance, UINT32_MAX);
    ssao->radius =
        chance_yes(chance, 0.7) ? (float)chance_magnitude(chance, 1e-9, 1e9) : PICK(chance, radii);
    ssao->bias = PICK(chance, biases);
    ssao->thickness = PICK(chance, thicknesses);
    ssao->blocking_scale = PICK(chance, scales);
}

static void odd_blur(struct chance *settings, struct chance *chance, struct ao_blur *blur)
{
    static const float sharpness[] = {0.0f, tiny, 1.0f, 200.0f, 10000.0f},
                       normals[] = {0.0f, tiny, 8.0f, 128.0f}, powers[] = {1.0f, tiny, 0.5f, 8.0f},
                       intensities[] = {1.0f, 0.0f, tiny, 8.0f};
    static const uint32_t radii[] = {0, 1, 3, 16};
    blur->radius = PICK(settings, radii);
    blur->sharpness = PICK(chance, sharpness);
    blur->normal_power = PICK(settings, normals);
    blur->power = PICK(chance, powers);
    blur->intensity = PICK(chance, intensities);
}

/* --- Images --- */

/* Numbers between, with hostile ones among them. */
static void odd_values(struct picture *p, struct chance *chance, enum picture_slot slot, double low,
                       double high)
{
    picture_fill(p, slot,
                 picture_channels(slot) == 1 ? VK_FORMAT_R32_SFLOAT : VK_FORMAT_R32G32B32A32_SFLOAT,
                 0.0);
    const size_t count = picture_texels(p) * picture_channels(slot);
    for (size_t i = 0; i < count; ++i)
        p->values[slot][i] = chance_between(chance, low, high);
    if (chance_yes(chance, 0.8))
        hostile_spread(chance, (enum hostile_pattern)chance_below(chance, HOSTILE_PATTERNS),
                       p->values[slot], p->width, p->height, picture_channels(slot));
}

/* A scene, a slope, or depths of all magnitudes. */
static void odd_depth(struct picture *p, struct chance *settings, struct chance *chance)
{
    const struct lens lens = odd_lens(settings, chance, (double)p->width / p->height);
    const struct scene scene = scene_corner();
    const uint32_t kind = chance_below(chance, 4);
    const double scale = chance_magnitude(chance, 1e-12, 1e12);
    if (lens.orthographic)
        p->view.axis = lens.forward < 0.0 ? VKAO_VIEW_AXIS_NEGATIVE_Z : VKAO_VIEW_AXIS_POSITIVE_Z;
    picture_render_scene(p, &scene, &lens, VK_FORMAT_R32_SFLOAT, VK_FORMAT_UNDEFINED);
    for (size_t i = 0; kind > 0 && i < picture_texels(p); ++i) {
        double *z = &p->values[SLOT_DEPTH][i];
        *z = scale * (1.0 + 0.01 * chance_between(chance, 0.0, (double)kind));
        if (kind == 3)
            *z = chance_magnitude(chance, 1e-37, 1e38);
        if (p->view.depth_encoding == VKAO_DEPTH_PROJECTED)
            *z = kind == 3 ? chance_between(chance, -0.1, 1.1) : 1.0 - 1.0 / (1.0 + *z);
    }
    if (chance_yes(chance, 0.7))
        hostile_spread(chance, (enum hostile_pattern)chance_below(chance, HOSTILE_PATTERNS),
                       p->values[SLOT_DEPTH], p->width, p->height, 1);
}

static void lit_images(struct picture *p, struct chance *settings, struct chance *chance)
{
    static const float distances[] = {0.0f, tiny, 100.0f, FLT_MAX};
    const bool ssao = p->stages & VKAO_STAGE_SSAO, bent = p->formats[SLOT_BENT];
    const vkao_composite_mode modes[] = {
        VKAO_COMPOSITE_MULTIPLY,
        VKAO_COMPOSITE_INDIRECT,
        VKAO_COMPOSITE_AO_ONLY,
        ssao ? VKAO_COMPOSITE_NORMALS : VKAO_COMPOSITE_MULTIPLY,
        ssao ? VKAO_COMPOSITE_VIEW_Z : VKAO_COMPOSITE_INDIRECT,
        ssao && bent ? VKAO_COMPOSITE_BENT_NORMALS : VKAO_COMPOSITE_MULTIPLY,
    };
    p->composite.mode = PICK(settings, modes);
    p->composite.strength =
        chance_yes(chance, 0.7) ? 1.0f : (float)chance_between(chance, 0.0, 1.0);
    p->composite.debug_distance = PICK(chance, distances);
    picture_fill(p, SLOT_COLOR, VK_FORMAT_R32G32B32A32_SFLOAT, 100.0);
    picture_fill(p, SLOT_DIRECT, VK_FORMAT_R32G32B32A32_SFLOAT, 10.0);
    odd_values(p, chance, SLOT_ALBEDO, 0.0, 1.0);
    odd_values(p, chance, SLOT_SPECULAR, 0.0, 1.0);
    for (size_t i = 0; i < picture_texels(p) * 4; ++i)
        /* roughness alone */
        p->values[SLOT_SPECULAR][i] = i % 4 < 3 ? 1.0 : p->values[SLOT_SPECULAR][i];
    p->composite.multi_bounce = chance_yes(settings, 0.5);
    if (p->composite.mode < VKAO_COMPOSITE_AO_ONLY && p->view.normal_encoding)
        p->composite.specular = (vkao_specular)chance_below(settings, bent ? 3 : 2);
    picture_set(p, SLOT_OUTPUT, VK_FORMAT_R16G16B16A16_SFLOAT, NULL);
}

static void make(struct picture *p, struct chance *settings, struct chance *chance)
{
    static const vkao_stage_flags stages[] = {VKAO_STAGE_SSAO | VKAO_STAGE_BLUR,
                                              VKAO_STAGE_SSAO | VKAO_STAGE_BLUR,
                                              VKAO_STAGE_ALL,
                                              VKAO_STAGE_ALL,
                                              VKAO_STAGE_SSAO,
                                              VKAO_STAGE_BLUR,
                                              VKAO_STAGE_COMPOSITE,
                                              VKAO_STAGE_SSAO | VKAO_STAGE_COMPOSITE};
    /* Few shapes and formats: a software driver compiles for each. None of these is a power of
     * two, nor are half of it and what vkao_view_z_extent() makes of either. */
    static const uint32_t widths[] = {17, 19, 26, 35}, heights[] = {9, 13, 22};
    const vkao_stage_flags both = VKAO_STAGE_SSAO | VKAO_STAGE_BLUR;
    const bool dot = chance_yes(chance, 0.05);
    picture_init(p, dot ? 1 : PICK(chance, widths), dot ? 1 : PICK(chance, heights),
                 PICK(settings, stages));
    p->view.depth_encoding = (vkao_depth_encoding)chance_below(settings, 4);
    p->view.normal_encoding = (vkao_normal_encoding)chance_below(settings, 5);
    p->view.bent_encoding = (vkao_normal_encoding)chance_below(settings, 5);
    odd_depth(p, settings, chance);
    odd_matrix(chance, p->view.normal_to_view);
    odd_values(p, chance, SLOT_NORMALS, -1.0, 1.0);
    odd_ssao(settings, chance, &p->ssao);
    odd_blur(settings, chance, &p->blur);
    const bool has_both = (p->stages & both) == both;
    if (has_both && p->ssao.method >= VKAO_SSAO_GTAO && chance_yes(settings, 0.7))
        picture_set(p, SLOT_BENT, VK_FORMAT_R32G32B32A32_SFLOAT, NULL);
    p->half_resolution = has_both && chance_yes(settings, 0.4);
    picture_set(p, SLOT_AO, VK_FORMAT_R32_SFLOAT, NULL);
    p->staged = chance_yes(chance, 0.5);
    if (p->stages == VKAO_STAGE_BLUR)
        odd_values(p, chance, SLOT_NOISY, -1.0, 2.0);
    if (p->stages & VKAO_STAGE_COMPOSITE) {
        if (p->stages == VKAO_STAGE_COMPOSITE) {
            odd_values(p, chance, SLOT_AO, -1.0, 2.0);
            odd_values(p, chance, SLOT_BENT, -1.0, 1.0);
        }
        lit_images(p, settings, chance);
    }
}

/* --- Checks --- */

/* The texel that is not as promised; the image's number of texels if there is none. */
static size_t first_wrong(const struct picture *p, enum picture_slot slot, double low, double high)
{
    const uint32_t channels = picture_channels(slot);
    for (size_t i = 0; i < picture_texels(p) * channels; ++i) {
        const double v = p->values[slot][i];
        if (!(v >= low && v <= high) || isinf(v))
            return i / channels;
    }
    return picture_texels(p);
}

static bool outputs_are_finite(const struct picture *p, uint64_t seed)
{
    const bool ao_is_output = p->stages != VKAO_STAGE_COMPOSITE,
               blurred = p->stages & VKAO_STAGE_BLUR;
    const struct {
        enum picture_slot slot;
        bool written;
        double low, high;
    } outputs[] = {
        {SLOT_AO, ao_is_output, blurred ? 0.0 : -4.0, blurred ? 1.0 : 4.0},
        {SLOT_BENT, ao_is_output, -1.001, 1.001},
        {SLOT_OUTPUT, true, 0.0, (double)INFINITY},
    };
    for (uint32_t i = 0; i < COUNT(outputs); ++i) {
        const enum picture_slot slot = outputs[i].slot;
        if (!p->formats[slot] || !outputs[i].written)
            continue;
        const size_t texel = first_wrong(p, slot, outputs[i].low, outputs[i].high),
                     at = texel * picture_channels(slot);
        if (texel == picture_texels(p))
            continue;
        print_error("case %llu: stages %u, method %d, depth %d, normals %d, bent %d, composite %d, "
                    "half %d, %s: "
                    "texel %zu of slot %d is %g\n",
                    (unsigned long long)seed, p->stages, (int)p->ssao.method,
                    (int)p->view.depth_encoding, (int)p->view.normal_encoding,
                    (int)p->view.bent_encoding, (int)p->composite.mode, p->half_resolution,
                    p->view.projection[15] > 0.0f ? "orthographic" : "perspective", texel,
                    (int)slot, p->values[slot][at]);
        return false;
    }
    return true;
}

static void outputs_are_finite_and_ao_is_a_share(void **state)
{
    (void)state;
    const uint64_t seed = 100000;
    uint32_t wrong = 0, count = 1000;
    for (uint32_t i = 0; i < count; ++i) {
        struct chance settings = chance_of(seed + i / GROUP), chance = chance_of(2 * seed + i);
        struct picture p;
        make(&p, &settings, &chance);
        picture_run(&p);
        wrong += !outputs_are_finite(&p, seed + i);
        picture_free(&p);
    }
    print_message("    %u cases: %u wrong\n", count, wrong);
    assert_int_equal(wrong, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        gpu_test(outputs_are_finite_and_ao_is_a_share),
    };
    return fixture_run(tests);
}
