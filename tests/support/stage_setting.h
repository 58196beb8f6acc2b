/* SPDX-License-Identifier: MIT
 *
 * What the references and the GPU tests set, by stage; and what the library is given for it: an
 * effect to compile, and params to record with. */
#ifndef VKAO_TESTS_STAGE_SETTING_H_
#define VKAO_TESTS_STAGE_SETTING_H_

#include "setting.h"

/* Members as in vkao_effect_info and vkao_params. */
struct ao_ssao {
    vkao_ssao_method method;
    vkao_falloff falloff;
    vkao_sphere_form sphere_form;
    uint32_t sample_count, slice_count, step_count, noise_index;
    float radius, bias, thickness, blocking_scale;
};

struct ao_blur {
    uint32_t radius;
    float normal_power, sharpness, intensity, power;
};

struct ao_composite {
    vkao_composite_mode mode;
    VkBool32 multi_bounce;
    vkao_specular specular;
    float strength, tint[3], debug_distance;
};

struct ao_ssao ao_ssao_default(void);
struct ao_blur ao_blur_default(void);
struct ao_composite ao_composite_default(void);

/* What is compiled. blur and composite may be NULL where no stage needs them. The rest of the
 * effect is the caller's: half_resolution, ao_format, bent_normals and so on. */
vkao_effect_info ao_effect(vkao_stage_flags stages, const struct ao_view *view,
                           const struct ao_ssao *ssao, const struct ao_blur *blur,
                           const struct ao_composite *composite);
/* What is recorded. Each pointer may be NULL. */
vkao_params ao_params(const struct ao_ssao *ssao, const struct ao_blur *blur,
                      const struct ao_composite *composite);

#endif
