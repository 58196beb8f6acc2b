/* SPDX-License-Identifier: MIT
 *
 * Numbers that no renderer should write and some do, and settings nobody would choose. The same on
 * every run. */
#ifndef VKAO_TESTS_HOSTILE_H_
#define VKAO_TESTS_HOSTILE_H_

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A sequence of its own for each seed. */
struct chance {
    uint64_t state;
};
struct chance chance_of(uint64_t seed);
uint32_t chance_below(struct chance *chance, uint32_t limit);
bool chance_yes(struct chance *chance, double share);
/* Uniform in [low, high), and the same of logarithms. */
double chance_between(struct chance *chance, double low, double high);
double chance_magnitude(struct chance *chance, double low, double high);

/* How hostile values lie among others. */
enum hostile_pattern {
    HOSTILE_CHECKERS, /* every second texel has one and the same */
    HOSTILE_BLOCKS,   /* blocks of 8 by 8 with one and the same, others by texel with another */
    HOSTILE_MIXED,    /* half of the texels, each with its own */
    HOSTILE_LONE,     /* all but a few lone texels, some of them at the edges */
    HOSTILE_ALL,      /* everywhere, each texel its own */
    HOSTILE_PATTERNS
};
/* Into an image of as many channels; each of them gets its own. */
void hostile_spread(struct chance *chance, enum hostile_pattern pattern, double *values,
                    uint32_t width, uint32_t height, uint32_t channels);

#endif
