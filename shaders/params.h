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

/* Lanes of lavapipe are 8 texels in a row, so the width is a multiple of 8; 16x8 measured best or even. */
#define VKAO_GROUP_WIDTH 16
#define VKAO_GROUP_HEIGHT 8

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
#define VKAO_BINDING_COUNT 16

/* Specialization constants */
#define VKAO_CONSTANT_BLUR_VERTICAL 0
#define VKAO_CONSTANT_BENT_NORMALS 1

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
#define VKAO_GLSL_FALLOFF_SMOOTH 0
#define VKAO_GLSL_SPHERE_RESCALED 0
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
#define VKAO_VBAO_REACH_THRESHOLD 1.0
#define VKAO_STEP_LINEAR 0.50          /* distance of step t is q (LINEAR + (1 - LINEAR) q), q = (t + jitter) / steps */
#define VKAO_THICKNESS_BASE 0.12       /* thickness of what is seen */
#define VKAO_THICKNESS_SLOPE 0.60      /* and what it gains per distance to the side */
#define VKAO_VBAO_JOIN 1.4             /* rise over the tangent plane, per run, up to which two samples are one surface */
#define VKAO_VBAO_GAP_FRONT 0.55        /* share of the gap by which the front of a separate surface moves in */
#define VKAO_VBAO_GAP_BACK 0.7         /* share of the gap by which its back moves out */
#define VKAO_VBAO_ROUND 0.9            /* added before a sector bound is cut to an integer */

/* Rectangles are half open and packed two 16-bit texel coordinates to a word, x low: [0] = min, [1] = max.
 * unproject: view xy = texel * unproject.xy + unproject.zw, times view z in perspective. Texel centres are integers
 * here. Inside the shaders view space has +z away from the eye, whatever the caller's hand. */

struct vkao_prepare_block {
    VKAO_VEC4(unproject);
    /* PROJECTED: .x / (.y - depth) in perspective, .x + .y * depth in orthographic views */
    VKAO_VEC2(linearize);
    VKAO_FLOAT(far_depth); /* device depth of the far plane: 0 or 1 */
    VKAO_FLOAT(far_z);     /* other encodings: view z of the far plane */
    VKAO_UVEC2(valid);
    VKAO_UINT(depth_encoding);
    VKAO_UINT(orthographic);
    VKAO_UINT(grid_shift); /* 1 = half resolution: texel << 1 is the image's */
};

struct vkao_ssao_block {
    VKAO_VEC4(unproject);
    VKAO_UVEC2(valid);
    VKAO_UVEC2(rect);
    /* rows of normal_to_view; .w holds radius, bias (scene units), and blocking_scale (SPHERE) or thickness */
    VKAO_VEC4(normal_x);
    VKAO_VEC4(normal_y);
    VKAO_VEC4(normal_z);
    /* uncertainty of a view z: .x + .y * z, times z in perspective */
    VKAO_VEC2(depth_error);
    VKAO_UINT(normal_encoding);
    VKAO_UINT(orthographic);
    VKAO_UINT(sample_count);
    VKAO_UINT(noise_index);
    VKAO_UINT(falloff);
    VKAO_UINT(sphere_form);
    VKAO_UINT(slices_and_steps); /* 16 bits each, slices low */
    VKAO_UINT(grid_shift);
};

struct vkao_blur_block {
    VKAO_VEC4(normal_x); /* rows of normal_to_view, for bent normals */
    VKAO_VEC4(normal_y);
    VKAO_VEC4(normal_z);
    VKAO_UVEC2(valid);
    VKAO_UVEC2(rect);
    VKAO_UINT(radius);
    VKAO_FLOAT(sharpness);
    VKAO_FLOAT(normal_power);
    VKAO_UINT(encodings); /* of normals, and << 8 of bent normals */
    VKAO_FLOAT(intensity);
    VKAO_FLOAT(power);
    VKAO_FLOAT(reference_z); /* what sharpness is relative to in orthographic views; 0 = the texel's own z */
    VKAO_UINT(grid_shift);
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
    VKAO_FLOAT(far_depth);
    VKAO_FLOAT(far_z);
    VKAO_FLOAT(intensity);
    VKAO_FLOAT(power);
    VKAO_UINT(encodings); /* of normals, << 8 of bent normals, << 16 of depth */
    VKAO_UINT(orthographic);
};

struct vkao_composite_block {
    VKAO_VEC4(tint); /* .w = strength */
    VKAO_VEC4(normal_x); /* rows of normal_to_view; .w = what VIEW_Z divides by */
    VKAO_VEC4(normal_y);
    VKAO_VEC4(normal_z);
    VKAO_VEC4(unproject);
    VKAO_UVEC2(valid); /* of the grid that the stages ran on */
    VKAO_UVEC2(rect);
    VKAO_UINT(mode);
    VKAO_UINT(multi_bounce);
    VKAO_UINT(specular_occlusion);
    VKAO_UINT(encodings);
    VKAO_UINT(orthographic);
    VKAO_UINT(grid_shift);
};

#endif
