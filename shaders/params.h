/* SPDX-License-Identifier: MIT
 *
 * What C and GLSL must agree on: bindings, workgroup sizes, settings, constants. Included by both.
 * The C side asserts sizes (lib/passes.c). */
#ifndef VKAO_PARAMS_H_
#define VKAO_PARAMS_H_

#ifdef VKAO_GLSL
#define VKAO_VEC4(name) vec4 name
#define VKAO_VEC2(name) vec2 name
#define VKAO_FLOAT(name) float name
#define VKAO_UVEC4(name) uvec4 name
#define VKAO_UVEC2(name) uvec2 name
#define VKAO_UINT(name) uint name
#else
#define VKAO_VEC4(name) float name[4]
#define VKAO_VEC2(name) float name[2]
#define VKAO_FLOAT(name) float name
#define VKAO_UVEC4(name) uint32_t name[4]
#define VKAO_UVEC2(name) uint32_t name[2]
#define VKAO_UINT(name) uint32_t name
#endif

/* A workgroup. Lanes of lavapipe are 8 texels in a row, so widths are multiples of 8. */
#define VKAO_GROUP_WIDTH 16
#define VKAO_GROUP_HEIGHT 8

/* Texels of a group of SSAO on a GPU: VKAO_GROUP_WIDTH columns of each block of view z
 * (gpu/columns.glsl). */
#define VKAO_SSAO_GROUP_WIDTH (VKAO_GROUP_WIDTH * VKAO_VIEW_Z_BLOCKS)
#define VKAO_SSAO_GROUP_HEIGHT (VKAO_GROUP_HEIGHT / VKAO_VIEW_Z_BLOCKS)

/* Set 0. A pass has those that its row names; the CPU's own come after these
 * (shaders/cpu/layout.h). */
#define VKAO_BINDING_CONSTANTS 0
#define VKAO_BINDING_DEPTH 1
#define VKAO_BINDING_NORMALS 2
#define VKAO_BINDING_VIEW_Z 3
#define VKAO_BINDING_VIEW_Z_WRITE 4
#define VKAO_BINDING_SOURCE 5 /* AO of the pass before */
#define VKAO_BINDING_TARGET 6 /* AO for the pass behind */
#define VKAO_BINDING_AO_WRITE 7
#define VKAO_BINDING_BENT_WRITE 8
#define VKAO_BINDING_BENT_READ 9
#define VKAO_BINDING_COLOR 10
#define VKAO_BINDING_DIRECT 11
#define VKAO_BINDING_ALBEDO 12
#define VKAO_BINDING_SPECULAR 13
#define VKAO_BINDING_OUTPUT 14
#define VKAO_BINDING_BREAKS_X 15 /* where depth breaks, in words along rows, and along columns */
#define VKAO_BINDING_BREAKS_Y 16
#define VKAO_BINDING_BREAKS_X_WRITE 17
#define VKAO_BINDING_BREAKS_Y_WRITE 20
#define VKAO_BINDING_SECOND_Z 19
#define VKAO_BINDING_NEAREST 21     /* the sampler of texels by their number */
#define VKAO_BINDING_BENT_SOURCE 22 /* bent normals of the pass before, as codes */
#define VKAO_BINDING_BENT_TARGET 23
#define VKAO_BINDING_CPU 32 /* the first of the CPU's */

/* What a pass is compiled for: specialization constants, the same for all passes of an effect but
 * for the last three. shaders/settings.glsl declares them. */
#define VKAO_SETTING_DEPTH_ENCODING 0
#define VKAO_SETTING_NORMAL_ENCODING 1
#define VKAO_SETTING_BENT_ENCODING 2
#define VKAO_SETTING_ORTHOGRAPHIC 3
#define VKAO_SETTING_GRID_SHIFT 4 /* texel << 1 of the grid is the image's, at half resolution */
#define VKAO_SETTING_BENT_NORMALS 5
#define VKAO_SETTING_THRESHOLD 6
#define VKAO_SETTING_SPHERE_LITERAL 7
/* Counts are 0 if loops are too long to unroll; then constants have them. */
#define VKAO_SETTING_SLICES 8
#define VKAO_SETTING_STEPS 9
#define VKAO_SETTING_SAMPLES 10
#define VKAO_SETTING_BLUR_RADIUS 11
#define VKAO_SETTING_BLUR_NORMAL_POWER 12 /* a float */
#define VKAO_SETTING_COMPOSITE_MODE 13
#define VKAO_SETTING_MULTI_BOUNCE 14
#define VKAO_SETTING_SPECULAR 15
#define VKAO_SETTING_THICKNESS_INPUT 16
#define VKAO_SETTING_SECOND_LAYER 17
#define VKAO_SETTING_NOISY_CODES 18 /* AO before the blur is codes in an image, see below */
#define VKAO_SETTING_TILE_WORDS 19  /* of a texel in shared memory of blur_tile.comp */
#define VKAO_SETTING_HALF_AO 20     /* the AO image has half floats, see half.glsl */
#define VKAO_SETTING_HALF_NOISY 21  /* the same of what SSAO writes */
#define VKAO_SETTING_PATH 22        /* the CPU's own */
#define VKAO_SETTING_VERTICAL 23    /* of the pass: one shader blurs in two directions */
#define VKAO_SETTING_TONED 24       /* of the form: intensity or power is not 1 */
#define VKAO_SETTING_COPIED 25      /* of the form, the CPU's own */
#define VKAO_SETTING_COUNT 26

/* Constants that were fitted, or chosen by hand, say on what, and what they were checked with. The
 * scenes that vbao is fitted to, which are those of its search: the 13 of README's first table. The
 * 17 others: those of its second table, other frames, cameras and sizes of the same. Twelve other
 * scenes, and nine of thin things: apart from these. All are G-buffers with ray-traced truth, which
 * are too large to lie here; tools/bench/fit-vbao searches on any such and checks with others. */

/* Visibility before the blur, which may be below 0 and above 1, as a code of 8 bits: (v + OFFSET) *
 * SCALE, rounded. VISIBILITY_OPEN is that of 1. */
#define VKAO_CODE_SCALE 100.0
#define VKAO_CODE_OFFSET 0.55
#define VKAO_VISIBILITY_OPEN 155.0

/* Where less than LEAK_BELOW of a blur's window counts, all of the window does as well, by up to
 * LEAK. Chosen by hand on the scenes that vbao is fitted to and two sequences: more of LEAK
 * flickers less and costs RMSE. LEAK_BELOW is less than the half that straight edges leave. */
#define VKAO_BLUR_LEAK 0.15
#define VKAO_BLUR_LEAK_BELOW 0.45

/* Where the blur compares no normals, slopes of depth tell surfaces that meet at an edge: a tap
 * counts the less, and at the least LEAST, the more the centre is off the tap's own surface, in
 * terms of the centre's slope, TEXELS of a texel's size and BIASES of what depth may be off by.
 * Less of LEAST keeps more of an edge and leaves more noise beside it: below .2 RMSE grows. Chosen
 * by hand on the scenes that vbao is fitted to: RMSE of eight steps .738 of XeGTAO's before, .729
 * with it. Checked on twelve other scenes: .0627 before, .0617 with it. */
#define VKAO_BLUR_BEND_TEXELS 0.3
#define VKAO_BLUR_BEND_BIASES 3.0
#define VKAO_BLUR_BEND_LEAST 0.33

/* What a side of a blur's window counts more where all of the other side lies on the surface as
 * well; where normals keep the blur off edges too, of things that depth does not tell apart, more
 * pays. Chosen by hand on the scenes that vbao is fitted to: without the first RMSE of one slice is
 * 1 % more, without the second that of two .7 %. Checked, with all that `high` has, on 17 other
 * frames and cameras of them: RMSE .0528 before, .0519 with it. More of the first flickers more,
 * and at twice as much the noise that is left outweighs what is gained; more of the second makes a
 * slab's AO rougher than gpu-radius allows. */
#define VKAO_BLUR_ACROSS 0.35
#define VKAO_BLUR_ACROSS_NORMALS 0.6

/* blur_tile.comp: radii that it is for; texels of a row that a group blurs; rows in its shared
 * memory, by the words that a texel has there, of which it blurs those that are not reached
 * over. */
#define VKAO_BLUR_TILE_RADIUS 3
#define VKAO_BLUR_TILE_THREADS 64
#define VKAO_BLUR_TILE_WIDTH 32
#define VKAO_BLUR_TILE_ROWS(words) ((words) > 3 ? 16 : 24)

/* Threads of a group of breaks.comp, each for 4 x 4 texels. */
#define VKAO_BREAKS_WIDTH 8
#define VKAO_BREAKS_HEIGHT 8

/* Samples or steps in a row: loops longer than that take long to compile, and their overhead is
 * small. */
#define VKAO_MOST_UNROLLED 64u
/* Of vbao on a CPU, whose steps are long: at least 3. More leave an instruction cache. */
#define VKAO_VBAO_MOST_AT_ONCE 4u

/* View z outside this range is background: what squares of lengths, in radii and at any field of
 * view, would take out of the range of floats. far_z is at most the second. */
#define VKAO_NEAREST_Z 1.0e-15
#define VKAO_FARTHEST_Z 1.0e15
/* Visibility and mean directions are smaller; what is not, or is no number, is not theirs. */
#define VKAO_LARGEST_RESULT 2048.0

/* Texels of zeros around view z, so that taps outside read background without a test: around the
 * valid ones on a CPU, around the image on a GPU, where all that is not valid is zero too. */
#define VKAO_VIEW_Z_BORDER 1
/* Of a GPU: the blocks that columns are dealt to (shaders/gpu/columns.glsl), and so the width of
 * the border in texels. As long as a tile of the noise. */
#define VKAO_VIEW_Z_BLOCKS 4

/* Values of the public enums that shaders test; the stages' C files assert that they are equal. */
#define VKAO_GLSL_DEPTH_PROJECTED 0
#define VKAO_GLSL_DEPTH_VIEW_Z 1
#define VKAO_GLSL_DEPTH_DISTANCE 2
#define VKAO_GLSL_DEPTH_INVERSE_Z 3
#define VKAO_GLSL_NORMALS_FROM_DEPTH 0
#define VKAO_GLSL_NORMALS_XYZ_SNORM 1
#define VKAO_GLSL_NORMALS_XYZ_UNORM 2
#define VKAO_GLSL_NORMALS_OCT_SNORM 3
#define VKAO_GLSL_NORMALS_OCT_UNORM 4
#define VKAO_GLSL_THICKNESS_AS_SEEN 0
#define VKAO_GLSL_THICKNESS_GIVEN 1
#define VKAO_GLSL_THICKNESS_BACK_DEPTH 2
#define VKAO_GLSL_COMPOSITE_MULTIPLY 0
#define VKAO_GLSL_COMPOSITE_INDIRECT 1
#define VKAO_GLSL_COMPOSITE_AO_ONLY 2
#define VKAO_GLSL_COMPOSITE_NOISY_AO 3
#define VKAO_GLSL_COMPOSITE_NORMALS 4
#define VKAO_GLSL_COMPOSITE_BENT_NORMALS 5
#define VKAO_GLSL_COMPOSITE_VIEW_Z 6
#define VKAO_GLSL_SPECULAR_NONE 0
#define VKAO_GLSL_SPECULAR_FROM_AO 1

/* Distance of step t is q (LINEAR + (1 - LINEAR) q) of the reach, q = (t + jitter) / steps, and at
 * least 1 + LEAST t texels. */
#define VKAO_STEP_LINEAR 0.5 /* hbao, gtao */
#define VKAO_STEP_LEAST 0.5
#define VKAO_VBAO_STEP_LINEAR 0.2
#define VKAO_VBAO_STEP_LEAST 0.26
/* The reach is at most so many times the longer side of what is valid. What lies beyond the image
 * is not known, and the farther samples went the less they would hide: at last all would be open.
 * At once the side what a slab hides at 2000 texels comes out too large: the bounds are
 * gpu-radius. */
#define VKAO_STEP_FARTHEST 6

/* What vbao guesses of the scene between its samples and behind them, and where it samples. Lengths
 * are fractions of the radius, cosines those of the angle to the eye. Found by coordinate search,
 * as tools/bench/fit-vbao does it, on solid and thin scenes together; but THICKNESS_GIVEN_GAP on
 * the scenes of tests/gpu/test_layers.c, THICKNESS_WIDER on those of test_radius.c. These moved
 * THICKNESS_GAP as well, from the 2.5 of the search, which could not tell the two apart.
 * THICKNESS_LENGTH was chosen by hand on the scenes of the search. STEP_LEAST, GAP_FRONT, GAP_BACK,
 * WIDTH_HIDDEN, THICKNESS_WIDTH, _WIDE, _BASE and _SLOPE were moved after that on these scenes, as
 * far as test_artifacts.c, test_noise.c, test_planes.c, test_radius.c and test_truth.c let them:
 * more of SLOPE is better there, and worse for bent normals behind a fence and below a slab.
 * THICKNESS_SEEN and _MISSED, chosen by hand, leave nine steps as they were: on the scenes of the
 * search 16 want it thinner by a tenth, on nine scenes of thin things by a fifth or more. Checked
 * on 17 other frames and twelve other scenes: RMSE of `best` .0497 and .0537 before, .0495 and
 * .0537 with it. At half resolution THICKNESS_GAP is less for ten steps to keep test_radius.c's
 * bounds: RMSE of the scenes is the same, of the twelve others .0682 before, .0679 with it.
 * GAP_RISE was chosen by hand on the scenes of the search and the twelve others, and GAP_FRONT and
 * both GAPs moved with it as far as test_radius.c lets them: RMSE of `default` on the twelve .0612
 * before and .0604 with it, of `best` .0537 and .0530. Checked on the nine of thin things: .0719
 * and .0720, .0700 and .0697. */
#define VKAO_VBAO_REACH_SMOOTH 0.82    /* end of the last step: the smooth falloff hides the rest */
#define VKAO_VBAO_REACH_THRESHOLD 1.08 /* samples beyond stand for what lies before them */
/* Rise over the surface's plane, per run, up to which two samples join. */
#define VKAO_VBAO_JOIN 0.7
/* Share of the rise from the sample before that is taken off the gap: what falls behind something
 * nearer stands for what that hides of it as well. */
#define VKAO_VBAO_GAP_RISE 0.03
#define VKAO_VBAO_GAP_FRONT 0.33 /* share of the gap by which a separate surface's front moves in */
#define VKAO_VBAO_GAP_BACK 0.66  /* share of the gap by which its back moves out */
#define VKAO_VBAO_SECTORS 31     /* of a side, see sectors.glsl */
#define VKAO_VBAO_ROUND 0.9      /* added before a sector bound is cut to an integer */
/* Taken off that at the upper edge of what all joins to the shaded point: its own plane. */
#define VKAO_VBAO_ROUND_LESS 0.3

/* What is seen is as thick as it is wide in the depth image, and a little thicker if it is longer,
 * by LENGTH of the difference, as it may be the edge of a board; WIDTH of that, times SEEN plus
 * MISSED over the number of steps, as fewer samples find less; at least GAP of the way from the
 * sample before, for whose gap it stands, and at most BASE + SLOPE of its lateral distance. */
#define VKAO_VBAO_THICKNESS_WIDTH 0.92
#define VKAO_VBAO_THICKNESS_LENGTH 0.05
#define VKAO_VBAO_THICKNESS_SEEN 0.73
#define VKAO_VBAO_THICKNESS_MISSED 2.43
/* Of what goes on on all sides, but at most WIDER of the width that is seen of it: where the radius
 * is most of the view, and what is seen a sliver of it, that says little. */
#define VKAO_VBAO_THICKNESS_WIDE 1.0
#define VKAO_VBAO_THICKNESS_WIDER 10.0
#define VKAO_VBAO_THICKNESS_GAP 2.46
#define VKAO_VBAO_THICKNESS_GAP_HALF 2.05 /* at half resolution */
#define VKAO_VBAO_THICKNESS_GIVEN_GAP 0.5 /* where thickness is an input, which has no cap */
#define VKAO_VBAO_THICKNESS_BASE 0.384
#define VKAO_VBAO_THICKNESS_SLOPE 0.79
/* A texel of a row or of a column counts so many SHARES, and HIDDEN where something nearer hides
 * how far the surface goes on. */
#define VKAO_VBAO_WIDTH_SHARES 8
#define VKAO_VBAO_WIDTH_HIDDEN 12
/* Depth breaks between two texels if it changes by more than RISE of the smaller change beside them
 * plus LEAST. Surfaces are followed to REACH on each side. Both are tangents of angles that the eye
 * sees, and radii in orthographic views: what is cropped or has more texels is the same. */
#define VKAO_VBAO_BREAK_RISE 3.0
#define VKAO_VBAO_BREAK_LEAST 0.015
#define VKAO_VBAO_WIDTH_REACH 0.03
#define VKAO_VBAO_BREAK_LEAST_RADII 0.15
#define VKAO_VBAO_WIDTH_REACH_RADII 0.4
/* Of raymarch, without that width. */
#define VKAO_THICKNESS_BASE 0.19
#define VKAO_THICKNESS_SLOPE 0.42
/* Times all of these with the threshold: what is far away counts alike, and hides more. */
#define VKAO_THICKNESS_THRESHOLD 1.1

/* View z has that thickness in its last 4 bits, as 2^-7, 1.5 * 2^-7, 2^-6 ... 1, 1.5. */
#define VKAO_THICKNESS_MOST 1.5
#define VKAO_THICKNESS_MASK 15
#define VKAO_THICKNESS_SHIFT 22
#define VKAO_THICKNESS_LEAST_BITS 0x3c000000
/* On a GPU vbao reads it WIDTHS times less, see inverse_unit: its bits then begin so much lower. */
#define VKAO_VBAO_WIDTHS 4.0
#define VKAO_VBAO_WIDTHS_BITS 0x01000000
#define VKAO_THICKNESS_DEPTH_ERROR 0.95e-6 /* what that takes from view z, relative to it */
/* Where thickness is given it is worth 2 bits more, eighths of octaves. */
#define VKAO_THICKNESS_FINER 2

/* Cosine to the eye at which a plane stops getting steeper where the depth image has none: where
 * depth bends by more than BEND of its rise, and the plane's cosine to the shading normal is below
 * AGREES. */
#define VKAO_PLANE_STEEPEST 0.2
#define VKAO_PLANE_BEND 0.25
#define VKAO_PLANE_AGREES 0.7
/* Slope, in texels' sizes a texel, above which such a plane may be a break of depth. Not fitted: of
 * the scenes of vbao RMSE is the same with it and SSIM .001 more; no texel of a wall behind hair is
 * dark (test_artifacts.c). Any slope would do for that, but a corner then has dashes
 * (test_planes.c). */
#define VKAO_PLANE_EDGE_ON 8.0
/* A shading normal closer to it than that is the plane, without the rounding of depth. */
#define VKAO_PLANE_EQUALS 0.9999

/* Cosine to the eye at which tangent planes stop getting steeper in slices: less than that of the
 * last texels that a wall of 80 degrees has before its horizon. */
#define VKAO_STEEPEST 0.002
/* Slope, in view space, at which normals that depth gives stop: their squares are floats at any
 * field of view. */
#define VKAO_STEEPEST_FACET 1.0e9

/* Members of vkao_params that shaders read as they are. The recording copies them by name. */
#define VKAO_PLAIN_CONSTANTS(FLOAT, UINT)                                                          \
    FLOAT(blocking_scale); /* SPHERE */                                                            \
    FLOAT(sharpness);                                                                              \
    FLOAT(intensity);                                                                              \
    FLOAT(strength);                                                                               \
    UINT(noise_index);

/* All that a recording says, in a uniform buffer that it fills first. Rectangles are half open, two
 * 16-bit coordinates to a word, x low: [0] = min, [1] = max. View xy is texel * unproject.xy +
 * unproject.zw, times view z in perspective; texel centres are integers. Inside the shaders view
 * space has +z away from the eye, whatever the caller's hand. The image has its own grid, and at
 * half resolution the stages run on a coarser one. */
struct vkao_constants {
    VKAO_VEC4(image_unproject);
    VKAO_VEC4(unproject); /* of the grid */
    VKAO_VEC4(normal_x);  /* rows of normal_to_view without what it scales by; .w is 0 */
    VKAO_VEC4(normal_y);
    VKAO_VEC4(normal_z);
    VKAO_VEC4(tint);              /* .w is 0 */
    VKAO_UVEC4(path);             /* the CPU's own */
    VKAO_VEC2(inverse_unproject); /* 1 / unproject.xy */
    VKAO_VEC2(unproject_units);   /* VBAO on a GPU: unproject.xy in units */
    /* PROJECTED: .x / (.y - depth) in perspective, .x + .y * depth in orthographic views */
    VKAO_VEC2(linearize);
    VKAO_VEC2(far_test);    /* PROJECTED: depth * .x >= .y is background */
    VKAO_VEC2(depth_error); /* uncertainty of a view z: .x + .y * z, times z in perspective */
    VKAO_UVEC2(image_valid);
    VKAO_UVEC2(valid); /* of the grid */
    VKAO_FLOAT(far_z); /* other encodings: view z of the far plane */
    /* what sharpness is relative to in orthographic views; 0 = the texel's own z */
    VKAO_FLOAT(reference_z);
    VKAO_FLOAT(radius);
    VKAO_FLOAT(reach); /* VBAO: of the last step */
    VKAO_FLOAT(inverse_radius);
    VKAO_FLOAT(bias);        /* scene units */
    VKAO_FLOAT(bias_cosine); /* bias / radius */
    VKAO_FLOAT(break_least); /* scene units, times z in perspective */
    VKAO_FLOAT(width_reach);
    VKAO_FLOAT(thickness); /* VBAO, RAYMARCH: radii, and scale of the thickness in view z */
    /* VBAO: of thickness as seen, which is in the units of width; the last two are RAYMARCH's too,
     * in radii */
    VKAO_FLOAT(thickness_seen);
    VKAO_FLOAT(thickness_gap);
    VKAO_FLOAT(thickness_base);
    VKAO_FLOAT(thickness_slope);
    /* VBAO on a GPU measures lengths in units, of which thickness_gap / VKAO_VBAO_WIDTHS are a
     * radius. The gap of a sample then compares with a width without a factor. */
    VKAO_FLOAT(inverse_unit); /* units of a scene unit */
    VKAO_FLOAT(unit_square);  /* a radius in units, squared: below 1 */
    VKAO_FLOAT(unit_base);    /* thickness_base, _slope and _seen for units */
    VKAO_FLOAT(unit_slope);
    VKAO_FLOAT(unit_seen);
    VKAO_FLOAT(hidden_share); /* of a sector, in what units weigh */
    VKAO_FLOAT(power);
    VKAO_FLOAT(debug_distance);
    VKAO_FLOAT(farthest);     /* texels, see VKAO_STEP_FARTHEST */
    VKAO_FLOAT(view_z_pitch); /* see shaders/gpu/view_z.glsl */
    VKAO_FLOAT(view_z_last);
    VKAO_UINT(view_z_columns); /* of a block */
    VKAO_UINT(slices);
    VKAO_UINT(steps);
    VKAO_UINT(samples);
    VKAO_PLAIN_CONSTANTS(VKAO_FLOAT, VKAO_UINT)
};

/* What a dispatch says by itself, in push constants. The CPU's passes have their own. */
struct vkao_dispatch {
    VKAO_UVEC2(rect); /* to write, on the pass's grid */
};
/* At most, of any pass. */
#define VKAO_PUSH_BYTES 32

#endif
