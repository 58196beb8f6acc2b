/* SPDX-License-Identifier: MIT
 *
 * Where texels lie in the scratch buffers that layout.h describes. */
#ifndef VKAO_BUFFERS_GLSL_
#define VKAO_BUFFERS_GLSL_

/* Of a row's first texel; z_row of view z, which has a border. */
int buffer_row(int y)
{
    return y * VKAO_STRIDE + VKAO_BUFFER_PAD;
}

int z_row(int y)
{
    return buffer_row(y + VKAO_VIEW_Z_BORDER);
}

/* Where rounding down to n is meant: x may be negative, n is a power of two. */
int round_down(int x, int n)
{
    return x & ~(n - 1);
}

#endif
