/* SPDX-License-Identifier: MIT
 *
 * How wide a surface is in the depth image. */
#ifndef VKAO_TESTS_REF_WIDTH_H_
#define VKAO_TESTS_REF_WIDTH_H_

#include "ref_view.h"

/* The thickness that vbao takes from it, in scene units; where thickness is given, that. */
double ref_width_thickness(const struct ref_scene *scene, double radius, int x, int y);
/* The same of every texel that has depth, for the caller to free. */
double *ref_width_image(const struct ref_scene *scene, double radius);

#endif
