/* SPDX-License-Identifier: MIT */
#include "ssao_checks.h"

#include "ref_normal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Single and double precision disagree about a few samples at the edge of a texel or of blocking. A
 * point or ray that flips is worth 2/n, a horizon as much as the step to the next sample, a sector
 * bound of VBAO, which the shader has from a cubic that is off by up to .0053, 1/31 of a slice. A
 * wall in an orthographic view has the same bound in all texels that look in one of the 32
 * directions of the noise: one of them that flips is a mean of 1/31/32. */
static const struct {
    double mean, p99, max;
} tolerances[] = {
    [VKAO_SSAO_SPHERE] = {1e-4, 1e-3, 0.07},   [VKAO_SSAO_HEMISPHERE] = {1e-4, 1e-3, 0.07},
    [VKAO_SSAO_HBAO] = {1e-4, 1e-3, 0.07},     [VKAO_SSAO_GTAO] = {1e-4, 1e-3, 0.07},
    [VKAO_SSAO_VBAO] = {1.3e-3, 2.2e-2, 0.15}, [VKAO_SSAO_RAYMARCH] = {1e-4, 1e-3, 0.07},
};

void check_ssao(struct picture *p, ssao_reference *reference, const char *what)
{
    struct ref_scene scene;
    size_t texels = picture_texels(p);
    double *expected = test_alloc(texels, sizeof *expected);
    picture_run(p);
    picture_reference_scene(p, &scene);
    reference(&scene, &p->ssao, expected);
    check_close(what, p->values[SLOT_AO], expected, texels, tolerances[p->ssao.method].mean,
                tolerances[p->ssao.method].p99, tolerances[p->ssao.method].max);
    /* An image without occlusion would agree with a shader that does nothing. */
    assert_true(mean_of(expected, texels) < 0.995);
    ref_scene_free(&scene);
    free(expected);
}

void check_every_normal_encoding(const struct ao_ssao *params, ssao_reference *reference)
{
    static const struct {
        const char *name;
        vkao_normal_encoding encoding;
        VkFormat format;
    } rows[] = {
        {"normals from depth", VKAO_NORMALS_FROM_DEPTH, VK_FORMAT_UNDEFINED},
        {"normals xyz RGBA32F", VKAO_NORMALS_XYZ_SNORM, VK_FORMAT_R32G32B32A32_SFLOAT},
        {"normals xyz RGBA16F", VKAO_NORMALS_XYZ_SNORM, VK_FORMAT_R16G16B16A16_SFLOAT},
        {"normals xyz RGBA8_SNORM", VKAO_NORMALS_XYZ_SNORM, VK_FORMAT_R8G8B8A8_SNORM},
        {"normals xyz RGBA8_UNORM", VKAO_NORMALS_XYZ_UNORM, VK_FORMAT_R8G8B8A8_UNORM},
        {"normals xyz A2B10G10R10_UNORM", VKAO_NORMALS_XYZ_UNORM,
         VK_FORMAT_A2B10G10R10_UNORM_PACK32},
        {"normals octahedral RG16_SNORM", VKAO_NORMALS_OCT_SNORM, VK_FORMAT_R16G16_SNORM},
        {"normals octahedral RG16F", VKAO_NORMALS_OCT_SNORM, VK_FORMAT_R16G16_SFLOAT},
        {"normals octahedral RG16_UNORM", VKAO_NORMALS_OCT_UNORM, VK_FORMAT_R16G16_UNORM},
    };
    const struct scene scene = scene_corner();
    for (size_t i = 0; i < sizeof rows / sizeof rows[0] * 2; ++i) {
        struct picture p;
        char what[80];
        struct lens lens = lens_perspective(0.6, 0.45);
        /* Normals that face the eye have z > 0 or z < 0: octahedral ones are folded or not. */
        lens.forward = i % 2 ? 1.0 : -1.0;
        picture_make(&p, VKAO_STAGE_SSAO, &scene);
        p.ssao = *params;
        p.view.normal_encoding = rows[i / 2].encoding;
        picture_render_scene(&p, &scene, &lens, VK_FORMAT_R32_SFLOAT, rows[i / 2].format);
        snprintf(what, sizeof what, "%s, %s-handed", rows[i / 2].name, i % 2 ? "left" : "right");
        check_ssao(&p, reference, what);
        picture_free(&p);
    }
}

void check_world_space_normals(const struct ao_ssao *params, ssao_reference *reference)
{
    /* Columns of an orthonormal matrix that is neither symmetric nor close to the identity. */
    static const double columns[3][3] = {{2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0},
                                         {2.0 / 3.0, 2.0 / 3.0, -1.0 / 3.0},
                                         {-1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0}};
    struct picture p, turned;
    const struct scene scene = scene_corner();
    picture_make(&p, VKAO_STAGE_SSAO, &scene);
    picture_make(&turned, VKAO_STAGE_SSAO, &scene);
    p.ssao = turned.ssao = *params;
    for (int i = 0; i < 9; ++i)
        turned.view.normal_to_view[i] = (float)columns[i / 3][i % 3];
    for (size_t i = 0; i < picture_texels(&p); ++i) {
        double *view = &p.values[SLOT_NORMALS][i * 4];
        /* The box shows sides whose normals lie across the view. Once turned there and back, their
         * z is rounding, whose sign chooses the tangents. */
        view[2] = fabs(view[2]) < 1e-3 ? -1e-3 : view[2];
        for (int c = 0; c < 3; ++c) /* the transpose turns back */
            turned.values[SLOT_NORMALS][i * 4 + (size_t)c] = ref_dot(columns[c], view);
    }
    picture_run(&p);
    check_ssao(&turned, reference, "world-space normals against the reference");
    check_close("world-space against view-space normals", turned.values[SLOT_AO], p.values[SLOT_AO],
                picture_texels(&p), 1e-3, 0.02, 0.1);
    picture_free(&p);
    picture_free(&turned);
}

void check_every_projection(const struct ao_ssao *params, ssao_reference *reference)
{
    static const struct {
        const char *name;
        bool orthographic, reversed, y_up;
        double forward, shift, lift;
        bool depth_only, sky;
    } rows[] = {
        {"perspective, left-handed, y up", false, false, true, 1.0, 0.0, 0.0, false, false},
        {"perspective, right-handed, off-centre", false, false, false, -1.0, 0.3, 0.0, false,
         false},
        {"orthographic, right-handed", true, false, false, -1.0, 0.0, 0.0, false, false},
        {"orthographic, left-handed, reversed, off-centre", true, true, true, 1.0, 0.5, 0.0, false,
         false},
        /* The floor turns its back on the origin, but not on the camera. */
        {"orthographic, lifted", true, false, false, 1.0, 0.0, -2.5, false, false},
        {"perspective, y up, depth only", false, false, true, 1.0, 0.0, 0.0, true, false},
        {"orthographic, y up, depth only", true, false, true, -1.0, 0.0, 0.0, true, false},
        {"perspective, sky", false, false, false, -1.0, 0.0, 0.0, false, true},
        {"orthographic, sky", true, false, false, -1.0, 0.0, 0.0, false, true},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        struct picture p;
        struct scene scene = rows[i].sky ? scene_posts() : scene_corner();
        struct lens lens =
            rows[i].orthographic ? lens_orthographic(1.6, 1.2) : lens_perspective(0.6, 0.45);
        lens.x0 += rows[i].shift;
        lens.x1 += rows[i].shift;
        lens.y0 += rows[i].lift;
        lens.y1 += rows[i].lift;
        for (int shape = 0; shape < SCENE_SHAPES; ++shape)
            scene.shapes[shape].center[1] += rows[i].lift;
        lens.reversed = rows[i].reversed;
        lens.forward = rows[i].forward;
        if (rows[i].y_up) {
            double y = lens.y0;
            lens.y0 = lens.y1;
            lens.y1 = y;
        }
        picture_make(&p, VKAO_STAGE_SSAO, &scene);
        p.ssao = *params;
        if (rows[i].sky)
            p.ssao.radius = 1.0f; /* from post to post */
        if (rows[i].depth_only)
            p.view.normal_encoding = VKAO_NORMALS_FROM_DEPTH;
        picture_render_scene(&p, &scene, &lens, VK_FORMAT_R32_SFLOAT,
                             rows[i].depth_only ? VK_FORMAT_UNDEFINED
                                                : VK_FORMAT_R32G32B32A32_SFLOAT);
        check_ssao(&p, reference, rows[i].name);
        picture_free(&p);
    }
}

void check_bad_normals_are_replaced(const struct ao_ssao *params, ssao_reference *reference)
{
    static const double bad[][3] = {
        {0.0, 0.0, 0.0},
        {0.2, 0.2, -0.2},
        {(double)NAN, 0.0, 1.0},
        {0.0, (double)INFINITY, 0.0},
        {0.0, 0.0, -1e30},
        /* Away from the eye: the back of some surfaces, no side of others. */
        {0.2, -0.1, -0.97},
        {-0.1, -0.35, -0.93}};
    const struct scene scene = scene_corner();
    const struct lens orthographic = lens_orthographic(1.6, 1.2);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0] * 2; ++i) {
        const size_t row = i / 2;
        struct picture p;
        char what[60];
        picture_make(&p, VKAO_STAGE_SSAO, &scene);
        p.ssao = *params;
        if (i % 2)
            picture_render_scene(&p, &scene, &orthographic, VK_FORMAT_R32_SFLOAT,
                                 VK_FORMAT_R32G32B32A32_SFLOAT);
        for (size_t t = 0; t < picture_texels(&p) * 4; ++t)
            p.values[SLOT_NORMALS][t] = t % 4 < 3 ? bad[row][t % 4] : 0.0;
        snprintf(what, sizeof what, "bad normals %zu, %s", row,
                 i % 2 ? "orthographic" : "perspective");
        check_ssao(&p, reference, what);
        picture_free(&p);
    }
}

void check_no_nan_at_the_limits(const struct ao_ssao *params)
{
    static const uint32_t extents[][2] = {{1, 1}, {33, 1}, {1, 33}, {2, 2}, {17, 9}};
    static const float radii[] = {1e-30f, 1e-3f, 100.0f, 1e30f};
    const struct scene scene = scene_corner();
    struct lens lens = lens_perspective(0.6, 0.45);
    for (size_t i = 0; i < sizeof extents / sizeof extents[0] * 4; ++i) {
        struct picture p;
        picture_init(&p, extents[i / 4][0], extents[i / 4][1], VKAO_STAGE_SSAO | VKAO_STAGE_BLUR);
        p.ssao = *params;
        p.ssao.radius = radii[i % 4];
        picture_render_scene(&p, &scene, &lens, VK_FORMAT_D32_SFLOAT, VK_FORMAT_UNDEFINED);
        picture_set(&p, SLOT_AO, VK_FORMAT_R32_SFLOAT, NULL);
        picture_run(&p);
        for (size_t texel = 0; texel < picture_texels(&p); ++texel) {
            double ao = p.values[SLOT_AO][texel];
            if (!(ao >= 0.0 && ao <= 1.0))
                fail_msg("%ux%u, radius %g: texel %zu is %g", p.width, p.height,
                         (double)p.ssao.radius, texel, ao);
        }
        picture_free(&p);
    }
}
