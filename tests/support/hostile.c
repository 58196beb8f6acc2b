/* SPDX-License-Identifier: MIT */
#include "hostile.h"

#include <float.h>
#include <math.h>

struct chance chance_of(uint64_t seed)
{
    struct chance chance = {seed};
    chance_below(&chance, 1); /* neighbouring seeds have parted after this */
    return chance;
}

/* A Weyl sequence whose steps are mixed twice by a multiplication and a shift. */
uint32_t chance_below(struct chance *chance, uint32_t limit)
{
    chance->state += UINT64_C(0x9e3779b97f4a7c15);
    uint64_t v = chance->state;
    v = (v ^ v >> 32) * UINT64_C(0xd6e8feb86659fd93);
    v = (v ^ v >> 32) * UINT64_C(0xd6e8feb86659fd93);
    return (uint32_t)(((v >> 32) * limit) >> 32);
}

bool chance_yes(struct chance *chance, double share)
{
    return chance_between(chance, 0.0, 1.0) < share;
}

double chance_between(struct chance *chance, double low, double high)
{
    return low + (high - low) * chance_below(chance, 1u << 24) * 0x1p-24;
}

double chance_magnitude(struct chance *chance, double low, double high)
{
    return exp(chance_between(chance, log(low), log(high)));
}

/* Zero, infinities, NaN, a negative number, the smallest and the largest floats, and some that
 * squares or cubes push out of the range of floats. */
enum { HOSTILE_VALUES = 18 };

static double hostile_value(uint32_t i)
{
    static const double values[HOSTILE_VALUES] = {
        /* the least denormal */
        0.0,
        (double)INFINITY,
        (double)-INFINITY,
        (double)NAN,
        -1.0,
        0x1p-149,
        1e-38,
        (double)FLT_MAX,
        (double)-FLT_MAX,
        -0.0,
        1e-30,
        1e-20,
        1e-12,
        1e12,
        1e15,
        1e20,
        1e29,
        1e30,
    };
    return values[i % HOSTILE_VALUES];
}

static bool is_hostile(struct chance *chance, enum hostile_pattern pattern, uint32_t x, uint32_t y)
{
    switch (pattern) {
    case HOSTILE_CHECKERS:
        return (x ^ y) & 1u;
    case HOSTILE_BLOCKS:
        return ((x >> 3 ^ y >> 3) & 1u) || chance_yes(chance, 0.05);
    case HOSTILE_MIXED:
        return chance_yes(chance, 0.5);
    case HOSTILE_LONE:
        return !chance_yes(chance, 0.08);
    default:
        return true;
    }
}

void hostile_spread(struct chance *chance, enum hostile_pattern pattern, double *values,
                    uint32_t width, uint32_t height, uint32_t channels)
{
    const double same = hostile_value(chance_below(chance, HOSTILE_VALUES));
    for (uint32_t i = 0; i < width * height; ++i) {
        const uint32_t x = i % width, y = i / width;
        if (!is_hostile(chance, pattern, x, y))
            continue;
        const bool checked = pattern == HOSTILE_CHECKERS || pattern == HOSTILE_LONE ||
                             (pattern == HOSTILE_BLOCKS && ((x >> 3 ^ y >> 3) & 1u));
        for (uint32_t c = 0; c < channels; ++c)
            values[i * channels + c] =
                checked ? same : hostile_value(chance_below(chance, HOSTILE_VALUES));
    }
}
