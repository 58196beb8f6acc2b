/* SPDX-License-Identifier: MIT
 *
 * Hemisphere SSAO. */
#ifndef VKAO_TESTS_REF_HEMISPHERE_H_
#define VKAO_TESTS_REF_HEMISPHERE_H_

#include "ref_view.h"

/* Visibility of every texel of the view's rect; the others are left alone. */
void ref_hemisphere(const struct ref_scene *scene, const struct ao_ssao *params, double *ao);

#endif
