/* SPDX-License-Identifier: MIT
 *
 * Parameters that what is in a G-buffer decides, where nobody else does. */
#ifndef VKAO_TOOLS_AUTOMATIC_H_
#define VKAO_TOOLS_AUTOMATIC_H_

#include "gbuffer.h"

/* 5 % of the median distance, to two digits; 1 without any foreground. */
float automatic_radius(const struct gbuffer *gbuffer);
/* bias, or what keeps steps of half depth from occluding one another if that is more. */
float automatic_bias(const struct gbuffer *gbuffer, float radius, float bias);

#endif
