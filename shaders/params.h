/* SPDX-License-Identifier: MIT
 *
 * What C and GLSL must agree on: bindings, workgroup size, push constant blocks. Included by both; the C side
 * asserts offsets and sizes (lib/internal.h). Blocks stay within the 128 bytes that every device has. */
#ifndef VKAO_PARAMS_H_
#define VKAO_PARAMS_H_

#ifdef VKAO_GLSL
#define VKAO_VEC4(name) vec4 name
#define VKAO_VEC2(name) vec2 name
#define VKAO_FLOAT(name) float name
#define VKAO_UVEC2(name) uvec2 name
#define VKAO_UINT(name) uint name
#else
#define VKAO_VEC4(name) float name[4]
#define VKAO_VEC2(name) float name[2]
#define VKAO_FLOAT(name) float name
#define VKAO_UVEC2(name) uint32_t name[2]
#define VKAO_UINT(name) uint32_t name
#endif

/* Lanes of lavapipe are 8 texels in a row, so widths are multiples of 8. Groups of SSAO are near squares on GPUs, whose
 * lanes share caches; a CPU runs their lanes one row after the other and is best served by rows of many texels, written
 * in the order of memory. */
#define VKAO_GROUP_WIDTH 16
#define VKAO_GROUP_HEIGHT 8
#define VKAO_ROW_GROUP_WIDTH 64

/* Set 0. A slot that is both written and read has two bindings: storage to write, sampled to read. */
#define VKAO_BINDING_DEPTH 0
#define VKAO_BINDING_NORMALS 1
#define VKAO_BINDING_VIEW_Z 2
#define VKAO_BINDING_NOISY_WRITE 3
#define VKAO_BINDING_NOISY_READ 4
#define VKAO_BINDING_HALFWAY_WRITE 5
#define VKAO_BINDING_HALFWAY_READ 6
#define VKAO_BINDING_AO_WRITE 7
#define VKAO_BINDING_AO_READ 8
#define VKAO_BINDING_COLOR 9
#define VKAO_BINDING_DIRECT 10
#define VKAO_BINDING_OUTPUT 11
#define VKAO_BINDING_BENT_WRITE 12
#define VKAO_BINDING_BENT_READ 13
#define VKAO_BINDING_ALBEDO 14
#define VKAO_BINDING_SPECULAR 15
/* Scratch in buffers, see VKAO_BUFFERS below: the same memory as storage texel buffers, which a CPU reads with vector
 * gathers and not lane by lane, and as storage buffers, to which it writes faster. */
#define VKAO_BINDING_Z 16            /* r32f */
#define VKAO_BINDING_Z4 17           /* rgba32f */
#define VKAO_BINDING_PACKED_WRITE 18  /* r8ui: a code */
#define VKAO_BINDING_PACKED_WRITE2 19 /* r16ui: 2 codes */
#define VKAO_BINDING_PACKED_READ4 20  /* r32ui: 4 codes */
#define VKAO_BINDING_HALFWAY_READ2 21 /* r32ui: 2 fine codes */
#define VKAO_BINDING_BLURRED_READ2 22 /* r32ui: the same */
#define VKAO_BINDING_Z_WORDS 23
#define VKAO_BINDING_HALFWAY_WORDS 24
#define VKAO_BINDING_BLURRED_WORDS 25
#define VKAO_BINDING_STAGED_WORDS 26
#define VKAO_BINDING_PACKED_WORDS 27
#define VKAO_BINDING_TILES 28        /* vkao_tiles_head, tiles */
#define VKAO_BINDING_COUNT 29

/* Specialization constants. Counts that are 0, and flags that are VKAO_FLAGS_UNKNOWN, come from the push constants:
 * that is the general pipeline of a stage. A variant has them all, so that loops unroll and branches go. A radius of 0 is
 * one: blurs of any radius are code of their own. */
#define VKAO_CONSTANT_BLUR_VERTICAL 0
#define VKAO_CONSTANT_BENT_NORMALS 1
#define VKAO_CONSTANT_FLAGS 2
#define VKAO_CONSTANT_SLICES 3
#define VKAO_CONSTANT_STEPS 4
#define VKAO_CONSTANT_SAMPLES 5
#define VKAO_CONSTANT_RADIUS 6
#define VKAO_CONSTANT_COUNT 7
#define VKAO_FLAGS_UNKNOWN 0xffffffffu
/* Samples or steps in a row: loops longer than that take long to compile, and their overhead is small. */
#define VKAO_MOST_UNROLLED 64u
/* Of vbao, whose steps are long: more than the first in all slices leave a CPU's instruction cache, and are looped over
 * instead, slice by slice and at most the second at once. GPUs, whose caches are no larger, get the same. */
#define VKAO_VBAO_MOST_UNROLLED 16u
#define VKAO_VBAO_MOST_AT_ONCE 8u

/* What a recording says in one word: three enums, and yes or no. */
#define VKAO_FLAG_NORMALS_SHIFT 0       /* vkao_normal_encoding, 3 bits */
#define VKAO_FLAG_BENT_SHIFT 3          /* the same of bent normals */
#define VKAO_FLAG_DEPTH_SHIFT 6         /* vkao_depth_encoding, 2 bits */
#define VKAO_FLAG_ORTHOGRAPHIC 0x100u
#define VKAO_FLAG_FAR_IS_ONE 0x200u     /* device depth of the far plane: 1, else 0 */
#define VKAO_FLAG_NORMALS_ALIGNED 0x400u /* normal_to_view only turns axes round */
#define VKAO_FLAG_HALF_RESOLUTION 0x800u /* texel << 1 of the grid is the image's */
#define VKAO_FLAG_THRESHOLD 0x1000u     /* falloff */
#define VKAO_FLAG_SPHERE_LITERAL 0x2000u
#define VKAO_FLAG_BLUR_NORMALS 0x4000u  /* normal_power > 0 */
#define VKAO_FLAG_PHYSICAL 0x8000u      /* intensity 1, power 1 */
#define VKAO_FLAG_PACKED 0x10000u       /* AO goes through buffers, not images */
#define VKAO_FLAG_NORMAL_POWER_8 0x20000u
#define VKAO_FLAG_STAGED_SHIFT 18       /* VKAO_STAGED_*, 3 bits */

/* What the last shader writes: texels of the AO image, or words to be copied into it, in one of these formats. */
#define VKAO_STAGED_NONE 0
#define VKAO_STAGED_UNORM8 1
#define VKAO_STAGED_UNORM16 2
#define VKAO_STAGED_FLOAT16 3
#define VKAO_STAGED_FLOAT32 4

/* View z outside this range is background: what squares of lengths, in radii and at any field of view, would take out of
 * the range of floats. far_z is at most the second. */
#define VKAO_NEAREST_Z 1.0e-15
#define VKAO_FARTHEST_Z 1.0e15
/* Visibility and mean directions are smaller; what is not, or is no number, is not theirs. */
#define VKAO_LARGEST_RESULT 2048.0

/* Texels of zeros around view z, so that taps outside read background without a test. */
#define VKAO_VIEW_Z_BORDER 1

/* Shaders are compiled for scratch in images, and with VKAO_BUFFERS for scratch in buffers. A CPU takes several texels
 * from a buffer at once, where an image gives them one by one; on GPUs images have the better caches. With
 * VKAO_STORAGE_16BIT SSAO stores two codes at once to a storage buffer, which costs a CPU less than a texel buffer.
 *
 * Rows of such a buffer have VKAO_BUFFER_PAD texels of padding on each side, as the blur reads beyond the edge, and
 * begin at multiples of VKAO_BLUR_X_WIDTH. View z is a float per texel and has VKAO_VIEW_Z_BORDER rows above and below.
 * Noisy AO is a byte per texel, coded as (ao + OFFSET) * SCALE: one slice per texel sees between -.55 and 2 of what a
 * whole hemisphere sees, 1 must be exact, and next to its noise the rounding is nothing. AO between the directions of
 * the blur is a 16-bit word per texel, 256 times that code; that buffer is a ring of VKAO_RING_ROWS rows, the blur goes
 * down the image in strips. If AO is staged, a strip of the image's rows has a buffer too; its rows have no padding and
 * begin at multiples of VKAO_UPSAMPLE_WIDTH. SSAO has a list of the tiles that are not all sky. */
#define VKAO_BUFFER_PAD 24
#define VKAO_CODE_SCALE 100.0
#define VKAO_CODE_OFFSET 0.55
#define VKAO_CODE_FINE 256.0
#define VKAO_CODE_OPEN 39680 /* fine code of 1; numbers are relative to it, so that what is open stays exactly 1 */
#define VKAO_RING_ROWS 176
#define VKAO_STRIP_ROWS 128 /* a ring holds a strip and the largest radius on both sides of it */

/* Texels per invocation in the shaders for buffers. */
#define VKAO_PREPARE_WIDTH 4
#define VKAO_TILE_HEIGHT 8    /* least rows of a tile of SSAO; a group is one of its rows */
#define VKAO_MOST_TILES 65535 /* what every device dispatches; in larger frames tiles are higher */
#define VKAO_STRIP_TEXELS 640 /* width of a strip of tiles, a multiple of every group's */
#define VKAO_SSAO_TEXELS 2    /* of the methods that are VKAO_SIDE_BY_SIDE */
#define VKAO_BLUR_X_WIDTH 8
#define VKAO_BLUR_Y_WIDTH 4
#define VKAO_BLUR_Y_HEIGHT 4
#define VKAO_UPSAMPLE_WIDTH 8
#define VKAO_UPSAMPLE_HEIGHT 2

/* Values of the public enums that shaders test; lib/internal.h asserts that they are equal. */
#define VKAO_GLSL_DEPTH_PROJECTED 0
#define VKAO_GLSL_DEPTH_VIEW_Z 1
#define VKAO_GLSL_DEPTH_DISTANCE 2
#define VKAO_GLSL_DEPTH_INVERSE_Z 3
#define VKAO_GLSL_NORMALS_FROM_DEPTH 0
#define VKAO_GLSL_NORMALS_XYZ_SNORM 1
#define VKAO_GLSL_NORMALS_XYZ_UNORM 2
#define VKAO_GLSL_NORMALS_OCT_SNORM 3
#define VKAO_GLSL_NORMALS_OCT_UNORM 4
#define VKAO_GLSL_COMPOSITE_MULTIPLY 0
#define VKAO_GLSL_COMPOSITE_INDIRECT 1
#define VKAO_GLSL_COMPOSITE_AO_ONLY 2
#define VKAO_GLSL_COMPOSITE_NOISY_AO 3
#define VKAO_GLSL_COMPOSITE_NORMALS 4
#define VKAO_GLSL_COMPOSITE_BENT_NORMALS 5
#define VKAO_GLSL_COMPOSITE_VIEW_Z 6
#define VKAO_GLSL_SPECULAR_NONE 0
#define VKAO_GLSL_SPECULAR_FROM_AO 1

/* What vbao guesses of the scene between its samples and behind them, and where it samples; lengths are fractions of
 * the radius, cosines those of the angle to the eye. Found by coordinate search on solid and thin scenes together. */
#define VKAO_VBAO_REACH_SMOOTH 0.80    /* how far the last step goes: the smooth falloff hides what lies beyond */
#define VKAO_VBAO_REACH_THRESHOLD 1.08 /* samples beyond stand for what lies before them */
#define VKAO_STEP_LINEAR 0.50          /* distance of step t is q (LINEAR + (1 - LINEAR) q), q = (t + jitter) / steps */
#define VKAO_THICKNESS_BASE 0.19       /* thickness of what is seen */
#define VKAO_THICKNESS_SLOPE 0.42      /* and what it gains per distance to the side */
#define VKAO_THICKNESS_THRESHOLD 1.1   /* times that with the threshold: what is far away counts alike, and hides more */
#define VKAO_VBAO_JOIN 1.0             /* rise over the tangent plane, per run, up to which two samples join */
#define VKAO_VBAO_GAP_FRONT 0.55       /* share of the gap by which the front of a separate surface moves in */
#define VKAO_VBAO_GAP_BACK 0.7         /* share of the gap by which its back moves out */
#define VKAO_VBAO_ROUND 0.9            /* added before a sector bound is cut to an integer */

/* Cosine to the eye at which tangent planes stop getting steeper in slices: less than that of the last texels that a
 * wall of 80 degrees has before its horizon. */
#define VKAO_STEEPEST 0.002
/* Slope, in view space, at which normals that depth gives stop: their squares are floats at any field of view. */
#define VKAO_STEEPEST_FACET 1.0e9

/* Rectangles are half open and packed two 16-bit texel coordinates to a word, x low: [0] = min, [1] = max.
 * unproject: view xy = texel * unproject.xy + unproject.zw, times view z in perspective. Texel centres are integers
 * here. Inside the shaders view space has +z away from the eye, whatever the caller's hand. */

struct vkao_prepare_block {
    VKAO_VEC4(unproject);
    /* PROJECTED: .x / (.y - depth) in perspective, .x + .y * depth in orthographic views */
    VKAO_VEC2(linearize);
    VKAO_FLOAT(far_z); /* other encodings: view z of the far plane */
    VKAO_UINT(flags);
    VKAO_UVEC2(valid);
    VKAO_UINT(stride); /* texels in a row of buffers */
};

struct vkao_ssao_block {
    VKAO_VEC4(unproject);
    VKAO_UVEC2(valid);
    VKAO_UVEC2(rect);
    /* rows of normal_to_view; .w holds radius, bias (scene units), and blocking_scale (SPHERE) */
    VKAO_VEC4(normal_x);
    VKAO_VEC4(normal_y);
    VKAO_VEC4(normal_z);
    /* uncertainty of a view z: .x + .y * z, times z in perspective */
    VKAO_VEC2(depth_error);
    VKAO_UINT(flags);
    VKAO_UINT(noise_index);
    VKAO_UINT(counts);            /* slices 8 bits, steps and samples 12 each, slices low */
    VKAO_FLOAT(inverse_radius);
    VKAO_FLOAT(bias_cosine);      /* bias / radius */
    VKAO_FLOAT(thickness_base);   /* VBAO, RAYMARCH: radii */
    VKAO_FLOAT(thickness_slope);
    VKAO_UINT(stride);            /* texels in a row of buffers */
    VKAO_VEC2(inverse_unproject); /* 1 / unproject.xy */
};

struct vkao_tiles_block {
    VKAO_UVEC2(rect);
    VKAO_UVEC2(tiles);        /* columns and rows of them */
    VKAO_UINT(flags);
    VKAO_UINT(stride);        /* texels in a row of buffers */
    VKAO_UINT(tile_width);
    VKAO_UINT(strip_columns); /* of tiles */
    VKAO_UINT(tile_height);
};

/* What an indirect dispatch reads; then come the tiles, texels packed as those of rects. */
struct vkao_tiles_head {
    VKAO_UINT(group_rows); /* of a tile */
    VKAO_UINT(count);
    VKAO_UINT(one);
    VKAO_UINT(reserved);
};

struct vkao_blur_block {
    VKAO_VEC4(normal_x); /* rows of normal_to_view, for bent normals */
    VKAO_VEC4(normal_y);
    VKAO_VEC4(normal_z);
    VKAO_UVEC2(valid);
    VKAO_UVEC2(rect);
    VKAO_UINT(radius);
    VKAO_UINT(flags);
    VKAO_FLOAT(sharpness);
    VKAO_FLOAT(normal_power);
    VKAO_FLOAT(intensity);
    VKAO_FLOAT(power);
    VKAO_FLOAT(reference_z); /* what sharpness is relative to in orthographic views; 0 = the texel's own z */
    VKAO_UINT(stride);       /* texels in a row of buffers */
    VKAO_UINT(ring_row);     /* image row in row 0 of the ring, or VKAO_RING_ROWS rows before that */
    VKAO_UINT(staged_stride); /* texels in a row of staged AO; row 0 is the rect's first */
};

/* valid is the half-resolution one, which load_view_z checks. */
struct vkao_upsample_block {
    VKAO_VEC4(normal_x); /* .w = sharpness */
    VKAO_VEC4(normal_y); /* .w = normal_power */
    VKAO_VEC4(normal_z); /* .w = reference_z */
    VKAO_VEC4(unproject);
    VKAO_VEC2(linearize);
    VKAO_UVEC2(valid);
    VKAO_UVEC2(full_valid);
    VKAO_UVEC2(rect);
    VKAO_FLOAT(far_z);
    VKAO_FLOAT(intensity);
    VKAO_FLOAT(power);
    VKAO_UINT(flags);
    VKAO_UINT(stride); /* texels in a row of buffers */
    VKAO_UINT(staged_stride);
};

struct vkao_composite_block {
    VKAO_VEC4(tint); /* .w = strength */
    VKAO_VEC4(normal_x); /* rows of normal_to_view; .w = what VIEW_Z divides by */
    VKAO_VEC4(normal_y);
    VKAO_VEC4(normal_z);
    VKAO_VEC4(unproject);
    VKAO_UVEC2(valid); /* of the grid that the stages ran on */
    VKAO_UVEC2(rect);
    VKAO_UINT(flags);
    VKAO_UINT(mode);
    VKAO_UINT(multi_bounce);
    VKAO_UINT(specular_occlusion);
    VKAO_UINT(stride); /* texels in a row of buffers */
    VKAO_UINT(reserved);
    VKAO_VEC2(inverse_unproject); /* 1 / unproject.xy */
};

#endif
