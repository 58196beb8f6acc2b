/* SPDX-License-Identifier: MIT */
#include "stage_setting.h"

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

vkao_effect_info ao_effect(vkao_stage_flags stages, const struct ao_view *view,
                           const struct ao_ssao *ssao, const struct ao_blur *blur,
                           const struct ao_composite *composite)
{
    vkao_effect_info e = vkao_effect_info_default();
    e.stages = stages;
    ao_view_describe(view, &e);
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
