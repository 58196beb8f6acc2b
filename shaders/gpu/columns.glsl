/* SPDX-License-Identifier: MIT
 *
 * Where view z of a texel lies in its image. Neighbours in a row march into different directions,
 * and every fourth texel into like ones (see tile_noise): texels that caches should hold together
 * are four apart. So the image has four blocks of columns side by side: block k has the columns
 * whose number is k modulo 4, and one of the border before and behind them. Rows are as they are,
 * between one of the border above and one below. */
#ifndef VKAO_COLUMNS_GLSL_
#define VKAO_COLUMNS_GLSL_

const uint BLOCKS = VKAO_VIEW_Z_BLOCKS;

/* Of a texel of the image or its border. */
ivec2 view_z_place(ivec2 texel)
{
    uint x = uint(texel.x + VKAO_VIEW_Z_BLOCKS);
    return ivec2(x / BLOCKS + x % BLOCKS * params.view_z_columns, texel.y + VKAO_VIEW_Z_BORDER);
}

#endif
