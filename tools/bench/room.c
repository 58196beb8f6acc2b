/* SPDX-License-Identifier: MIT */
#include "room.h"

#include "atomic_file.h"
#include "text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Half the image's width at z 1: tan(30 degrees). */
#define HALF_WIDTH 0.57735026918962576

/* The room itself: its walls, seen from inside. The camera is at the origin, level. */
static const double walls[3][2] = {{-3.7, 3.7}, {-1.6, 1.4}, {-1.0, 9.0}};

/* A sphere if half is all zero, else a box turned by yaw about y. */
struct thing {
    double center[3], radius, half[3], yaw;
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

/* --- What a ray hits: rays leave the eye along (x, y, 1), so that view z is their length --- */

struct hit {
    double z, normal[3];
};

static void hit_walls(const double ray[3], struct hit *hit)
{
    hit->z = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        bool positive = ray[axis] > 0;
        double z = ray[axis] != 0 ? walls[axis][positive] / ray[axis] : INFINITY;
        if (z >= hit->z)
            continue;
        *hit = (struct hit){.z = z};
        hit->normal[axis] = positive ? -1 : 1;
    }
}

static void hit_sphere(const struct thing *t, const double ray[3], struct hit *hit)
{
    const double *c = t->center;
    double a = ray[0] * ray[0] + ray[1] * ray[1] + 1, b = ray[0] * c[0] + ray[1] * c[1] + c[2];
    double rest = b * b - a * (c[0] * c[0] + c[1] * c[1] + c[2] * c[2] - t->radius * t->radius);
    double z = rest > 0 ? (b - sqrt(rest)) / a : INFINITY;
    if (!(z < hit->z))
        return;
    hit->z = z;
    for (int i = 0; i < 3; i++)
        hit->normal[i] = (ray[i] * z - c[i]) / t->radius;
}

/* Turns v from view space to the axes of a box; the other way round with -sine. */
static void turn(const double v[3], double cosine, double sine, double out[3])
{
    out[0] = cosine * v[0] - sine * v[2];
    out[1] = v[1];
    out[2] = sine * v[0] + cosine * v[2];
}

static void hit_box(const struct thing *t, double cosine, double sine, const double ray[3],
                    struct hit *hit)
{
    double center[3], along[3], enter = -INFINITY, leave = INFINITY;
    int face = 0;
    turn(t->center, cosine, sine, center);
    turn(ray, cosine, sine, along);
    for (int axis = 0; axis < 3; axis++) {
        double reach = along[axis] < 0 ? -t->half[axis] : t->half[axis];
        /* A ray along the face: divided by 0, which leaves infinities with the right signs. */
        double in = (center[axis] - reach) / along[axis],
               out = (center[axis] + reach) / along[axis];
        if (in > enter) {
            enter = in;
            face = axis;
        }
        leave = out < leave ? out : leave;
    }
    if (!(enter < leave) || !(enter > 0) || !(enter < hit->z))
        return;
    double normal[3] = {0};
    normal[face] = along[face] < 0 ? 1 : -1;
    hit->z = enter;
    turn(normal, cosine, -sine, hit->normal);
}

/* --- The image --- */

static uint32_t pack_normal(const double n[3])
{
    uint32_t word = 0;
    for (int i = 0; i < 3; i++)
        word |= (uint32_t)(uint8_t)(int8_t)lround(n[i] * 127.0) << (8 * i);
    return word;
}

/* Texels of one image axis that a ball around the thing can cover, in [0,size): slopes within the
 * angle under which it is seen. */
static void covered(const struct thing *t, int axis, double slope0, double step, uint32_t size,
                    uint32_t *begin, uint32_t *end)
{
    double radius =
        t->radius > 0
            ? t->radius
            : sqrt(t->half[0] * t->half[0] + t->half[1] * t->half[1] + t->half[2] * t->half[2]);
    double a = t->center[axis], z = t->center[2], distance = hypot(a, z);
    *begin = 0;
    *end = size;
    if (distance <= radius * 1.001)
        return;
    double middle = atan2(a, z), spread = asin(radius / distance);
    double low = middle - spread, high = middle + spread;
    if (low <= -1.5 || high >= 1.5) /* nearly 90 degrees: the tangent would turn over */
        return;
    double first = (tan(low) - slope0) / step, last = (tan(high) - slope0) / step;
    double from = floor(fmin(first, last)) - 1, to = ceil(fmax(first, last)) + 2;
    *begin = from > 0 ? (uint32_t)fmin(from, size) : 0;
    *end = to > 0 ? (uint32_t)fmin(to, size) : 0;
}

struct drawing {
    struct room *room;
    double slope[2], step[2]; /* of the first texel's centre, and from texel to texel: x, y */
};

static void ray_at(const struct drawing *d, uint32_t x, uint32_t y, double ray[3])
{
    ray[0] = d->slope[0] + d->step[0] * x;
    ray[1] = d->slope[1] + d->step[1] * y;
    ray[2] = 1;
}

static void keep(const struct drawing *d, uint32_t x, uint32_t y, const struct hit *hit)
{
    size_t i = (size_t)y * d->room->width + x;
    d->room->z[i] = (float)hit->z;
    d->room->normals[i] = pack_normal(hit->normal);
}

static void draw_thing(const struct drawing *d, const struct thing *t)
{
    uint32_t x0, x1, y0, y1;
    const bool is_sphere = t->radius > 0;
    const double cosine = cos(t->yaw), sine = sin(t->yaw);
    covered(t, 0, d->slope[0], d->step[0], d->room->width, &x0, &x1);
    covered(t, 1, d->slope[1], d->step[1], d->room->height, &y0, &y1);
    for (uint32_t y = y0; y < y1; y++) {
        for (uint32_t x = x0; x < x1; x++) {
            double ray[3], before = (double)d->room->z[(size_t)y * d->room->width + x];
            struct hit hit = {.z = before};
            ray_at(d, x, y, ray);
            if (is_sphere)
                hit_sphere(t, ray, &hit);
            else
                hit_box(t, cosine, sine, ray, &hit);
            if (hit.z < before)
                keep(d, x, y, &hit);
        }
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

bool room_create(uint32_t width, uint32_t height, unsigned sky, struct room *room,
                 struct tool_error *err)
{
    size_t texels, bytes;
    const double half_height = HALF_WIDTH * height / width;
    const struct drawing drawing = {
        .room = room,
        .step = {2 * HALF_WIDTH / width, -2 * half_height / height},
        .slope = {HALF_WIDTH / width - HALF_WIDTH, half_height - half_height / height},
    };
    *room = (struct room){.width = width, .height = height};
    if (size_multiply(width, height, &texels) && size_multiply(texels, 4, &bytes)) {
        room->z = malloc(bytes);
        room->normals = malloc(bytes);
    }
    if (!room->z || !room->normals) {
        room_free(room);
        return fail(err, EXIT_MEMORY, "out of memory for a room of %u x %u", width, height);
    }
    for (uint32_t y = 0; y < height; y++) {
        for (uint32_t x = 0; x < width; x++) {
            struct hit hit;
            double ray[3];
            ray_at(&drawing, x, y, ray);
            hit_walls(ray, &hit);
            keep(&drawing, x, y, &hit);
        }
    }
    for (size_t i = 0; i < FURNITURE; i++)
        draw_thing(&drawing, &furniture[i]);
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
