/* SPDX-License-Identifier: MIT */
#include "room.h"

#include "atomic_file.h"
#include "parallel.h"
#include "text.h"
#include "trace.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Half the image's width at z 1: tan(30 degrees). */
#define HALF_WIDTH 0.57735026918962576

/* The room itself: its walls, seen from inside. The camera is at the origin, level. */
static const struct vec3 room_center = {0, -0.1, 4}, room_half = {3.7, 1.5, 5};

/* A sphere if half is all zero, else a box turned by yaw about y. */
struct thing {
    struct vec3 center;
    double radius;
    struct vec3 half;
    double yaw;
};

#define SPHERE(x, y, z, r)                                                                         \
    {                                                                                              \
        .center = {x, y, z}, .radius = r                                                           \
    }
#define BOX(x, y, z, hx, hy, hz, turn)                                                             \
    {                                                                                              \
        .center = {x, y, z}, .half = {hx, hy, hz}, .yaw = turn                                     \
    }

/* clang-format off */
static const struct thing furniture[] = {
    /* a table with a bowl of fruit, and two chairs */
    BOX(.5, -.86, 6.2, .95, .03, .55, .3),
    BOX(-.47, -1.245, 6.01, .04, .355, .04, .3), BOX(1.19, -1.245, 5.49, .04, .355, .04, .3),
    BOX(-.19, -1.245, 6.91, .04, .355, .04, .3), BOX(1.47, -1.245, 6.39, .04, .355, .04, .3),
    BOX(.55, -.80, 6.2, .16, .03, .16, .8),
    SPHERE(.47, -.70, 6.16, .08), SPHERE(.62, -.70, 6.14, .075), SPHERE(.56, -.70, 6.30, .08),
    SPHERE(.55, -.59, 6.20, .075),
    BOX(-.75, -1.15, 5.9, .24, .025, .24, -.4), BOX(-.95, -.87, 5.81, .025, .26, .23, -.4),
    BOX(-.86, -1.385, 5.64, .025, .215, .025, -.4), BOX(-.49, -1.385, 5.79, .025, .215, .025, -.4),
    BOX(-1.01, -1.385, 6.01, .025, .215, .025, -.4), BOX(-.64, -1.385, 6.16, .025, .215, .025, -.4),
    BOX(1.9, -1.15, 6.9, .24, .025, .24, .9), BOX(2.04, -.87, 6.73, .025, .26, .23, .9),
    BOX(1.62, -1.385, 6.93, .025, .215, .025, .9), BOX(1.87, -1.385, 6.62, .025, .215, .025, .9),
    BOX(1.93, -1.385, 7.18, .025, .215, .025, .9), BOX(2.18, -1.385, 6.87, .025, .215, .025, .9),
    /* a sofa along the left wall, with cushions */
    BOX(-3.1, -1.38, 7.2, .5, .22, 1.1, 0), BOX(-3.5, -.95, 7.2, .18, .35, 1.1, 0),
    BOX(-3.1, -1.1, 8.2, .5, .32, .12, 0), BOX(-3.1, -1.1, 6.2, .5, .32, .12, 0),
    BOX(-3.05, -1.02, 7.9, .1, .2, .22, .5), BOX(-3.05, -1.02, 6.6, .1, .2, .22, -.4),
    /* a shelf at the back, with books, boxes and balls */
    BOX(-1.95, -.4, 8.8, .03, 1.2, .2, 0), BOX(.05, -.4, 8.8, .03, 1.2, .2, 0),
    BOX(-.95, .8, 8.8, 1.0, .03, .2, 0), BOX(-.95, .3, 8.8, 1.0, .02, .2, 0),
    BOX(-.95, -.2, 8.8, 1.0, .02, .2, 0), BOX(-.95, -.7, 8.8, 1.0, .02, .2, 0),
    BOX(-.95, -1.2, 8.8, 1.0, .02, .2, 0),
    BOX(-1.85, .48, 8.8, .03, .16, .12, 0), BOX(-1.77, .46, 8.8, .04, .14, .12, 0),
    BOX(-1.66, .49, 8.8, .05, .17, .12, .1), BOX(-1.55, .45, 8.8, .03, .13, .12, 0),
    BOX(-1.46, .47, 8.8, .04, .15, .12, 0), BOX(-.3, .42, 8.8, .2, .1, .12, 0),
    BOX(-1.2, -.05, 8.8, .25, .13, .14, .2), SPHERE(-.5, -.05, 8.78, .13),
    BOX(-.2, -.03, 8.8, .03, .15, .12, 0), BOX(-.12, -.02, 8.8, .03, .16, .12, 0),
    BOX(-1.7, -.53, 8.8, .05, .15, .12, 0), BOX(-1.58, -.54, 8.8, .05, .14, .12, 0),
    BOX(-1.45, -.52, 8.8, .05, .16, .12, -.1), BOX(-.7, -.6, 8.8, .3, .08, .14, 0),
    SPHERE(-1.3, -1.06, 8.78, .12), SPHERE(-1.0, -1.06, 8.78, .12), SPHERE(-.7, -1.06, 8.78, .12),
    /* a cupboard on the right, a picture, a door frame, a rug */
    BOX(3.35, -.7, 7.9, .35, .9, .7, 0), BOX(3.35, .24, 7.9, .3, .04, .6, 0),
    BOX(1.6, .3, 8.96, .6, .4, .04, 0), BOX(1.6, .3, 8.93, .5, .3, .04, 0),
    BOX(2.5, -.5, 8.97, .05, 1.1, .05, 0), BOX(3.3, -.5, 8.97, .05, 1.1, .05, 0),
    BOX(2.9, .65, 8.97, .45, .05, .05, 0), BOX(.4, -1.59, 6.3, 1.7, .01, 1.2, .1),
    /* a lamp on a wire above the table, and beams */
    BOX(.5, .98, 6.3, .008, .42, .008, 0), SPHERE(.5, .42, 6.3, .2),
    BOX(0, 1.34, 5.2, 3.7, .08, .1, 0), BOX(0, 1.34, 6.8, 3.7, .08, .1, 0),
    BOX(0, 1.34, 8.4, 3.7, .08, .1, 0),
    /* balls on the floor, a plant of spheres in a box, and a desk that reaches near the eye */
    SPHERE(-1.7, -1.35, 6.7, .25), SPHERE(-2.1, -1.45, 6.2, .15), SPHERE(1.35, -1.42, 5.2, .18),
    BOX(-2.9, -1.3, 5.3, .2, .3, .2, .6), SPHERE(-2.9, -.75, 5.3, .25),
    SPHERE(-2.72, -.5, 5.2, .18), SPHERE(-3.05, -.45, 5.35, .2), SPHERE(-2.88, -.25, 5.3, .16),
    BOX(1.15, -.62, 2.5, .5, .02, .35, .25), BOX(1.0, -1.1, 2.6, .3, .46, .22, .25),
    BOX(.98, -.58, 2.4, .12, .02, .09, .5), SPHERE(1.15, -.52, 2.7, .08),
};
/* clang-format on */
enum { FURNITURE = sizeof furniture / sizeof furniture[0] };

/* --- The image --- */

static bool build_scene(struct trace_scene *scene)
{
    trace_add(scene, trace_box(room_center, room_half));
    for (size_t i = 0; i < FURNITURE; i++) {
        const struct thing *t = &furniture[i];
        struct trace_primitive p =
            t->radius > 0 ? trace_sphere(t->center, t->radius) : trace_box(t->center, t->half);
        p.axes = mat3_turned(t->yaw, 0, 0);
        trace_add(scene, p);
    }
    return trace_build(scene);
}

struct drawing {
    struct room *room;
    const struct trace_scene *scene;
    struct vec3 first;       /* the way from the eye through the first texel's centre */
    struct vec3 right, down; /* from texel to texel */
};

static uint32_t pack_normal(struct vec3 n)
{
    const double components[] = {n.x, n.y, n.z};
    uint32_t word = 0;
    for (int i = 0; i < 3; i++)
        word |= (uint32_t)(uint8_t)(int8_t)lround(components[i] * 127.0) << (8 * i);
    return word;
}

/* A job of parallel_run. */
static void draw_row(void *data, uint32_t y)
{
    const struct drawing *d = data;
    const struct vec3 row = mad(d->down, y, d->first), eye = {0, 0, 0};
    for (uint32_t x = 0; x < d->room->width; x++) {
        const size_t texel = (size_t)y * d->room->width + x;
        const struct vec3 ray = normalize(mad(d->right, x, row));
        struct trace_hit hit;
        if (!trace_closest(d->scene, eye, ray, 0, INFINITY, &hit))
            continue; /* the walls are all around */
        d->room->z[texel] = (float)(hit.t * ray.z);
        d->room->normals[texel] = pack_normal(trace_facing(&hit, ray));
    }
}

static void draw_sky(struct room *room, unsigned percent)
{
    size_t rows = ((size_t)room->height * percent + 50) / 100, texels = rows * room->width;
    for (size_t i = 0; i < texels; i++) {
        room->z[i] = ROOM_SKY;
        room->normals[i] = 0;
    }
}

static bool draw(struct room *room)
{
    const double half_height = HALF_WIDTH * room->height / room->width;
    const double step_x = 2 * HALF_WIDTH / room->width, step_y = 2 * half_height / room->height;
    struct trace_scene scene = {0};
    struct drawing drawing = {
        .room = room,
        .scene = &scene,
        .first = {0.5 * step_x - HALF_WIDTH, half_height - 0.5 * step_y, 1},
        .right = {step_x, 0, 0},
        .down = {0, -step_y, 0},
    };
    bool ok = build_scene(&scene);
    if (ok)
        parallel_run(NULL, room->height, draw_row, &drawing);
    trace_scene_free(&scene);
    return ok;
}

bool room_create(uint32_t width, uint32_t height, unsigned sky, struct room *room,
                 struct tool_error *err)
{
    size_t texels, bytes;
    *room = (struct room){.width = width, .height = height};
    if (size_multiply(width, height, &texels) && size_multiply(texels, 4, &bytes)) {
        room->z = calloc(1, bytes);
        room->normals = calloc(1, bytes);
    }
    if (!room->z || !room->normals || !draw(room)) {
        room_free(room);
        return fail(err, EXIT_MEMORY, "out of memory for a room of %u x %u", width, height);
    }
    draw_sky(room, sky);
    return true;
}

void room_free(struct room *room)
{
    free(room->z);
    free(room->normals);
    *room = (struct room){0};
}

void room_projection(uint32_t width, uint32_t height, float projection[16])
{
    const double near = 0.1, far = 100; /* sky lies beyond */
    memset(projection, 0, 16 * sizeof *projection);
    projection[0] = (float)(1 / HALF_WIDTH);
    projection[5] = (float)(-1 / (HALF_WIDTH * height / width)); /* y is up, NDC's is down */
    projection[10] = (float)(far / (far - near));
    projection[11] = 1; /* w = z: the camera looks along +z */
    projection[14] = (float)(-near * far / (far - near));
}

/* --- Dump --- */

static bool dump(const char *prefix, const char *suffix, const char *type, const struct room *room,
                 const void *data, struct tool_error *err)
{
    enum { PREAMBLE = 10, ALIGNMENT = 64, HEADER = 2 * ALIGNMENT };
    struct atomic_file file = {0};
    struct text path = {0};
    char header[HEADER + 1];
    text_add(&path, "%s%s", prefix, suffix);
    if (path.out_of_memory)
        return fail(err, EXIT_MEMORY, "out of memory");
    /* Magic, version 1.0, length of the rest: NumPy's NEP 1. Blanks fill it to a multiple of 64. */
    memcpy(header, "\x93NUMPY\x01\x00", 8);
    header[8] = (char)(HEADER - PREAMBLE);
    header[9] = 0;
    int length = snprintf(header + PREAMBLE, HEADER - PREAMBLE,
                          "{'descr': '%s', 'fortran_order': False, 'shape': (%u, %u), }", type,
                          room->height, room->width);
    memset(header + PREAMBLE + length, ' ', (size_t)(HEADER - PREAMBLE - length));
    header[HEADER - 1] = '\n';
    bool ok = atomic_file_open(&file, path.data, true, err) &&
              atomic_file_write(&file, header, HEADER, err) &&
              atomic_file_write(&file, data, (size_t)room->width * room->height * 4, err) &&
              atomic_file_commit(&file, err);
    if (!ok)
        atomic_file_abort(&file);
    text_free(&path);
    return ok;
}

bool room_dump(const struct room *room, const char *prefix, struct tool_error *err)
{
    return dump(prefix, "_z32.npy", "<f4", room, room->z, err) &&
           dump(prefix, "_n8.npy", "<u4", room, room->normals, err);
}
