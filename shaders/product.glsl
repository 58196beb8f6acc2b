/* SPDX-License-Identifier: MIT
 *
 * The product of numbers that is a factor in many sums. A driver must not take both of them into
 * every one of these, only to save this one multiplication: what is steady is not taken apart. */
#ifndef VKAO_PRODUCT_GLSL_
#define VKAO_PRODUCT_GLSL_

#include "real.glsl"

#ifndef steady
#define steady precise
#endif

reals product(reals a, reals b)
{
    steady reals p = a * b;
    return p;
}

#endif
