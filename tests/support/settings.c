/* SPDX-License-Identifier: MIT */
#include "settings.h"

void settings_of(const struct world *w, struct settings *s)
{
    *s = (struct settings){.view = w->view, .ssao = w->ssao, .blur = w->blur};
    s->variant = (vkao_variant){
        .struct_size = sizeof s->variant, .view = &s->view, .ssao = &s->ssao, .blur = &s->blur};
}

void settings_init(struct world *w, struct settings *s, bool cpu)
{
    world_init(w, true);
    w->fake.device_type = cpu ? VK_PHYSICAL_DEVICE_TYPE_CPU : VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU;
    w->view.normal_encoding = VKAO_NORMALS_XYZ_SNORM;
    w->ssao.method = VKAO_SSAO_GTAO;
    w->ssao.slice_count = 3;
    w->ssao.step_count = 6;
    w->images.ao_noisy = (vkao_image){0};
    settings_of(w, s);
}

void settings_open(struct world *w, const vkao_variant *variants, uint32_t count, bool only)
{
    w->info.variants = variants;
    w->info.variant_count = count;
    w->info.variants_only = only;
    assert_int_equal(vkao_context_create(&w->info, &w->ctx), VKAO_SUCCESS);
    assert_int_equal(w->log.lines, 0);
}
