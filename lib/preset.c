/* SPDX-License-Identifier: MIT
 *
 * Presets: one setting for every scene, chosen on solid and thin ones together. */
#include "vkao.h"

struct preset {
    VkBool32 half_resolution;
    uint32_t slice_count, step_count, blur_radius;
    /* Normals keep the blur off edges that depth does not show, thin slats in front of a wall; on a CPU they cost as much
     * as the rest of the blur. */
    float normal_power;
    /* Few steps miss some of the scene, for which thickness makes up a little; more steps need less of it. */
    float thickness;
};

static const struct preset presets[] = {
    [VKAO_QUALITY_FAST] = {VK_TRUE, 1, 8, 3, 0.0f, 1.0f},
    [VKAO_QUALITY_DEFAULT] = {VK_FALSE, 1, 8, 3, 0.0f, 1.0f},
    [VKAO_QUALITY_HIGH] = {VK_FALSE, 1, 14, 3, 8.0f, 0.9f},
    [VKAO_QUALITY_BEST] = {VK_FALSE, 4, 24, 1, 8.0f, 0.88f},
};

vkao_result vkao_preset(vkao_quality quality, vkao_frame_info *frame, vkao_ssao_params *ssao,
                        vkao_blur_params *blur)
{
    if ((uint32_t)quality >= sizeof presets / sizeof presets[0])
        return VKAO_ERROR_INVALID_ARGUMENT;
    const struct preset *p = &presets[quality];
    if (frame)
        frame->half_resolution = p->half_resolution;
    if (ssao) {
        const vkao_ssao_params standard = vkao_ssao_params_default();
        ssao->method = VKAO_SSAO_VBAO;
        ssao->slice_count = p->slice_count;
        ssao->step_count = p->step_count;
        ssao->bias = standard.bias;
        ssao->thickness = p->thickness;
    }
    if (blur) {
        const vkao_blur_params standard = vkao_blur_params_default();
        blur->radius = p->blur_radius;
        blur->sharpness = standard.sharpness;
        blur->normal_power = p->normal_power;
    }
    return VKAO_SUCCESS;
}
