/* SPDX-License-Identifier: MIT
 *
 * Arithmetic on the numbers that lanes.glsl names, whether one texel is shaded or two side by side. */
#ifndef VKAO_NUMBERS_GLSL_
#define VKAO_NUMBERS_GLSL_

const reals SIDES = reals(real(1.0), real(-1.0));

/* The same on both sides. */
reals both(real v)
{
    return reals(v, v);
}

/* max() and min() of numbers: those may have to look for NaN, which takes three instructions instead of one. */
reals greater(reals a, reals b)
{
    return mix(b, a, greaterThan(a, b));
}

reals lesser(reals a, reals b)
{
    return mix(b, a, lessThan(a, b));
}

/* The nearest integer, as a number and with ROUND_BITS as an integer. A number below 2^22 plus ROUND has no room for a
 * fraction: its last bits are that integer. Whatever larger ones become, infinities and NaN too, lies in no image. */
struct Rounded {
    real number;
    whole bits;
};

const float ROUND = 12582912.0;
const int ROUND_BITS = 0x4b400000;

Rounded rounded(real v)
{
    precise real moved = v + ROUND, number = moved - ROUND;
    return Rounded(number, floatBitsToInt(moved));
}

struct RoundedSides {
    reals number;
    ints bits;
};

RoundedSides rounded(reals v)
{
    precise reals moved = v + ROUND, number = moved - ROUND;
    return RoundedSides(number, floatBitsToInt(moved));
}

/* Vectors of the texels. */
struct Real2 {
    real x, y;
};

struct Real3 {
    real x, y, z;
};

Real3 join3(vec3 of_texels[TEXELS])
{
    float x[TEXELS], y[TEXELS], z[TEXELS];
    for (int i = 0; i < TEXELS; ++i) {
        x[i] = of_texels[i].x;
        y[i] = of_texels[i].y;
        z[i] = of_texels[i].z;
    }
    return Real3(join(x), join(y), join(z));
}

vec3 lane3(Real3 v, int i)
{
    return vec3(lane(v.x, i), lane(v.y, i), lane(v.z, i));
}

real dot3(Real3 a, Real3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

Real3 times(Real3 v, real s)
{
    return Real3(v.x * s, v.y * s, v.z * s);
}

Real3 plus(Real3 a, Real3 b)
{
    return Real3(a.x + b.x, a.y + b.y, a.z + b.z);
}

#endif
