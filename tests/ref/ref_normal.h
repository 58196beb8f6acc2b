/* SPDX-License-Identifier: MIT
 *
 * Normals: decoded from an image, or reconstructed from depth. */
#ifndef VKAO_TESTS_REF_NORMAL_H_
#define VKAO_TESTS_REF_NORMAL_H_

#include "ref_view.h"

double ref_dot(const double a[3], const double b[3]);

/* Unit normal of stored components, in the space they are stored in; false if there is none to
 * trust. */
bool ref_normal_decode(vkao_normal_encoding encoding, const double stored[4], double out[3]);
/* The unit normal that components stand for, the other way round. */
void ref_normal_encode(vkao_normal_encoding encoding, const double normal[3], double stored[4]);
/* Unit view-space normal of a texel that faces the eye, and that of the depth image; stored may be
 * NULL. */
void ref_scene_normal(const struct ref_scene *scene, const struct ao_view *view, int x, int y,
                      const double *stored, double out[3], double facet[3]);

#endif
