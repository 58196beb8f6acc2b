/* SPDX-License-Identifier: MIT
 *
 * The camera of an image whose texels hold positions, in whatever space: where a texel stands in
 * the image is a linear function of where it is, over another one. */
#ifndef VKAO_TOOLS_CAMERA_POSITIONS_H_
#define VKAO_TOOLS_CAMERA_POSITIONS_H_

#include "error.h"
#include "exr_file.h"

#include <stdbool.h>
#include <stdint.h>

struct positions {
    const float *values; /* width * height * 4, xyz and padding; 0 or not finite: background */
    uint32_t width, height;
    struct exr_box data_window, display_window;
    double pixel_aspect;
};

struct position_camera {
    bool is_sure, is_orthographic;
    double half_width;       /* as struct camera has it */
    double shift_x, shift_y; /* likewise */
    double rotation[9];      /* positions to view space, m[row * 3 + column] */
    double translation[3];
    double error;  /* texels, root mean square */
    char why[128]; /* not sure: because ... */
};

/* False only if memory runs out. */
bool camera_from_positions(const struct positions *positions, struct position_camera *camera,
                           struct tool_error *err);
/* Whether a texel is no background. */
bool positions_are_there(const float position[3]);
/* Distance along the view axis, scene units. */
double position_depth(const struct position_camera *camera, const float position[3]);
/* Texels between where a camera sees the positions and where they stand: the median. INFINITY if
 * there are none, or most are not before it. False if memory runs out. */
bool positions_miss(const struct positions *positions, const struct position_camera *camera,
                    double *texels);

#endif
