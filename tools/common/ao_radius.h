/* SPDX-License-Identifier: MIT
 *
 * What a file of ray-traced AO says about itself. */
#ifndef VKAO_TOOLS_AO_RADIUS_H_
#define VKAO_TOOLS_AO_RADIUS_H_

#include "exr_file.h"

/* The attribute aoRadius of any part, scene units, a number or as text: renderers and scripts write
 * either. 0 = it has none that is finite and positive. */
float reference_radius(const struct exr_info *info);

#endif
