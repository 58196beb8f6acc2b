/* SPDX-License-Identifier: MIT
 *
 * Numbers of the two texels of a row that an invocation shades side by side, as a CPU's lanes have
 * long chains of dependent operations and nothing else to fill the gaps with. `real` is a number
 * per texel, `reals` one per texel for each of the two sides of a slice, first those of the side
 * along O, then those of the other, or for each of a pair of points. */
#ifndef VKAO_LANES_GLSL_
#define VKAO_LANES_GLSL_

#include "layout.h"

#define real vec2
#define reals vec4
#define whole ivec2
#define ints ivec4
#define steady
#define bools bvec4
#define boolean bvec2
const int TEXELS = VKAO_SSAO_TEXELS;
const real BESIDE = vec2(0.0, 1.0); /* x of the texels, from the first one's */

int lane(whole v, int i)
{
    return v[i];
}

real join(float of_texels[TEXELS])
{
    return vec2(of_texels[0], of_texels[1]);
}

float lane(real v, int i)
{
    return v[i];
}

real first_side(reals v)
{
    return v.xy;
}

real other_side(reals v)
{
    return v.zw;
}

real choose(real no, real yes, bvec2 which)
{
    return mix(no, yes, which);
}

bvec2 above(real a, real b)
{
    return greaterThan(a, b);
}

/* v, or where it is no number or absurdly large, what stands in for it. */
real sane(real v, real otherwise)
{
    return mix(
        otherwise, v,
        lessThan(floatBitsToInt(v) & 0x7fffffff, ivec2(floatBitsToInt(VKAO_LARGEST_RESULT))));
}

const reals SIDES = reals(real(1.0), real(-1.0));

/* The same on both sides. */
reals both(real v)
{
    return reals(v, v);
}

/* max() and min() of numbers: those may have to look for NaN, which takes three instructions
 * instead of one. */
reals greater(reals a, reals b)
{
    return mix(b, a, greaterThan(a, b));
}

reals lesser(reals a, reals b)
{
    return mix(b, a, lessThan(a, b));
}

/* The nearest integer, as a number and with ROUND_BITS as an integer. A number below 2^22 plus
 * ROUND has no room for a fraction: its last bits are that integer. Whatever larger ones become,
 * infinities and NaN too, lies in no image. */
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
