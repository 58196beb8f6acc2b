/* SPDX-License-Identifier: MIT
 *
 * Numbers of the texels that an invocation shades side by side: with VKAO_SIDE_BY_SIDE two neighbours of a row, as a CPU's
 * lanes have long chains of dependent operations and nothing else to fill the gaps with; else one. `real` is a number per
 * texel, `reals` one per texel for each of the two sides of a slice, first those of the side along O, then those of the
 * other, or for each of a pair of points. */
#ifndef VKAO_LANES_GLSL_
#define VKAO_LANES_GLSL_

#include "layout.h"

#ifdef VKAO_SIDE_BY_SIDE
#define real vec2
#define reals vec4
#define whole ivec2
#define ints ivec4
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

/* Bytes into a word. */
int pack_codes(whole codes)
{
    return codes.x | codes.y << 8;
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
    return mix(otherwise, v, lessThan(floatBitsToInt(v) & 0x7fffffff, ivec2(floatBitsToInt(VKAO_LARGEST_RESULT))));
}
#else
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

/* The only byte. */
int pack_codes(whole codes)
{
    return codes;
}
#endif

#include "numbers.glsl"

#endif
