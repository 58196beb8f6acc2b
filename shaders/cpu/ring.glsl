/* SPDX-License-Identifier: MIT
 *
 * The ring of rows between the two directions of the blur, which goes down the image in strips. */
#ifndef VKAO_RING_GLSL_
#define VKAO_RING_GLSL_

/* Row of the ring that holds the image's row y. */
int ring_row(int y)
{
    int row = y - int(here.ring_row);
    return row >= VKAO_RING_ROWS ? row - VKAO_RING_ROWS : row;
}

#endif
