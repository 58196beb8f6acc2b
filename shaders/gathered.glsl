/* SPDX-License-Identifier: MIT
 *
 * Where textureGather has the texels of its two by two, by y and x. */
#ifndef VKAO_GATHERED_GLSL_
#define VKAO_GATHERED_GLSL_

const int GATHERED[2][2] = int[2][2](int[2](3, 2), int[2](0, 1));

#endif
