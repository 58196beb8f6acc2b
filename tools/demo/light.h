/* SPDX-License-Identifier: MIT
 *
 * The light of the demo: a low warm sun with soft edges under a clear sky, all surfaces matt.
 * Radiance is linear Rec. 709, exposed so that sunlit chalk is about 1. */
#ifndef VKAO_DEMO_LIGHT_H_
#define VKAO_DEMO_LIGHT_H_

#include "trace_camera.h"
#include "trace.h"

enum light_mode {
    LIGHT_FLAT, /* sun and shadow, and open sky everywhere: a picture that lacks AO */
    LIGHT_PATH, /* path tracing: what it should look like */
};

/* The mean over `samples` points of the texel (column, row), box filter. Deterministic. */
struct vec3 light_texel(const struct trace_scene *scene, const struct trace_camera *camera,
                        enum light_mode mode, int column, int row, int width, int height,
                        int samples);

#endif
