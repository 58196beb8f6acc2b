/* SPDX-License-Identifier: MIT
 *
 * AO onto colour. */
#ifndef VKAO_TESTS_REF_COMPOSITE_H_
#define VKAO_TESTS_REF_COMPOSITE_H_

#include "stage_setting.h"

/* One texel: RGBA in, RGBA out. color and direct are read as the mode needs them. */
void ref_composite(const struct ao_composite *params, double ao, const double color[4],
                   const double direct[4], double out[4]);

/* Visibility with the light that bounces on, for one channel (Jimenez et al. 2016). */
double ref_multi_bounce(double ao, double albedo);
/* Share of the specular light that arrives: from AO (Lagarde and de Rousiers 2014), n and v being
 * unit. */
double ref_specular_from_ao(double ao, double roughness, const double n[3], const double v[3]);
/* From the cone around the bent normal, cut with the cone of the lobe (Oat and Sander 2007). */
double ref_specular_from_bent(double ao, double roughness, const double n[3], const double v[3],
                              const double bent[3]);

#endif
