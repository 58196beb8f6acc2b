/* SPDX-License-Identifier: MIT */
#include "ref_noise.h"

#include <math.h>

uint32_t ref_fixed_point(double c)
{
    return (uint32_t)(uint64_t)floor(c * 4294967296.0 + 0.5);
}

static uint32_t ref_golden_phase(uint32_t i)
{
    return i * ref_fixed_point((sqrt(5.0) - 1.0) / 2.0);
}

double ref_unit(uint32_t phase)
{
    return (double)(phase >> 8) / 16777216.0;
}

double ref_fract(double v)
{
    return v - floor(v);
}

double ref_golden(uint32_t i)
{
    return ref_unit(ref_golden_phase(i));
}

/* Of a tile, [y][x]: first digits of turns in base 4, a Latin square, and moves in sixteenths,
 * whose first digits are another such that no pair of digits stands there twice. */
static const uint32_t turns[4][4] = {{0, 2, 3, 1}, {1, 3, 2, 0}, {2, 0, 1, 3}, {3, 1, 0, 2}};
static const uint32_t moves[4][4] = {{15, 1, 8, 6}, {10, 4, 13, 3}, {5, 11, 2, 12}, {0, 14, 7, 9}};
/* In quarters, of four slices, whose directions repeat after two texels. */
static const uint32_t small_turns[2][2] = {{0, 2}, {1, 3}};
static const uint32_t small_moves[2][2] = {{3, 0}, {2, 1}};

/* Turns climb by 1/g from row to row, g^3 = g + 1. Frames take steps of 1/g and 1/g^2. */
struct ref_noise ref_noise(int x, int y, uint32_t slices, uint32_t index)
{
    const double g = 1.32471795724474602596;
    double turn, move;
    if (slices < 4) {
        turn = (turns[y & 3][x & 3] + (uint32_t)y * ref_fixed_point(1.0 / g) / 4294967296.0) / 4.0;
        move = (moves[y & 3][x & 3] + 0.5) / 16.0;
    } else {
        turn = (small_turns[y & 1][x & 1] + 0.125) / 4.0;
        move = (small_moves[y & 1][x & 1] + 0.5) / 4.0;
    }
    return (struct ref_noise){
        ref_unit((uint32_t)floor(turn * 4294967296.0) + index * ref_fixed_point(1.0 / g)),
        ref_unit((uint32_t)floor(move * 4294967296.0) + index * ref_fixed_point(1.0 / (g * g))),
    };
}
