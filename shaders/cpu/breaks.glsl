/* SPDX-License-Identifier: MIT
 *
 * Words of breaks, into a buffer. */
#include "layout.h"

layout(binding = VKAO_BINDING_BREAKS_WORDS) writeonly buffer Breaks { uint breaks[]; };

void store_breaks(ivec2 word, uint bits)
{
    breaks[word.y * (VERTICAL ? VKAO_STRIDE : VKAO_BREAKS_STRIDE) + word.x] = bits;
}
