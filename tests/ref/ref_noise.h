/* SPDX-License-Identifier: MIT
 *
 * The noise of shaders/noise.glsl: integers bit for bit, what follows them in double precision. */
#ifndef VKAO_TESTS_REF_NOISE_H_
#define VKAO_TESTS_REF_NOISE_H_

#include <stdint.h>

/* Fixed-point constants as the definition has them: round(c * 2^32). */
uint32_t ref_fixed_point(double c);

/* The upper 24 bits as a fraction. */
double ref_unit(uint32_t phase);
double ref_fract(double v);
double ref_golden(uint32_t i);

/* By how much of their spacing a texel's directions are turned and its samples moved, in [0,1). */
struct ref_noise {
    double turn, jitter;
};
/* slices: of each texel, 1 in methods without. */
struct ref_noise ref_noise(int x, int y, uint32_t slices, uint32_t index);

#endif
