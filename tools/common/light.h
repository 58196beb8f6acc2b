/* SPDX-License-Identifier: MIT
 *
 * After the composite: light that AO does not darken comes back, and what is held out becomes as it
 * was. gbuffer_load has split the colour: color is what AO darkens, specular what a factor of its
 * own does, kept the rest of it. */
#ifndef VKAO_TOOLS_LIGHT_H_
#define VKAO_TOOLS_LIGHT_H_

#include "ao.h"
#include "gbuffer.h"

void light_finish(const struct gbuffer *gbuffer, struct ao_result *result);

#endif
