/* SPDX-License-Identifier: MIT
 *
 * What every SSAO method promises, given its reference. */
#ifndef VKAO_TESTS_SSAO_CHECKS_H_
#define VKAO_TESTS_SSAO_CHECKS_H_

#include "fixture.h"

typedef void ssao_reference(const struct ref_scene *scene, const struct ao_ssao *params,
                            double *ao);

/* Runs the picture and compares it with the reference, by the tolerance of the method. */
void check_ssao(struct picture *p, ssao_reference *reference, const char *what);
/* Every format and encoding that normals come in, and from depth. */
void check_every_normal_encoding(const struct ao_ssao *params, ssao_reference *reference);
/* Normals of a turned world and the rotation back. */
void check_world_space_normals(const struct ao_ssao *params, ssao_reference *reference);
/* Orthographic and perspective, either hand, y up, off-centre, with normals and from depth; beside
 * the sky. */
void check_every_projection(const struct ao_ssao *params, ssao_reference *reference);
/* Zero, short, infinite and NaN normals are replaced by those from depth, and those that face away
 * are turned round or replaced, in perspective and orthographic views. */
void check_bad_normals_are_replaced(const struct ao_ssao *params, ssao_reference *reference);
/* The same scene in a smaller image, a row, a column and one texel, with reaches far beyond the
 * screen: numbers. */
void check_no_nan_at_the_limits(const struct ao_ssao *params);

#endif
