/* SPDX-License-Identifier: MIT
 *
 * Cubes coloured by their local coordinates, on a grey slab; one more tumbles round above it. */
#include "scene_design.h"

#include <stddef.h>

static const double slab_half = 3.0, slab_thickness = 0.3;

/* Standing on the slab or on each other; y is the height of the cube's lower side. */
static const struct cube {
    double x, y, z, edge, yaw;
} cubes[] = {
    {0.0, 0.0, 0.0, 1.2, 0.35},    {0.05, 1.2, -0.05, 0.8, 1.0},  {0.0, 2.0, 0.0, 0.45, 0.2},
    {1.05, 0.0, 0.45, 0.7, 0.1},   {0.95, 0.7, 0.4, 0.4, 0.6},    {-0.95, 0.0, 0.55, 0.6, 0.75},
    {-0.55, 0.0, 1.15, 0.45, 0.2}, {0.35, 0.0, 1.15, 0.5, 1.2},   {-1.0, 0.0, -0.5, 0.8, 0.05},
    {-0.95, 0.8, -0.45, 0.5, 0.5}, {0.7, 0.0, -1.0, 0.9, 0.5},    {-0.3, 0.0, -1.25, 0.6, 1.3},
    {2.3, 0.0, -2.2, 0.7, 0.3},    {2.35, 0.7, -2.2, 0.35, 0.9},  {-2.3, 0.0, -2.1, 0.9, 0.9},
    {-2.35, 0.0, 2.25, 0.5, 0.4},  {-1.85, 0.0, 2.35, 0.35, 1.1}, {2.35, 0.0, 2.3, 0.6, 0.65},
};

static const double tumbler_half = 0.28, tumbler_orbit = 2.05;

static void build_still(struct mesh *mesh)
{
    mesh_box(mesh, mesh_at(vec3(0, -0.5 * slab_thickness, 0)),
             vec3(slab_half, 0.5 * slab_thickness, slab_half), vec3(0.6, 0.6, 0.6));
    for (size_t i = 0; i < sizeof cubes / sizeof cubes[0]; ++i) {
        const struct cube *c = &cubes[i];
        struct mesh_place place = {mat3_turned(c->yaw, 0, 0), {c->x, c->y + 0.5 * c->edge, c->z}};
        mesh_color_box(mesh, place, vec3(0.5 * c->edge, 0.5 * c->edge, 0.5 * c->edge));
    }
}

static void build_moving(struct mesh *mesh)
{
    mesh_color_box(mesh, mesh_at(vec3(0, 0, 0)), vec3(tumbler_half, tumbler_half, tumbler_half));
}

/* One round takes 12 seconds. */
static struct mesh_place motion(double time)
{
    double turn = 2 * PI * remainder(time / 12, 1);
    /* Whole multiples of the round: it ends as it began. Lifted so that no corner sinks in. */
    return (struct mesh_place){
        mat3_turned(2 * turn, 3 * turn, turn),
        vec3(tumbler_orbit * sin(turn), sqrt(3) * tumbler_half + 0.02, tumbler_orbit * cos(turn)),
    };
}

const struct live_design live_cubes = {
    .name = "cubes",
    .camera =
        {
            .target = {0, 0.3, 0},
            .yaw = 0.6,
            .pitch = 0.5,
            .distance = 8.6,
            .distance_min = 1.5,
            .distance_max = 40,
            .fov_y = 0.8,
            .near = 0.05,
            .reach = 12,
        },
    .radius = 0.6f,
    .background = {0.16f, 0.18f, 0.21f},
    .build_still = build_still,
    .build_moving = build_moving,
    .motion = motion,
};
