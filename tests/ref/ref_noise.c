/* SPDX-License-Identifier: MIT */
#include "ref_noise.h"

#include <math.h>

uint32_t ref_fixed_point(double c)
{
    return (uint32_t)(uint64_t)floor(c * 4294967296.0 + 0.5);
}

/* Jimenez 2014: fract(52.9829189 * fract(0.06711056 x + 0.00583715 y)), where a frame moves the
 * pattern by 5.588238 texels along both axes. */
uint32_t ref_gradient_phase(uint32_t x, uint32_t y, uint32_t index)
{
    const double a = 0.06711056, b = 0.00583715;
    uint32_t frame = ref_fixed_point(ref_fract((a + b) * 5.588238));
    return x * ref_fixed_point(a) + y * ref_fixed_point(b) + index * frame;
}

/* Roberts 2018: steps of 1/g and 1/g^2, g^3 = g + 1; the golden ratio steps through the frames. */
uint32_t ref_r2_phase(uint32_t x, uint32_t y, uint32_t index)
{
    const double g = 1.32471795724474602596;
    return x * ref_fixed_point(1.0 / g) + y * ref_fixed_point(1.0 / (g * g)) +
           ref_golden_phase(index);
}

uint32_t ref_golden_phase(uint32_t i)
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

double ref_gradient_noise(uint32_t x, uint32_t y, uint32_t index)
{
    return ref_fract(52.9829189 * ref_unit(ref_gradient_phase(x, y, index)));
}

double ref_r2_noise(uint32_t x, uint32_t y, uint32_t index)
{
    return ref_unit(ref_r2_phase(x, y, index));
}

double ref_golden(uint32_t i)
{
    return ref_unit(ref_golden_phase(i));
}
