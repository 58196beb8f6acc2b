/* SPDX-License-Identifier: MIT
 *
 * Sphere SSAO in both forms. */
#ifndef VKAO_TESTS_REF_SPHERE_H_
#define VKAO_TESTS_REF_SPHERE_H_

#include "ref_view.h"

/* Visibility of every texel of the view's rect; the others are left alone. */
void ref_sphere(const struct ref_scene *scene, const struct ao_ssao *params, double *ao);

#endif
