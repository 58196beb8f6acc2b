/* SPDX-License-Identifier: MIT
 *
 * The methods that came after sphere and hemisphere. bent, 3 a texel, is the mean unoccluded
 * direction in the view space of ref_view.h, of any length; NULL if it is not wanted. */
#ifndef VKAO_TESTS_REF_METHODS_H_
#define VKAO_TESTS_REF_METHODS_H_

#include "ref_view.h"

void ref_hbao(const struct ref_scene *scene, const struct ao_ssao *params, double *ao);
void ref_gtao(const struct ref_scene *scene, const struct ao_ssao *params, double *ao);
void ref_vbao(const struct ref_scene *scene, const struct ao_ssao *params, double *ao);
void ref_raymarch(const struct ref_scene *scene, const struct ao_ssao *params, double *ao);

void ref_gtao_bent(const struct ref_scene *scene, const struct ao_ssao *params, double *ao,
                   double *bent);
void ref_vbao_bent(const struct ref_scene *scene, const struct ao_ssao *params, double *ao,
                   double *bent);
void ref_raymarch_bent(const struct ref_scene *scene, const struct ao_ssao *params, double *ao,
                       double *bent);

/* Of VBAO: in how many of the 31 sectors of one side a bound at angle theta from V, on that side,
 * leaves hidden what lies beyond it; n as seen from that side. less: of rounding. */
int ref_vbao_sector(double n, double theta, double less);
/* The share of a side's measure between the tangent plane and theta. */
double ref_vbao_share(double n, double theta);

#endif
