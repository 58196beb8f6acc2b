/* SPDX-License-Identifier: MIT
 *
 * Composite with multi-bounce and with occluded specular light. */
#include "fixture.h"
#include "ref_composite.h"
#include "ref_normal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static double noise(uint32_t *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (double)(*seed >> 8) / 16777216.0;
}

static void fill(struct picture *p, enum picture_slot slot, uint32_t seed)
{
    size_t count = picture_texels(p) * picture_channels(slot);
    double *values = test_alloc(count, sizeof *values);
    for (size_t i = 0; i < count; ++i)
        values[i] = noise(&seed);
    picture_set(p, slot,
                picture_channels(slot) == 1 ? VK_FORMAT_R32_SFLOAT : VK_FORMAT_R32G32B32A32_SFLOAT,
                values);
    free(values);
}

/* A frame that only composites: AO and every image of light hold noise, normals are a sphere's
 * before the sky. */
static void make(struct picture *p, bool orthographic, double forward)
{
    const struct scene scene = scene_open_sky();
    struct lens lens = orthographic ? lens_orthographic(1.6, 1.2) : lens_perspective(0.6, 0.45);
    uint32_t seed = 99;
    lens.forward = forward;
    picture_init(p, 80, 60, VKAO_STAGE_COMPOSITE);
    p->view.depth_encoding = VKAO_DEPTH_VIEW_Z;
    p->view.normal_encoding = VKAO_NORMALS_XYZ_SNORM;
    picture_render_scene(p, &scene, &lens, VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT);
    fill(p, SLOT_AO, 1);
    fill(p, SLOT_COLOR, 2);
    fill(p, SLOT_DIRECT, 3);
    fill(p, SLOT_ALBEDO, 4);
    fill(p, SLOT_SPECULAR, 5);
    picture_set(p, SLOT_BENT, VK_FORMAT_R32G32B32A32_SFLOAT, p->values[SLOT_NORMALS]);
    for (size_t i = 0; i < picture_texels(p); ++i) {
        double *bent = &p->values[SLOT_BENT][i * 4], length = 0.0;
        for (int c = 0; c < 3; ++c)
            bent[c] += 0.4 * (noise(&seed) - 0.5);
        length = sqrt(ref_dot(bent, bent));
        for (int c = 0; c < 3; ++c)
            bent[c] = isfinite(p->values[SLOT_DEPTH][i]) ? bent[c] / length : 0.0;
        /* as renderers write the sky */
        for (int c = 0; c < 3 && !isfinite(p->values[SLOT_DEPTH][i]); ++c)
            p->values[SLOT_NORMALS][i * 4 + (size_t)c] = 0.0;
    }
    picture_set(p, SLOT_OUTPUT, VK_FORMAT_R32G32B32A32_SFLOAT, NULL);
    p->composite.strength = 0.75f;
    p->composite.tint[0] = 0.25f;
}

static double specular(const struct picture *p, const struct ref_view *view, size_t i)
{
    const vkao_normal_encoding encoding =
        p->view.bent_encoding ? p->view.bent_encoding : VKAO_NORMALS_XYZ_SNORM;
    const double *direction = &p->values[SLOT_BENT][i * 4],
                 nothing = encoding == VKAO_NORMALS_XYZ_UNORM ? 0.5 : 0.0;
    double n[3], bent[3], at[3], v[3], ao = p->values[SLOT_AO][i];
    double roughness = p->values[SLOT_SPECULAR][i * 4 + 3];
    if (!ref_normal_decode(p->view.normal_encoding, &p->values[SLOT_NORMALS][i * 4], n))
        return ao; /* nothing is known of the sky */
    ref_view_position(view, (double)(i % p->width), (double)(i / p->width), 1.0, at);
    ref_view_eye(view, at, v);
    n[2] *= view->forward;
    const double side = ref_dot(n, v) < 0.0 ? -1.0 : 1.0;
    for (int c = 0; c < 3; ++c)
        n[c] *= side;
    if (p->composite.specular == VKAO_SPECULAR_FROM_AO)
        return ref_specular_from_ao(ao, roughness, n, v);
    if (direction[0] == nothing && direction[1] == nothing && direction[2] == nothing)
        return ao;
    assert_true(ref_normal_decode(encoding, direction, bent));
    bent[2] *= view->forward;
    return ref_specular_from_bent(ao, roughness, n, v, bent);
}

static void expected(const struct picture *p, double *out)
{
    struct ref_view view;
    ref_view_init(&view, &p->view, p->width, p->height, p->formats[SLOT_DEPTH]);
    for (size_t i = 0; i < picture_texels(p); ++i) {
        double factor = p->composite.specular ? specular(p, &view, i) : 0.0,
               ao = p->values[SLOT_AO][i];
        for (size_t c = 0; c < 3; ++c) {
            double texel[4], albedo = p->values[SLOT_ALBEDO][i * 4 + c];
            ref_composite(&p->composite,
                          p->composite.multi_bounce ? ref_multi_bounce(ao, albedo) : ao,
                          &p->values[SLOT_COLOR][i * 4], &p->values[SLOT_DIRECT][i * 4], texel);
            double weight = 1.0 + (double)p->composite.strength * (factor - 1.0);
            bool lit = p->composite.mode != VKAO_COMPOSITE_AO_ONLY && p->composite.specular;
            out[i * 4 + c] = texel[c] + (lit ? p->values[SLOT_SPECULAR][i * 4 + c] * weight : 0.0);
            out[i * 4 + 3] = texel[3];
        }
    }
}

/* Runs the picture. Light is that of the AO and the bent normals that come out, where other stages
 * make them. */
static void check_formulas(struct picture *p, const char *what)
{
    const size_t count = picture_texels(p) * 4;
    double *want = test_alloc(count, sizeof *want);
    picture_run(p);
    expected(p, want);
    /* acos of single precision near 1, divided by the size of a narrow lobe */
    const bool cones = p->composite.specular == VKAO_SPECULAR_FROM_BENT &&
                       p->composite.mode != VKAO_COMPOSITE_AO_ONLY;
    check_close(what, p->values[SLOT_OUTPUT], want, count, cones ? 1e-4 : 1e-6, cones ? 2e-3 : 1e-5,
                cones ? 1e-2 : 1e-5);
    free(want);
}

static void every_mode_follows_its_formulas(void **state)
{
    (void)state;
    for (int i = 0; i < 3 * 2 * 3 * 4; ++i) {
        struct picture p;
        char what[80];
        bool orthographic = i / 18 & 1;
        make(&p, orthographic, i / 36 ? 1.0 : -1.0);
        p.composite.mode = (vkao_composite_mode)(i % 3);
        p.composite.multi_bounce = i / 3 % 2 ? VK_TRUE : VK_FALSE;
        p.composite.specular = (vkao_specular)(i / 6 % 3);
        snprintf(what, sizeof what, "mode %d, multi-bounce %u, specular %d, %s",
                 (int)p.composite.mode, p.composite.multi_bounce, (int)p.composite.specular,
                 orthographic ? "orthographic" : "perspective");
        check_formulas(&p, what);
        picture_free(&p);
    }
}

/* Two thirds of the normals face the eye; a fifth of the surface has no mean direction, as where
 * all is hidden: AO alone decides there. Directions are encoded as normals are, or not. */
static void other_sides_and_hidden_places_reflect(void **state)
{
    (void)state;
    for (int i = 0; i < 2 * 2 * 2; ++i) {
        struct picture p;
        char what[80];
        const bool cones = i % 2, orthographic = i / 2 % 2, apart = i / 4;
        make(&p, orthographic, -1.0);
        p.composite.specular = cones ? VKAO_SPECULAR_FROM_BENT : VKAO_SPECULAR_FROM_AO;
        for (size_t t = 0; t < picture_texels(&p); ++t)
            for (size_t c = 0; c < 3; ++c) {
                p.values[SLOT_NORMALS][t * 4 + c] *= t % 3 == 0 ? -1.0 : 1.0;
                p.values[SLOT_BENT][t * 4 + c] *= t % 5 == 0 ? 0.0 : 1.0;
            }
        p.view.bent_encoding = apart ? VKAO_NORMALS_XYZ_UNORM : VKAO_NORMALS_FROM_DEPTH;
        for (size_t v = 0; v < picture_texels(&p) * 4 && apart; ++v)
            p.values[SLOT_BENT][v] = 0.5 * p.values[SLOT_BENT][v] + 0.5;
        snprintf(what, sizeof what, "%s, %s%s", cones ? "cones" : "AO",
                 orthographic ? "orthographic" : "perspective", apart ? ", encoded apart" : "");
        check_formulas(&p, what);
        picture_free(&p);
    }
}

/* Behind the other stages, which run on every second texel: light is that of every texel still. */
static void specular_light_is_seen_from_the_eye_at_half_resolution(void **state)
{
    (void)state;
    for (int i = 0; i < 2; ++i) {
        struct picture p;
        const bool cones = i == 1;
        make(&p, false, -1.0);
        p.stages = VKAO_STAGE_ALL;
        p.half_resolution = true;
        p.composite.specular = cones ? VKAO_SPECULAR_FROM_BENT : VKAO_SPECULAR_FROM_AO;
        check_formulas(&p, cones ? "cones" : "AO");
        picture_free(&p);
    }
}

/* An open place reflects all that there is, whatever its roughness, when seen from straight above;
 * a closed one nothing. */
static void open_is_bright_and_closed_is_dark_at_every_roughness(void **state)
{
    (void)state;
    for (int i = 0; i < 2 * 2; ++i) {
        struct picture p;
        const struct scene wall = scene_tilted_plane(0.0, 0.0);
        struct lens lens = lens_orthographic(1.6, 1.2);
        make(&p, true, -1.0);
        picture_render_scene(&p, &wall, &lens, VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT);
        picture_set(&p, SLOT_BENT, VK_FORMAT_R32G32B32A32_SFLOAT, p.values[SLOT_NORMALS]);
        picture_fill(&p, SLOT_AO, VK_FORMAT_R32_SFLOAT, i / 2 ? 0.0 : 1.0);
        picture_fill(&p, SLOT_COLOR, VK_FORMAT_R32G32B32A32_SFLOAT, 0.0);
        picture_fill(&p, SLOT_SPECULAR, VK_FORMAT_R32G32B32A32_SFLOAT, 1.0);
        for (size_t t = 0; t < picture_texels(&p); ++t)
            p.values[SLOT_SPECULAR][t * 4 + 3] = (double)(t % p.width) / (p.width - 1);
        p.composite.strength = 1.0f;
        p.composite.specular = i % 2 ? VKAO_SPECULAR_FROM_BENT : VKAO_SPECULAR_FROM_AO;
        picture_run(&p);
        for (size_t t = 0; t < picture_texels(&p); ++t) {
            double got = p.values[SLOT_OUTPUT][t * 4],
                   roughness = p.values[SLOT_SPECULAR][t * 4 + 3];
            if (!(fabs(got - (i / 2 ? 0.0 : 1.0)) < 0.01))
                fail_msg("specular %d, AO %d, roughness %g: %g", (int)p.composite.specular,
                         i / 2 ? 0 : 1, roughness, got);
        }
        picture_free(&p);
    }
}

/* White walls brighten what is occluded, black ones do not, and neither changes what is open or
 * closed. */
static void multi_bounce_brightens_by_albedo(void **state)
{
    (void)state;
    double last[80 * 60] = {0.0};
    for (int i = 0; i <= 4; ++i) {
        struct picture p;
        make(&p, false, -1.0);
        picture_fill(&p, SLOT_ALBEDO, VK_FORMAT_R32G32B32A32_SFLOAT, i * 0.25);
        p.composite = ao_composite_default();
        p.composite.mode = VKAO_COMPOSITE_AO_ONLY;
        p.composite.multi_bounce = VK_TRUE;
        p.values[SLOT_AO][0] = 0.0;
        p.values[SLOT_AO][1] = 1.0;
        picture_run(&p);
        assert_true(p.values[SLOT_OUTPUT][0] == 0.0);
        assert_true(fabs(p.values[SLOT_OUTPUT][4] - 1.0) < 0.002);
        for (size_t t = 2; t < picture_texels(&p); ++t) {
            double got = p.values[SLOT_OUTPUT][t * 4], ao = p.values[SLOT_AO][t];
            assert_true(got >= ao && got <= 1.002 && got >= last[t]);
            last[t] = got;
        }
        picture_free(&p);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        gpu_test(every_mode_follows_its_formulas),
        gpu_test(other_sides_and_hidden_places_reflect),
        gpu_test(specular_light_is_seen_from_the_eye_at_half_resolution),
        gpu_test(open_is_bright_and_closed_is_dark_at_every_roughness),
        gpu_test(multi_bounce_brightens_by_albedo),
    };
    return fixture_run(tests);
}
