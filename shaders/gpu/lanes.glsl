/* SPDX-License-Identifier: MIT
 *
 * Numbers of the texel that an invocation shades. `real` is a number, `reals` one for each of the two sides of a slice,
 * first that of the side along O, then that of the other, or for each of a pair of points. */
#ifndef VKAO_LANES_GLSL_
#define VKAO_LANES_GLSL_

#define real float
#define reals vec2
#define whole int
#define ints ivec2
#define bools bvec2
#define boolean bool
const int TEXELS = 1;
const real BESIDE = 0.0;

int lane(whole v, int i)
{
    return v;
}

real join(float of_texels[TEXELS])
{
    return of_texels[0];
}

float lane(real v, int i)
{
    return v;
}

real first_side(reals v)
{
    return v.x;
}

real other_side(reals v)
{
    return v.y;
}

real choose(real no, real yes, bool which)
{
    return which ? yes : no;
}

bool above(real a, real b)
{
    return a > b;
}

/* v, or where it is no number or absurdly large, what stands in for it. */
real sane(real v, real otherwise)
{
    return (floatBitsToInt(v) & 0x7fffffff) < floatBitsToInt(VKAO_LARGEST_RESULT) ? v : otherwise;
}

#include "numbers.glsl"

#endif
