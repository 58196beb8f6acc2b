/* SPDX-License-Identifier: MIT
 *
 * Settings of a recording together, as a variant is compiled for them. */
#ifndef SETTINGS_H_
#define SETTINGS_H_

#include "world.h"

/* The variant points at the other members: do not copy. */
struct settings {
    vkao_variant variant;
    vkao_view view;
    vkao_ssao_params ssao;
    vkao_blur_params blur;
};

/* The world's, at full resolution and without bent normals. */
void settings_of(const struct world *w, struct settings *s);
/* world_init with GTAO of 3 slices and 6 steps, and no ao_noisy; s is settings_of it. */
void settings_init(struct world *w, struct settings *s, bool cpu);
/* A context with these variants. */
void settings_open(struct world *w, const vkao_variant *variants, uint32_t count, bool only);

#endif
