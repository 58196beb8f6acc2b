/* SPDX-License-Identifier: MIT
 *
 * The scene that speed is measured on: a furnished room of boxes and spheres, whose G-buffer is
 * computed from formulas at any resolution. Nothing is left to chance: the same size gives the same
 * bytes. */
#ifndef VKAO_BENCH_ROOM_H_
#define VKAO_BENCH_ROOM_H_

#include "error.h"

#include <stdint.h>

/* View z lies in [2, 9], that of sky at ROOM_SKY, beyond the far plane. Its median is 7, where a
 * radius of 0.5 is 120 texels of an image 1920 wide. */
#define ROOM_SKY 1000.0f
#define ROOM_RADIUS 0.5f

/* Rows from the top. View space: x right, y up, z away from the eye. */
struct room {
    uint32_t width, height;
    float *z;          /* width * height */
    uint32_t *normals; /* width * height: signed normalised bytes, x the lowest, y, z; 0 = sky */
};

/* sky: rows in a hundred that show sky, from the top. Errors: EXIT_MEMORY. */
bool room_create(uint32_t width, uint32_t height, unsigned sky, struct room *room,
                 struct tool_error *err);
void room_free(struct room *room);

/* View space to clip space: horizontal field of view 60 degrees, far plane between room and sky. */
void room_projection(uint32_t width, uint32_t height, float projection[16]);

/* PREFIX_z32.npy and PREFIX_n8.npy, NumPy arrays (format 1.0) of height x width float32 and uint32.
 * Errors: EXIT_OUTPUT. */
bool room_dump(const struct room *room, const char *prefix, struct tool_error *err);

#endif
