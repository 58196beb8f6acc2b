/* SPDX-License-Identifier: MIT
 *
 * What shared mathematics is written in. real is a float, or on a CPU one number for each of the
 * texels that an invocation shades side by side (cpu/lanes.glsl), and whole an integer; of reals
 * and ints there are two: one for each side of a slice, or for each point of a pair. */
#ifndef real
#define real float
#define whole int
#define reals vec2
#define ints ivec2
#endif
