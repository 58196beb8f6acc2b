/* SPDX-License-Identifier: MIT
 *
 * What the SSAO methods share: the loop over the texels, lengths and weights. */
#ifndef VKAO_TESTS_REF_SSAO_H_
#define VKAO_TESTS_REF_SSAO_H_

#include "ref_view.h"

/* Visibility of texel (x, y), whose view-space position and normal are p and n. */
typedef double ref_visibility(const struct ref_scene *scene, const struct ao_ssao *params, int x,
                              int y, const double p[3], const double n[3]);

/* Every texel of the view's rect, 1 where there is background; the others are left alone. */
void ref_ssao(const struct ref_scene *scene, const struct ao_ssao *params,
              ref_visibility *visibility, double *ao);

/* The same with the mean unoccluded direction: out = that, of any length, and visibility. */
typedef void ref_directed_visibility(const struct ref_scene *scene, const struct ao_ssao *params,
                                     int x, int y, const double p[3], const double n[3],
                                     double out[4]);

/* bent: 3 a texel, 0 where there is background; NULL if it is not wanted. */
void ref_ssao_directed(const struct ref_scene *scene, const struct ao_ssao *params,
                       ref_directed_visibility *visibility, double *ao, double *bent);

/* The basis of Duff et al. 2017: t, b, n are right-handed and orthonormal. */
void ref_basis(const double n[3], double t[3], double b[3]);

/* Length of a kernel point for u uniform in [0,1): P(length > t) = 1 - (t/R)^2 for the smooth
 * falloff, 1 - (t/R)^4 for the threshold. */
double ref_point_length(const struct ao_ssao *params, double u);
/* smoothstep(0, 1, R / |dz|) for an occluder whose view z is dz off. */
double ref_range_weight(const struct ao_ssao *params, double dz);
/* How far the scene must stand in front of a point to block it. */
double ref_guard(const struct ref_scene *scene, const struct ao_ssao *params, double z);

#endif
