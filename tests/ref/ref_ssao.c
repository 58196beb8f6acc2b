/* SPDX-License-Identifier: MIT */
#include "ref_ssao.h"

#include <math.h>

void ref_ssao(const struct ref_scene *scene, const vkao_ssao_params *params,
              ref_visibility *visibility, double *ao)
{
    const VkRect2D *rect = &scene->view.rect;
    for (int y = rect->offset.y; y < rect->offset.y + (int)rect->extent.height; ++y) {
        for (int x = rect->offset.x; x < rect->offset.x + (int)rect->extent.width; ++x) {
            size_t i = (size_t)y * scene->width + (size_t)x;
            double p[3], z = ref_scene_z(scene, x, y);
            ao[i] = 1.0;
            if (isnan(z))
                continue;
            ref_view_position(&scene->view, x, y, z, p);
            ao[i] = visibility(scene, params, x, y, p, &scene->normals[i * 3]);
        }
    }
}

double ref_point_length(const vkao_ssao_params *params, double u)
{
    return (double)params->radius *
           pow(u, params->falloff == VKAO_FALLOFF_SMOOTH ? 1.0 / 2.0 : 1.0 / 4.0);
}

double ref_range_weight(const vkao_ssao_params *params, double dz)
{
    double x = (double)params->radius / fabs(dz);
    return x >= 1.0 ? 1.0 : x * x * (3.0 - 2.0 * x);
}

double ref_guard(const struct ref_scene *scene, const vkao_ssao_params *params, double z)
{
    return (double)params->bias * (double)params->radius + ref_view_depth_error(&scene->view, z);
}
