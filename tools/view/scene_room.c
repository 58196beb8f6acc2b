/* SPDX-License-Identifier: MIT
 *
 * A furnished room without a ceiling: walls between the eye and the inside are not seen, so that
 * one can look in from all around. Units are metres. */
#include "scene_design.h"

#include <stddef.h>

static const struct vec3 room_size = {8, 3, 6};

static const struct vec3 plaster = {0.78, 0.75, 0.70}, boards = {0.55, 0.42, 0.30},
                         oak = {0.50, 0.33, 0.19}, walnut = {0.30, 0.19, 0.12},
                         stone = {0.70, 0.69, 0.66}, cloth = {0.24, 0.36, 0.45},
                         cushion = {0.72, 0.48, 0.24}, carpet = {0.55, 0.20, 0.17},
                         paper = {0.80, 0.78, 0.70}, leaf = {0.25, 0.42, 0.20},
                         clay = {0.62, 0.33, 0.22}, iron = {0.16, 0.16, 0.17};

/* Boxes that stand along the axes: least corner and size. */
static const struct block {
    struct vec3 corner, size;
    const struct vec3 *albedo;
} blocks[] = {
    /* table */
    {{-1.7, 0.70, -0.5}, {2.0, 0.06, 1.0}, &oak},
    {{-1.65, 0, -0.45}, {0.08, 0.70, 0.08}, &oak},
    {{0.17, 0, -0.45}, {0.08, 0.70, 0.08}, &oak},
    {{-1.65, 0, 0.37}, {0.08, 0.70, 0.08}, &oak},
    {{0.17, 0, 0.37}, {0.08, 0.70, 0.08}, &oak},
    /* what lies on it */
    {{-0.35, 0.76, -0.25}, {0.32, 0.05, 0.22}, &carpet},
    {{-0.32, 0.81, -0.23}, {0.28, 0.04, 0.20}, &cloth},
    {{-0.29, 0.85, -0.22}, {0.24, 0.05, 0.18}, &paper},
    /* carpet */
    {{-2.3, 0, -1.3}, {3.2, 0.02, 2.6}, &carpet},
    /* sofa along the left wall */
    {{-3.95, 0.08, -1.1}, {0.95, 0.34, 2.2}, &cloth},
    {{-3.95, 0.42, -1.1}, {0.28, 0.45, 2.2}, &cloth},
    {{-3.95, 0.08, -1.32}, {0.95, 0.56, 0.22}, &cloth},
    {{-3.95, 0.08, 1.1}, {0.95, 0.56, 0.22}, &cloth},
    {{-3.62, 0.42, 0.45}, {0.16, 0.40, 0.5}, &cushion},
    /* step along the back wall, and a low cupboard on it */
    {{1.6, 0, -3}, {2.4, 0.18, 1.0}, &stone},
    {{2.2, 0.18, -2.95}, {1.4, 0.62, 0.45}, &walnut},
    {{2.15, 0.80, -2.97}, {1.5, 0.04, 0.52}, &oak},
    /* picture on the back wall */
    {{-0.1, 1.3, -2.97}, {1.1, 0.8, 0.04}, &walnut},
    {{-0.02, 1.38, -2.95}, {0.94, 0.64, 0.03}, &paper},
    /* skirting of the walls that are seen at first */
    {{-4, 0, -3}, {8, 0.1, 0.03}, &paper},
    {{-4, 0, -3}, {0.03, 0.1, 6}, &paper},
    /* stool, crate */
    {{1.0, 0, -1.8}, {0.5, 0.42, 0.5}, &oak},
    {{3.2, 0, 2.1}, {0.65, 0.55, 0.65}, &oak},
};

static const struct ball {
    struct vec3 center;
    double radius;
    const struct vec3 *albedo;
} balls[] = {
    {{-1.3, 0.87, 0.1}, 0.11, &cushion}, {{-1.12, 0.86, 0.22}, 0.10, &leaf},
    {{-1.1, 0.86, 0.0}, 0.10, &carpet},  {{2.6, 1.05, -2.7}, 0.21, &clay},
    {{3.2, 0.98, -2.7}, 0.14, &stone},   {{-3.35, 0.80, -2.4}, 0.42, &leaf},
    {{-3.2, 1.15, -2.5}, 0.30, &leaf},   {{3.5, 0.80, 2.4}, 0.25, &clay},
};

/* The two columns come first: the ball circles one of them. */
static const struct pillar {
    struct vec3 base;
    double radius, height;
    const struct vec3 *albedo;
} pillars[] = {
    {{2.0, 0.12, 0.6}, 0.22, 2.76, &stone},    {{-2.6, 0.12, 2.2}, 0.22, 2.76, &stone},
    {{-3.3, 0, -2.45}, 0.26, 0.45, &clay},     {{-0.65, 0.76, 0.3}, 0.05, 0.14, &stone},
    {{-2.55, 0, -2.6}, 0.16, 0.03, &iron},     {{-2.55, 0.03, -2.6}, 0.02, 1.45, &iron},
    {{-2.55, 1.45, -2.6}, 0.20, 0.28, &paper},
};
enum { COLUMNS = 2 };

/* A chair that faces along +z of its own. */
static void add_chair(struct mesh *mesh, struct vec3 position, double yaw)
{
    static const struct block parts[] = {
        {{-0.22, 0.43, -0.22}, {0.44, 0.04, 0.44}, &walnut},
        {{-0.22, 0, -0.22}, {0.045, 0.95, 0.045}, &walnut},
        {{0.175, 0, -0.22}, {0.045, 0.95, 0.045}, &walnut},
        {{-0.22, 0, 0.175}, {0.045, 0.43, 0.045}, &walnut},
        {{0.175, 0, 0.175}, {0.045, 0.43, 0.045}, &walnut},
        {{-0.175, 0.72, -0.215}, {0.35, 0.2, 0.03}, &walnut},
        {{-0.175, 0.58, -0.215}, {0.35, 0.05, 0.03}, &walnut},
    };
    struct mat3 axes = mat3_turned(yaw, 0, 0);
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; ++i) {
        struct vec3 half = scale(parts[i].size, 0.5), center = add(parts[i].corner, half);
        mesh_box(mesh, (struct mesh_place){axes, add(mul_transposed(axes, center), position)}, half,
                 *parts[i].albedo);
    }
}

/* Five boards between two sides at the back wall, with books of many sizes. */
static void add_shelf(struct mesh *mesh, double x, double width)
{
    static const struct vec3 *const covers[] = {&carpet, &cloth, &paper, &leaf, &cushion, &clay};
    const double height = 2.1, depth = 0.32, board = 0.04, z = -3 + 0.5 * depth;
    enum { BOARDS = 5, BOOKS = 9 };
    for (int side = -1; side <= 1; side += 2)
        mesh_box(mesh, mesh_at(vec3(x + side * 0.5 * width, 0.5 * height, z)),
                 vec3(0.5 * board, 0.5 * height, 0.5 * depth), walnut);
    for (int b = 0; b < BOARDS; ++b) {
        double y = 0.1 + b * (height - 0.14) / (BOARDS - 1);
        mesh_box(mesh, mesh_at(vec3(x, y, z)), vec3(0.5 * width, 0.5 * board, 0.5 * depth), walnut);
        double left = x - 0.5 * width + board;
        for (int i = 0; b + 1 < BOARDS && i < BOOKS; ++i) {
            /* Any numbers will do that do not repeat from board to board. */
            int k = (i * 5 + b * 7 + i * i * b) % 8;
            double thick = 0.035 + 0.008 * k, tall = 0.24 + 0.02 * ((k * 3 + i) % 6);
            mesh_box(mesh, mesh_at(vec3(left + 0.5 * thick, y + 0.5 * (board + tall), z)),
                     vec3(0.5 * thick, 0.5 * tall, 0.10), *covers[(i + k + b) % 6]);
            left += thick + (i == 4 ? 0.12 : 0.004);
        }
    }
}

static void build_still(struct mesh *mesh)
{
    mesh_room(mesh, room_size, boards, plaster);
    for (size_t i = 0; i < sizeof blocks / sizeof blocks[0]; ++i) {
        struct vec3 half = scale(blocks[i].size, 0.5);
        mesh_box(mesh, mesh_at(add(blocks[i].corner, half)), half, *blocks[i].albedo);
    }
    for (size_t i = 0; i < sizeof balls / sizeof balls[0]; ++i)
        mesh_sphere(mesh, balls[i].center, balls[i].radius, *balls[i].albedo, *balls[i].albedo);
    for (size_t i = 0; i < sizeof pillars / sizeof pillars[0]; ++i)
        mesh_cylinder(mesh, pillars[i].base, pillars[i].radius, pillars[i].height,
                      *pillars[i].albedo);
    /* Base and capital. */
    for (int i = 0; i < COLUMNS; ++i) {
        for (int end = 0; end < 2; ++end)
            mesh_box(mesh, mesh_at(vec3(pillars[i].base.x, end ? 2.94 : 0.06, pillars[i].base.z)),
                     vec3(0.3, 0.06, 0.3), stone);
    }
    add_chair(mesh, vec3(-1.2, 0.02, 0.85), PI - 0.2);
    add_chair(mesh, vec3(-0.3, 0.02, 0.80), PI + 0.15);
    add_chair(mesh, vec3(-1.15, 0.02, -0.8), 0.1);
    add_chair(mesh, vec3(0.6, 0.02, 0.1), -PI / 2 - 0.3);
    add_shelf(mesh, -0.85, 1.0);
    add_shelf(mesh, -1.85, 1.0);
}

/* The ball rolls round the right column. */
static const double ball_radius = 0.22, ball_orbit = 0.88;

static void build_moving(struct mesh *mesh)
{
    mesh_sphere(mesh, vec3(0, 0, 0), ball_radius, cushion, paper);
}

/* One round takes 8 seconds. Rolling without sliding, it turns about the axis that points to the
 * column, by the length of its way over its radius: four whole turns a round, so that it ends as it
 * began. */
static struct mesh_place motion(double time)
{
    double turn = 2 * PI * remainder(time / 8, 1), roll = -turn * ball_orbit / ball_radius;
    struct vec3 out = vec3(sin(turn), 0, cos(turn)), along = vec3(cos(turn), 0, -sin(turn));
    struct vec3 up = vec3(0, 1, 0);
    double c = cos(roll), s = sin(roll);
    return (struct mesh_place){
        {mad(along, c, scale(up, s)), mad(up, c, scale(along, -s)), out},
        mad(out, ball_orbit, vec3(pillars[0].base.x, ball_radius, pillars[0].base.z)),
    };
}

const struct live_design live_room = {
    .name = "room",
    .camera =
        {
            .target = {0.1, 0.7, -0.4},
            .yaw = 0.45,
            .pitch = 0.42,
            .distance = 6.4,
            .distance_min = 0.8,
            .distance_max = 40,
            .fov_y = 0.8,
            .near = 0.05,
            .reach = 12,
        },
    .radius = 0.7f,
    .background = {0.16f, 0.18f, 0.21f},
    .build_still = build_still,
    .build_moving = build_moving,
    .motion = motion,
};
