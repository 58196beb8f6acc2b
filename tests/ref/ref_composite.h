/* SPDX-License-Identifier: MIT
 *
 * AO onto colour. */
#ifndef VKAO_TESTS_REF_COMPOSITE_H_
#define VKAO_TESTS_REF_COMPOSITE_H_

#include "vkao.h"

/* One texel: RGBA in, RGBA out. color and direct are read as the mode needs them. */
void ref_composite(const vkao_composite_params *params, double ao, const double color[4],
                   const double direct[4], double out[4]);

#endif
