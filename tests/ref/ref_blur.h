/* SPDX-License-Identifier: MIT
 *
 * The cross-bilateral blur, with intensity and power. */
#ifndef VKAO_TESTS_REF_BLUR_H_
#define VKAO_TESTS_REF_BLUR_H_

#include "ref_view.h"

/* stored: components of the normals image, 4 a texel, or NULL; encoding says how. bias: scene
 * units. Writes the view's rect of ao. */
void ref_blur(const struct ref_scene *scene, const struct ao_blur *params,
              vkao_normal_encoding encoding, const double *stored, const double *noisy, double bias,
              double *ao);
/* One channel of a half-resolution scene, as it is passed on: before intensity and power. It is
 * visibility, or a coordinate of mean directions, of which none is taken from other surfaces. */
void ref_blur_channel(const struct ref_scene *scene, const struct ao_blur *params,
                      vkao_normal_encoding encoding, const double *stored, const double *noisy,
                      double bias, bool is_visibility, double *out);
/* Intensity, then power. */
double ref_blur_finish(const struct ao_blur *params, double visibility);

#endif
