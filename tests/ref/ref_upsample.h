/* SPDX-License-Identifier: MIT
 *
 * Half resolution: every second texel of every second row, and the way back. */
#ifndef VKAO_TESTS_REF_UPSAMPLE_H_
#define VKAO_TESTS_REF_UPSAMPLE_H_

#include "ref_view.h"

/* The scene as the half-resolution stages see it, and the stored normals of its texels (4 a texel,
 * NULL without any); free both. view.normal_encoding decides whether stored is read. */
void ref_scene_half(const struct ref_scene *full, const struct ao_view *view, const double *stored,
                    struct ref_scene *half, double **half_stored);

/* One channel of the half-resolution image to every texel of the view's rect, before intensity and
 * power; nothing is what background gets, and texels around which there is but background. */
void ref_upsample(const struct ref_scene *full, const struct ref_scene *half,
                  const struct ao_blur *params, vkao_normal_encoding encoding, const double *stored,
                  double nothing, const double *value, double *out);

#endif
