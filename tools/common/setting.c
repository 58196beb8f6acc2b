/* SPDX-License-Identifier: MIT */
#include "setting.h"

#include <stdbool.h>
#include <string.h>

struct ao_ssao ao_ssao_default(void)
{
    const vkao_effect_info e = vkao_effect_info_default();
    const vkao_params p = vkao_params_default();
    return (struct ao_ssao){
        .method = e.method,
        .falloff = e.falloff,
        .sphere_form = e.sphere_form,
        .sample_count = e.sample_count,
        .slice_count = e.slice_count,
        .step_count = e.step_count,
        .noise_index = p.noise_index,
        .radius = p.radius,
        .bias = p.bias,
        .thickness = p.thickness,
        .blocking_scale = p.blocking_scale,
    };
}

struct ao_blur ao_blur_default(void)
{
    const vkao_effect_info e = vkao_effect_info_default();
    const vkao_params p = vkao_params_default();
    return (struct ao_blur){e.blur_radius, e.blur_normal_power, p.sharpness, p.intensity, p.power};
}

struct ao_composite ao_composite_default(void)
{
    const vkao_params p = vkao_params_default();
    return (struct ao_composite){.strength = p.strength, .debug_distance = p.debug_distance};
}

struct ao_view ao_view_default(void)
{
    struct ao_view v = {.depth_encoding = VKAO_DEPTH_PROJECTED};
    v.normal_to_view[0] = v.normal_to_view[4] = v.normal_to_view[8] = 1.0f;
    return v;
}

vkao_result ao_preset(vkao_quality quality, VkBool32 *half_resolution, struct ao_ssao *ssao,
                      struct ao_blur *blur)
{
    vkao_effect_info e = vkao_effect_info_default();
    vkao_params p = vkao_params_default();
    const vkao_result result = vkao_preset(quality, &e, &p);
    if (result != VKAO_SUCCESS)
        return result;
    if (half_resolution)
        *half_resolution = e.half_resolution;
    if (ssao) {
        ssao->method = e.method;
        ssao->slice_count = e.slice_count;
        ssao->step_count = e.step_count;
        ssao->bias = p.bias;
        ssao->thickness = p.thickness;
    }
    if (blur) {
        blur->radius = e.blur_radius;
        blur->normal_power = e.blur_normal_power;
        blur->sharpness = p.sharpness;
    }
    return result;
}

/* Perspective matrices have view z in w. */
static bool is_orthographic(const struct ao_view *view)
{
    return view->projection[15] != 0.0f;
}

vkao_effect_info ao_effect(vkao_stage_flags stages, const struct ao_view *view,
                           const struct ao_ssao *ssao, const struct ao_blur *blur,
                           const struct ao_composite *composite)
{
    vkao_effect_info e = vkao_effect_info_default();
    e.stages = stages;
    e.depth_encoding = view->depth_encoding;
    e.normal_encoding = view->normal_encoding;
    e.bent_encoding = view->bent_encoding;
    e.projection =
        is_orthographic(view) ? VKAO_PROJECTION_ORTHOGRAPHIC : VKAO_PROJECTION_PERSPECTIVE;
    if (ssao) {
        e.method = ssao->method;
        e.falloff = ssao->falloff;
        e.sphere_form = ssao->sphere_form;
        e.sample_count = ssao->sample_count;
        e.slice_count = ssao->slice_count;
        e.step_count = ssao->step_count;
    }
    if (blur) {
        e.blur_radius = blur->radius;
        e.blur_normal_power = blur->normal_power;
    }
    if (composite) {
        e.composite_mode = composite->mode;
        e.multi_bounce = composite->multi_bounce;
        e.specular = composite->specular;
    }
    return e;
}

vkao_params ao_params(const struct ao_ssao *ssao, const struct ao_blur *blur,
                      const struct ao_composite *composite)
{
    vkao_params p = vkao_params_default();
    if (ssao) {
        p.noise_index = ssao->noise_index;
        p.radius = ssao->radius;
        p.bias = ssao->bias;
        p.thickness = ssao->thickness;
        p.blocking_scale = ssao->blocking_scale;
    }
    if (blur) {
        p.sharpness = blur->sharpness;
        p.intensity = blur->intensity;
        p.power = blur->power;
    }
    if (composite) {
        p.strength = composite->strength;
        memcpy(p.tint, composite->tint, sizeof p.tint);
        p.debug_distance = composite->debug_distance;
    }
    return p;
}

vkao_view ao_library_view(const struct ao_view *view)
{
    vkao_view v = vkao_view_default();
    v.axis = view->axis;
    v.valid = view->valid;
    v.viewport = view->viewport;
    v.rect = view->rect;
    memcpy(v.projection, view->projection, sizeof v.projection);
    memcpy(v.normal_to_view, view->normal_to_view, sizeof v.normal_to_view);
    return v;
}
