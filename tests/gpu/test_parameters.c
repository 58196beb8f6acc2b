/* SPDX-License-Identifier: MIT
 *
 * A parameter that changes nothing is a lie: one row for each field of ssao, blur, composite and
 * view. */
#include "fixture.h"

#include <stdlib.h>
#include <string.h>

static void base(struct picture *p)
{
    const struct scene scene = scene_corner();
    picture_make(p, VKAO_STAGE_ALL, &scene);
    picture_set(p, SLOT_NOISY, VK_FORMAT_R32_SFLOAT, NULL);
    picture_fill(p, SLOT_COLOR, VK_FORMAT_R32G32B32A32_SFLOAT, 0.5);
    picture_fill(p, SLOT_DIRECT, VK_FORMAT_R32G32B32A32_SFLOAT, 0.25);
    picture_set(p, SLOT_OUTPUT, VK_FORMAT_R32G32B32A32_SFLOAT, NULL);
    p->ssao.method = VKAO_SSAO_HEMISPHERE;
    p->composite.mode = VKAO_COMPOSITE_MULTIPLY;
}

static void sphere(struct picture *p)
{
    p->ssao.method = VKAO_SSAO_SPHERE;
}

#define METHOD(name, value)                                                                        \
    static void name(struct picture *p)                                                            \
    {                                                                                              \
        p->ssao.method = value;                                                                    \
        p->ssao.slice_count = 2;                                                                   \
    }
METHOD(hbao, VKAO_SSAO_HBAO)
METHOD(gtao, VKAO_SSAO_GTAO)
METHOD(vbao, VKAO_SSAO_VBAO)
METHOD(raymarch, VKAO_SSAO_RAYMARCH)

/* Lit by everything that there is; AO and bent normals of VBAO. */
static void lit(struct picture *p)
{
    p->ssao.method = VKAO_SSAO_VBAO;
    p->formats[SLOT_NOISY] = VK_FORMAT_UNDEFINED;
    picture_set(p, SLOT_BENT, VK_FORMAT_R32G32B32A32_SFLOAT, NULL);
    picture_fill(p, SLOT_ALBEDO, VK_FORMAT_R32G32B32A32_SFLOAT, 0.75);
    picture_fill(p, SLOT_SPECULAR, VK_FORMAT_R32G32B32A32_SFLOAT, 0.25);
    p->composite.specular = VKAO_SPECULAR_FROM_AO;
}

static void bent(struct picture *p)
{
    lit(p);
    p->composite.mode = VKAO_COMPOSITE_BENT_NORMALS;
}

static void view_z(struct picture *p)
{
    p->composite.mode = VKAO_COMPOSITE_VIEW_Z;
}

static void literal(struct picture *p)
{
    p->ssao.method = VKAO_SSAO_SPHERE;
    p->ssao.sphere_form = VKAO_SPHERE_LITERAL;
}

static void orthographic(struct picture *p)
{
    const struct scene scene = scene_corner();
    struct lens lens = lens_orthographic(1.6, 1.2);
    p->view.depth_encoding = VKAO_DEPTH_PROJECTED;
    picture_render_scene(p, &scene, &lens, VK_FORMAT_D32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT);
}

static void projected(struct picture *p)
{
    const struct scene scene = scene_corner();
    struct lens lens = lens_perspective(0.6, 0.45);
    p->view.depth_encoding = VKAO_DEPTH_PROJECTED;
    picture_render_scene(p, &scene, &lens, VK_FORMAT_D32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT);
}

#define CHANGE(name, statement)                                                                    \
    static void name(struct picture *p)                                                            \
    {                                                                                              \
        statement;                                                                                 \
    }
CHANGE(ssao_method, p->ssao.method = VKAO_SSAO_SPHERE)
CHANGE(ssao_falloff, p->ssao.falloff = VKAO_FALLOFF_THRESHOLD)
CHANGE(ssao_sample_count, p->ssao.sample_count = 24)
CHANGE(ssao_noise_index, p->ssao.noise_index = 1)
CHANGE(ssao_radius, p->ssao.radius = 0.6f)
CHANGE(ssao_bias, p->ssao.bias = 0.1f)
CHANGE(ssao_blocking_scale, p->ssao.blocking_scale = 20.0f)
CHANGE(ssao_slice_count, p->ssao.slice_count = 3)
CHANGE(ssao_step_count, p->ssao.step_count = 13)
CHANGE(ssao_thickness, p->ssao.thickness = 0.25f)
CHANGE(frame_half_resolution, p->formats[SLOT_NOISY] = VK_FORMAT_UNDEFINED;
       p->half_resolution = true)
CHANGE(composite_multi_bounce, p->composite.multi_bounce = VK_TRUE)
CHANGE(composite_no_specular, p->composite.specular = VKAO_SPECULAR_NONE)
CHANGE(composite_bent_specular, p->composite.specular = VKAO_SPECULAR_FROM_BENT)
CHANGE(composite_noisy, p->composite.mode = VKAO_COMPOSITE_NOISY_AO)
CHANGE(composite_normals, p->composite.mode = VKAO_COMPOSITE_NORMALS)
CHANGE(composite_debug_distance, p->composite.debug_distance = 50.0f)
CHANGE(blur_radius, p->blur.radius = 5)
CHANGE(blur_sharpness, p->blur.sharpness = 100.0f)
CHANGE(blur_normal_power, p->blur.normal_power = 2.0f)
CHANGE(blur_intensity, p->blur.intensity = 1.25f)
CHANGE(blur_power, p->blur.power = 1.25f)
CHANGE(composite_indirect, p->composite.mode = VKAO_COMPOSITE_INDIRECT)
CHANGE(composite_ao_only, p->composite.mode = VKAO_COMPOSITE_AO_ONLY)
CHANGE(composite_strength, p->composite.strength = 0.5f)
CHANGE(composite_tint_red, p->composite.tint[0] = 0.5f)
CHANGE(composite_tint_green, p->composite.tint[1] = 0.5f)
CHANGE(composite_tint_blue, p->composite.tint[2] = 0.5f)
CHANGE(view_depth_encoding, p->view.depth_encoding = VKAO_DEPTH_DISTANCE)
CHANGE(view_normal_encoding, p->view.normal_encoding = VKAO_NORMALS_FROM_DEPTH)
CHANGE(view_normal_unorm, p->view.normal_encoding = VKAO_NORMALS_XYZ_UNORM)
CHANGE(view_normal_oct, p->view.normal_encoding = VKAO_NORMALS_OCT_SNORM)
CHANGE(view_normal_oct_unorm, p->view.normal_encoding = VKAO_NORMALS_OCT_UNORM)
CHANGE(view_bent_encoding, p->view.bent_encoding = VKAO_NORMALS_OCT_UNORM)
CHANGE(view_axis, p->view.axis = VKAO_VIEW_AXIS_POSITIVE_Z)
CHANGE(view_valid, p->view.valid = ((VkRect2D){{0, 0}, {70, 50}}))
CHANGE(view_viewport, p->view.viewport = ((VkRect2D){{-10, -10}, {100, 80}}))
CHANGE(view_rect, p->view.rect = ((VkRect2D){{0, 0}, {70, 50}}))
CHANGE(view_projection_x_scale, p->view.projection[0] *= 1.2f)
CHANGE(view_projection_y_scale, p->view.projection[5] *= 1.2f)
CHANGE(view_projection_x_offset, p->view.projection[8] += 0.2f)
CHANGE(view_projection_y_offset, p->view.projection[9] += 0.2f)
CHANGE(view_projection_z_scale, p->view.projection[10] *= 1.001f)
CHANGE(view_projection_z_offset, p->view.projection[14] *= 1.1f)
CHANGE(view_normal_to_view, p->view.normal_to_view[0] = p->view.normal_to_view[8] = -1.0f)

struct row {
    const char *name;
    void (*change)(struct picture *p);
    void (*prepare)(struct picture *p); /* NULL = hemisphere, perspective */
};

static const struct row rows[] = {
    {"ssao.method", ssao_method, NULL},
    {"ssao.method hbao", hbao, NULL},
    {"ssao.method gtao", gtao, NULL},
    {"ssao.method vbao", vbao, NULL},
    {"ssao.method raymarch", raymarch, NULL},
    {"ssao.falloff, hbao", ssao_falloff, hbao},
    {"ssao.noise_index, hbao", ssao_noise_index, hbao},
    {"ssao.radius, hbao", ssao_radius, hbao},
    {"ssao.bias, hbao", ssao_bias, hbao},
    {"ssao.step_count, hbao", ssao_step_count, hbao},
    {"ssao.slice_count, hbao", ssao_slice_count, hbao},
    {"ssao.falloff, gtao", ssao_falloff, gtao},
    {"ssao.noise_index, gtao", ssao_noise_index, gtao},
    {"ssao.radius, gtao", ssao_radius, gtao},
    {"ssao.bias, gtao", ssao_bias, gtao},
    {"ssao.step_count, gtao", ssao_step_count, gtao},
    {"ssao.slice_count, gtao", ssao_slice_count, gtao},
    {"ssao.falloff, vbao", ssao_falloff, vbao},
    {"ssao.noise_index, vbao", ssao_noise_index, vbao},
    {"ssao.radius, vbao", ssao_radius, vbao},
    {"ssao.bias, vbao", ssao_bias, vbao},
    {"ssao.step_count, vbao", ssao_step_count, vbao},
    {"ssao.slice_count, vbao", ssao_slice_count, vbao},
    {"ssao.thickness, vbao", ssao_thickness, vbao},
    {"ssao.falloff, raymarch", ssao_falloff, raymarch},
    {"ssao.noise_index, raymarch", ssao_noise_index, raymarch},
    {"ssao.radius, raymarch", ssao_radius, raymarch},
    {"ssao.bias, raymarch", ssao_bias, raymarch},
    {"ssao.step_count, raymarch", ssao_step_count, raymarch},
    {"ssao.sample_count, raymarch", ssao_sample_count, raymarch},
    {"ssao.thickness, raymarch", ssao_thickness, raymarch},
    {"frame.half_resolution", frame_half_resolution, vbao},
    {"composite.multi_bounce", composite_multi_bounce, lit},
    {"composite.specular none", composite_no_specular, lit},
    {"composite.specular from bent", composite_bent_specular, lit},
    {"composite.mode noisy ao", composite_noisy, NULL},
    {"composite.mode normals", composite_normals, NULL},
    {"composite.mode view z", view_z, NULL},
    {"composite.mode bent normals", bent, lit},
    {"composite.debug_distance", composite_debug_distance, view_z},
    {"ssao.falloff, hemisphere", ssao_falloff, NULL},
    {"ssao.falloff, sphere", ssao_falloff, sphere},
    {"ssao.sphere_form", literal, sphere},
    {"ssao.sample_count, hemisphere", ssao_sample_count, NULL},
    {"ssao.sample_count, sphere", ssao_sample_count, sphere},
    {"ssao.sample_count, literal", ssao_sample_count, literal},
    {"ssao.noise_index, hemisphere", ssao_noise_index, NULL},
    {"ssao.noise_index, sphere", ssao_noise_index, sphere},
    {"ssao.noise_index, literal", ssao_noise_index, literal},
    {"ssao.radius, hemisphere", ssao_radius, NULL},
    {"ssao.radius, sphere", ssao_radius, sphere},
    {"ssao.radius, literal", ssao_radius, literal},
    {"ssao.bias, hemisphere", ssao_bias, NULL},
    {"ssao.bias, sphere", ssao_bias, sphere},
    {"ssao.blocking_scale", ssao_blocking_scale, literal},
    {"blur.radius", blur_radius, NULL},
    {"blur.sharpness", blur_sharpness, NULL},
    {"blur.normal_power", blur_normal_power, NULL},
    {"blur.intensity", blur_intensity, NULL},
    {"blur.power", blur_power, NULL},
    {"composite.mode indirect", composite_indirect, NULL},
    {"composite.mode ao only", composite_ao_only, NULL},
    {"composite.strength", composite_strength, NULL},
    {"composite.tint[0]", composite_tint_red, NULL},
    {"composite.tint[1]", composite_tint_green, NULL},
    {"composite.tint[2]", composite_tint_blue, NULL},
    {"view.depth_encoding", view_depth_encoding, NULL},
    {"view.normal_encoding from depth", view_normal_encoding, NULL},
    {"view.normal_encoding unorm", view_normal_unorm, NULL},
    {"view.normal_encoding octahedral", view_normal_oct, NULL},
    {"view.normal_encoding octahedral unorm", view_normal_oct_unorm, NULL},
    {"view.bent_encoding", view_bent_encoding, lit},
    {"view.axis", view_axis, orthographic},
    {"view.valid", view_valid, NULL},
    {"view.viewport", view_viewport, NULL},
    {"view.rect", view_rect, NULL},
    {"view.projection[0]", view_projection_x_scale, NULL},
    {"view.projection[5]", view_projection_y_scale, NULL},
    {"view.projection[8]", view_projection_x_offset, NULL},
    {"view.projection[9]", view_projection_y_offset, NULL},
    {"view.projection[10]", view_projection_z_scale, projected},
    {"view.projection[14]", view_projection_z_offset, projected},
    {"view.normal_to_view", view_normal_to_view, NULL},
};

static void every_parameter_changes_the_picture(void **state)
{
    (void)state;
    size_t dead = 0;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        struct picture before, after;
        base(&before);
        base(&after);
        if (rows[i].prepare) {
            rows[i].prepare(&before);
            rows[i].prepare(&after);
        }
        rows[i].change(&after);
        picture_run(&before);
        picture_run(&after);
        enum picture_slot slot = rows[i].change == view_bent_encoding ? SLOT_BENT : SLOT_OUTPUT;
        struct difference d = difference_of(before.values[slot], after.values[slot], 80 * 60 * 4);
        print_message("    %-44s mean change %.2e\n", rows[i].name, d.mean);
        if (!(d.mean > 1e-5)) {
            print_error("%s changes nothing\n", rows[i].name);
            ++dead;
        }
        picture_free(&before);
        picture_free(&after);
    }
    assert_int_equal(dead, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        gpu_test(every_parameter_changes_the_picture),
    };
    return fixture_run(tests);
}
