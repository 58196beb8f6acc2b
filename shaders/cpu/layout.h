/* SPDX-License-Identifier: MIT
 *
 * What C and GLSL of the CPU's passes must agree on. A CPU takes several texels from a buffer at
 * once, where an image gives them one by one, and stores words faster than texels.
 *
 * Rows of a buffer have VKAO_BUFFER_PAD texels of padding on each side, as the blur reads beyond
 * the edge, and begin at multiples of VKAO_BLUR_X_WIDTH. View z is a float per texel and has
 * VKAO_VIEW_Z_BORDER rows above and below.
 *
 * Noisy AO is a byte per texel, its code: (ao + OFFSET) * SCALE. One slice per texel sees between
 * -.55 and 2 of what a whole hemisphere sees, 1 must be exact, and next to its noise the rounding
 * is nothing. AO between the directions of the blur is a 16-bit word per texel, 256 times that
 * code. That buffer is a ring of VKAO_RING_ROWS rows: the blur goes down the image in strips. If it
 * looks at normals, those of the same rows lie in a ring of their own, a word per texel.
 *
 * AO that is copied into its image has a buffer for one strip of the image's rows. They have no
 * padding and begin at multiples of VKAO_UPSAMPLE_WIDTH. SSAO has a list of the tiles that are not
 * all sky. */
#ifndef VKAO_CPU_LAYOUT_H_
#define VKAO_CPU_LAYOUT_H_

#include "params.h"

/* A CPU runs the lanes of a group one row after the other. It is served best by rows of many
 * texels, read and written in the order of memory: of 256. In SSAO it is so many invocations, 160
 * texels of most methods: that divides 1920 and half of it, and what lies beyond the image costs as
 * much as what lies inside. */
#define VKAO_GROUP_OF(texels) (256 / (texels))
#define VKAO_ROW_GROUP_WIDTH 80

/* The same memory as storage texel buffers, which a CPU reads with vector gathers and not lane by
 * lane, and as storage buffers, to which it writes faster. */
#define VKAO_BINDING_Z 32  /* r32f */
#define VKAO_BINDING_Z4 33 /* rgba32f */
#define VKAO_BINDING_Z_WORDS 34
#define VKAO_BINDING_PACKED_WRITE 35 /* r8ui: a code. r16ui: 2 codes */
#define VKAO_BINDING_PACKED_READ4 36 /* r32ui: 4 codes */
#define VKAO_BINDING_PACKED_WORDS 37
#define VKAO_BINDING_HALFWAY_READ2 38 /* r32ui: 2 fine codes */
#define VKAO_BINDING_HALFWAY_WORDS 39
#define VKAO_BINDING_RING_NORMALS_READ4 47 /* rgba32ui: 4 normals */
#define VKAO_BINDING_RING_NORMALS_WORDS 48
#define VKAO_BINDING_BLURRED_READ2 40 /* r32ui: the same */
#define VKAO_BINDING_BLURRED_WORDS 41
#define VKAO_BINDING_STAGED_WORDS 42
#define VKAO_BINDING_TILES 43 /* vkao_tiles_head, tiles */
#define VKAO_BINDING_BREAKS_WORDS 44
#define VKAO_BINDING_BREAKS_X_READ 45  /* r32ui: farther and nearer in turn */
#define VKAO_BINDING_BREAKS_Y_READ4 46 /* rgba32ui: of 4 columns, likewise */

/* VKAO_SETTING_PATH: noisy AO goes through the buffer, else through an image; and the format of
 * what is copied. */
#define VKAO_PATH_PACKED 8u
#define VKAO_PATH_FORMAT 7u
#define VKAO_STAGED_UNORM8 1
#define VKAO_STAGED_UNORM16 2
#define VKAO_STAGED_FLOAT16 3
#define VKAO_STAGED_FLOAT32 4

#define VKAO_BUFFER_PAD 24
#define VKAO_CODE_FINE 256.0
/* Fine code of 1; numbers are relative to it, so that what is open stays exactly 1. */
#define VKAO_CODE_OPEN 39680
#define VKAO_RING_ROWS 112
#define VKAO_STRIP_ROWS 64 /* a ring holds a strip and the largest radius on both sides of it */

/* Texels per invocation. */
#define VKAO_PREPARE_WIDTH 4
#define VKAO_PREPARE_HEIGHT 2
#define VKAO_WIDTH_HEIGHT 32  /* a part of the 32 whose breaks of a column are a word */
#define VKAO_TILE_HEIGHT 8    /* least rows of a tile of SSAO; a group is one of its rows */
#define VKAO_MOST_TILES 65535 /* what every device dispatches; in larger frames tiles are higher */
#define VKAO_STRIP_TEXELS 640 /* width of a strip of tiles, a multiple of every group's */
#define VKAO_SSAO_TEXELS 2    /* of the methods that shade side by side */
/* Each texel more of an invocation is unrolled, and drivers take longer to compile it. */
#define VKAO_BLUR_X_WIDTH 8
#define VKAO_BLUR_Y_WIDTH 4
#define VKAO_BLUR_Y_HEIGHT 4
#define VKAO_UPSAMPLE_WIDTH 8
#define VKAO_UPSAMPLE_HEIGHT 2

/* vkao_constants.path: texels in a row of buffers, and in a row of what is copied. */
#define VKAO_BREAKS_STRIDE_OF(stride)                                                              \
    ((stride) / 32 + 1) /* pairs of words in a row: what is farther, what is nearer */
#ifdef VKAO_GLSL
#define VKAO_STRIDE int(params.path.x)
#define VKAO_BREAKS_STRIDE VKAO_BREAKS_STRIDE_OF(VKAO_STRIDE)
#define VKAO_STAGED_STRIDE int(params.path.y)
#endif

/* Push constants. */
struct vkao_strip {
    VKAO_UVEC2(rect);
    VKAO_UINT(ring_row); /* image row in row 0 of the ring, or VKAO_RING_ROWS rows before that */
};

struct vkao_tiling {
    VKAO_UVEC2(rect);
    VKAO_UVEC2(tiles); /* columns and rows of them */
    VKAO_UINT(tile_width);
    VKAO_UINT(tile_height);
    VKAO_UINT(strip_columns); /* of tiles */
};

/* What an indirect dispatch reads; then come the tiles, texels packed as those of rects. */
struct vkao_tiles_head {
    VKAO_UINT(group_rows); /* of a tile */
    VKAO_UINT(count);
    VKAO_UINT(one);
    VKAO_UINT(unused);
};

#endif
