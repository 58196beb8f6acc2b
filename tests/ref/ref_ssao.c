/* SPDX-License-Identifier: MIT */
#include "ref_ssao.h"

#include <math.h>

void ref_ssao(const struct ref_scene *scene, const struct ao_ssao *params,
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

void ref_ssao_directed(const struct ref_scene *scene, const struct ao_ssao *params,
                       ref_directed_visibility *visibility, double *ao, double *bent)
{
    const VkRect2D *rect = &scene->view.rect;
    for (int y = rect->offset.y; y < rect->offset.y + (int)rect->extent.height; ++y) {
        for (int x = rect->offset.x; x < rect->offset.x + (int)rect->extent.width; ++x) {
            size_t i = (size_t)y * scene->width + (size_t)x;
            double p[3], out[4] = {0.0, 0.0, 0.0, 1.0}, z = ref_scene_z(scene, x, y);
            if (!isnan(z)) {
                ref_view_position(&scene->view, x, y, z, p);
                visibility(scene, params, x, y, p, &scene->normals[i * 3], out);
            }
            ao[i] = out[3];
            for (size_t c = 0; bent && c < 3; ++c)
                bent[i * 3 + c] = out[c];
        }
    }
}

/* The basis of Duff et al. 2017, here by Rodrigues' formula: (0, 0, s), the nearer of +z and -z, is
 * rotated onto n by the shortest way, and the x and y axes with it; b is turned so that t, b, n are
 * right-handed. */
void ref_basis(const double n[3], double t[3], double b[3])
{
    double s = n[2] >= 0.0 ? 1.0 : -1.0;
    /* (0, 0, s) x n is the axis times the sine */
    double axis[3] = {-s * n[1], s * n[0], 0.0}, cosine = s * n[2], k = 1.0 / (1.0 + cosine);
    const double cross_x[3] = {0.0, axis[2], -axis[1]}, cross_y[3] = {-axis[2], 0.0, axis[0]};
    for (int i = 0; i < 3; ++i) {
        t[i] = (i == 0 ? cosine : 0.0) + cross_x[i] + k * axis[i] * axis[0];
        b[i] = s * ((i == 1 ? cosine : 0.0) + cross_y[i] + k * axis[i] * axis[1]);
    }
}

double ref_point_length(const struct ao_ssao *params, double u)
{
    return (double)params->radius *
           pow(u, params->falloff == VKAO_FALLOFF_SMOOTH ? 1.0 / 2.0 : 1.0 / 4.0);
}

double ref_range_weight(const struct ao_ssao *params, double dz)
{
    double x = (double)params->radius / fabs(dz);
    return x >= 1.0 ? 1.0 : x * x * (3.0 - 2.0 * x);
}

double ref_guard(const struct ref_scene *scene, const struct ao_ssao *params, double z)
{
    return (double)params->bias * (double)params->radius + ref_view_depth_error(&scene->view, z);
}
