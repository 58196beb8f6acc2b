/* SPDX-License-Identifier: MIT
 *
 * Visibility on its way to the blur, as what an image of 8 bits holds: see VKAO_CODE_SCALE. */
#ifndef VKAO_VISIBILITY_CODE_GLSL_
#define VKAO_VISIBILITY_CODE_GLSL_

#include "half.glsl"

float encode_visibility(float v)
{
    /* Halves go up, as on CPUs: many a method's few samples end on one. */
    float code = v * VKAO_CODE_SCALE + (VKAO_CODE_OFFSET * VKAO_CODE_SCALE + 0.5);
    return NOISY_CODES ? floor(clamp(code, 0.0, 255.0)) / 255.0 : noisy_texel(v);
}

/* Less 1, in steps of VISIBILITY_UNIT: exactly 0 where all is open. */
const float VISIBILITY_UNIT = NOISY_CODES ? 1.0 / VKAO_CODE_SCALE : 1.0;

float decode_hidden(float stored)
{
    return NOISY_CODES ? roundEven(stored * 255.0 - VKAO_VISIBILITY_OPEN) : stored - 1.0;
}

float decode_visibility(float stored)
{
    return NOISY_CODES ? decode_hidden(stored) * VISIBILITY_UNIT + 1.0 : stored;
}

#endif
