/* SPDX-License-Identifier: MIT */
#include "courtyard.h"

enum pattern {
    PATTERN_PLAIN,
    PATTERN_LOCAL, /* colour = local coordinates */
    PATTERN_STONE, /* a shade of its own per block, and blotches */
    PATTERN_PLASTER,
    PATTERN_WOOD, /* streaks along the longest axis */
};

static const struct vec3 sandstone = {0.66, 0.55, 0.41};
static const struct vec3 paving = {0.53, 0.47, 0.40};
static const struct vec3 plaster = {0.78, 0.70, 0.58};
static const struct vec3 terracotta = {0.60, 0.25, 0.13};
static const struct vec3 oak = {0.45, 0.27, 0.14};
static const struct vec3 bleached = {0.66, 0.60, 0.52};
static const struct vec3 iron = {0.10, 0.11, 0.12};
static const struct vec3 leaf = {0.15, 0.30, 0.08};
static const struct vec3 chalk = {0.82, 0.80, 0.76};
static const struct vec3 water = {0.10, 0.30, 0.33};

static double noise_at(int x, int y, int z)
{
    uint32_t h =
        trace_hash((uint32_t)x * 73856093u ^ (uint32_t)y * 19349663u ^ (uint32_t)z * 83492791u);
    return h * 0x1p-32;
}

/* Value noise in [0,1], smooth, one cell per unit. */
static double noise(struct vec3 p)
{
    double fx = floor(p.x), fy = floor(p.y), fz = floor(p.z);
    int x = (int)fx, y = (int)fy, z = (int)fz;
    double u = p.x - fx, v = p.y - fy, w = p.z - fz;
    u *= u * (3 - 2 * u), v *= v * (3 - 2 * v), w *= w * (3 - 2 * w);
    double sum = 0;
    for (int i = 0; i < 8; i++) {
        int dx = i & 1, dy = i >> 1 & 1, dz = i >> 2;
        sum += (dx ? u : 1 - u) * (dy ? v : 1 - v) * (dz ? w : 1 - w) *
               noise_at(x + dx, y + dy, z + dz);
    }
    return sum;
}

static struct vec3 surface_colour(const struct trace_scene *scene, const struct trace_hit *hit)
{
    const struct trace_primitive *p = &scene->primitives[hit->primitive];
    struct vec3 at = hit->local, size = p->size;
    double own = trace_hash((uint32_t)hit->primitive + 7u) * 0x1p-32;
    switch (p->pattern) {
    case PATTERN_LOCAL:
        return vec3(0.40 + 0.33 * at.x / size.x, 0.40 + 0.33 * at.y / size.y,
                    0.40 + 0.33 * at.z / size.z);
    case PATTERN_STONE:
        return scale(p->albedo,
                     0.80 + 0.24 * own + 0.14 * noise(add(scale(at, 2), vec3(own * 99, 0, 0))));
    case PATTERN_PLASTER:
        return scale(p->albedo, 0.86 + 0.12 * noise(scale(hit->position, 0.9)));
    case PATTERN_WOOD: {
        struct vec3 grain = size.x > size.y && size.x > size.z ? vec3(1.5, 28, 28)
                            : size.y > size.z                  ? vec3(28, 1.5, 28)
                                                               : vec3(28, 28, 1.5);
        return scale(p->albedo,
                     0.78 + 0.22 * own + 0.22 * noise(add(mul(at, grain), vec3(own * 99, 0, 0))));
    }
    default:
        return p->albedo;
    }
}

/* --- a small vocabulary --- */

static void put(struct trace_scene *scene, struct trace_primitive p, struct vec3 colour,
                enum pattern pattern)
{
    p.albedo = colour;
    p.pattern = (int)pattern;
    trace_add(scene, p);
}

/* A box given by its low and high corners. */
static void block(struct trace_scene *scene, struct vec3 low, struct vec3 high, struct vec3 colour,
                  enum pattern pattern)
{
    put(scene, trace_box(scale(add(low, high), 0.5), scale(sub(high, low), 0.5)), colour, pattern);
}

static void turned_box(struct trace_scene *scene, struct vec3 center, struct vec3 half,
                       struct mat3 axes, struct vec3 colour, enum pattern pattern)
{
    struct trace_primitive p = trace_box(center, half);
    p.axes = axes;
    put(scene, p, colour, pattern);
}

static void rod(struct trace_scene *scene, struct vec3 a, struct vec3 b, double radius,
                struct vec3 colour)
{
    put(scene, trace_cylinder(a, b, radius), colour, PATTERN_PLAIN);
}

/* A wall from low to high with a round-headed opening of the given half width, whose head begins at
 * y = spring. */
static void arch(struct trace_scene *scene, struct vec3 low, struct vec3 high, double spring,
                 double half_width)
{
    struct vec3 half = scale(sub(high, low), 0.5);
    half.y = (high.y - spring) / 2;
    struct trace_primitive p =
        trace_box(vec3((low.x + high.x) / 2, spring + half.y, (low.z + high.z) / 2), half);
    p.kind = TRACE_BORED_BOX;
    p.bore = half_width;
    p.bore_y = -half.y;
    put(scene, p, plaster, PATTERN_PLASTER);
    double pier = half.x - half_width;
    if (spring > low.y && pier > 0) {
        block(scene, low, vec3(low.x + pier, spring, high.z), plaster, PATTERN_PLASTER);
        block(scene, vec3(high.x - pier, low.y, low.z), vec3(high.x, spring, high.z), plaster,
              PATTERN_PLASTER);
    }
}

static void tub(struct trace_scene *scene, struct vec3 foot, double radius, double height,
                double wall, struct vec3 colour)
{
    struct trace_primitive p = trace_cylinder(foot, vec3(foot.x, foot.y + height, foot.z), radius);
    p.kind = TRACE_BORED_CYLINDER;
    p.bore = radius - wall;
    put(scene, p, colour, PATTERN_STONE);
}

/* Leaves: small spheres spread evenly (Fibonacci) over a ball. */
static void topiary(struct trace_scene *scene, struct vec3 center, double radius, int leaves,
                    double leaf_radius)
{
    put(scene, trace_sphere(center, radius * 0.9), scale(leaf, 0.7), PATTERN_PLAIN);
    for (int i = 0; i < leaves; i++) {
        double y = 1 - (2 * i + 1.0) / leaves, r = sqrt(1 - y * y), phi = i * 2.399963229728653;
        double push = radius * (0.94 + 0.12 * noise_at(i, 3, 5));
        struct vec3 at = mad(vec3(r * cos(phi), y, r * sin(phi)), push, center);
        put(scene, trace_sphere(at, leaf_radius * (0.8 + 0.4 * noise_at(i, 8, 1))),
            scale(leaf, 0.75 + 0.6 * noise_at(i, 1, 9)), PATTERN_PLAIN);
    }
}

/* --- the courtyard, part by part --- */

static void add_ground(struct trace_scene *scene)
{
    put(scene, trace_plane(vec3(0, -0.05, 0), vec3(0, 1, 0)), scale(paving, 0.8), PATTERN_PLAIN);
    for (int row = 0; row < 13; row++) {
        double shift = row % 2 ? 0.42 : 0.0;
        for (int column = 0; column < 15; column++) {
            double x = -6.6 + column * 0.84 + shift, z = -3.6 + row * 0.84;
            double top = -0.018 * noise_at(column, 11, row);
            block(scene, vec3(x, -0.05, z), vec3(x + 0.80, top, z + 0.80), paving, PATTERN_STONE);
        }
    }
}

static void add_column(struct trace_scene *scene, double x, double z)
{
    block(scene, vec3(x - 0.30, 0, z - 0.30), vec3(x + 0.30, 0.16, z + 0.30), sandstone,
          PATTERN_STONE);
    put(scene, trace_cylinder(vec3(x, 0.16, z), vec3(x, 0.26, z), 0.27), sandstone, PATTERN_STONE);
    put(scene, trace_cylinder(vec3(x, 0.26, z), vec3(x, 2.12, z), 0.19), sandstone, PATTERN_STONE);
    put(scene, trace_cylinder(vec3(x, 2.04, z), vec3(x, 2.10, z), 0.23), sandstone, PATTERN_STONE);
    put(scene, trace_cylinder(vec3(x, 2.12, z), vec3(x, 2.20, z), 0.27), sandstone, PATTERN_STONE);
    block(scene, vec3(x - 0.32, 2.20, z - 0.32), vec3(x + 0.32, 2.35, z + 0.32), sandstone,
          PATTERN_STONE);
}

static void add_arcade(struct trace_scene *scene)
{
    for (int i = 0; i < 6; i++) {
        double x = -6.0 + 2.2 * i;
        add_column(scene, x, -3.4);
        arch(scene, vec3(x, 2.35, -3.7), vec3(x + 2.2, 3.85, -3.1), 2.35, 0.86);
        block(scene, vec3(x + 0.99, 3.14, -3.72), vec3(x + 1.21, 3.58, -3.04), sandstone,
              PATTERN_STONE);
    }
    block(scene, vec3(-8.2, 3.85, -3.72), vec3(8.2, 3.97, -3.00), sandstone, PATTERN_STONE);
    block(scene, vec3(-8.2, 3.97, -3.70), vec3(8.2, 4.20, -3.10), plaster, PATTERN_PLASTER);
    block(scene, vec3(-8.2, 4.20, -3.75), vec3(8.2, 4.32, -2.94), sandstone, PATTERN_STONE);
    block(scene, vec3(-8.2, 0, -6.2), vec3(8.2, 5.0, -5.9), plaster, PATTERN_PLASTER);
    block(scene, vec3(-8.2, 3.9, -5.9), vec3(8.2, 4.0, -3.7), bleached, PATTERN_PLAIN);
    block(scene, vec3(-8.2, -0.05, -5.9), vec3(8.2, 0.02, -3.62), paving, PATTERN_PLAIN);
    for (int i = 0; i < 11; i++) {
        double x = -5.6 + 1.1 * i;
        block(scene, vec3(x, 3.74, -5.9), vec3(x + 0.16, 3.92, -3.7), oak, PATTERN_WOOD);
    }
    /* A roof of round tiles, ridge away from the court. */
    for (int i = 0; i < 62; i++) {
        double x = -8.0 + 0.26 * i;
        rod(scene, vec3(x, 4.38, -2.78), vec3(x, 5.20, -5.2), 0.115,
            scale(terracotta, 0.8 + 0.45 * noise_at(i, 2, 2)));
    }
    turned_box(scene, vec3(0, 4.72, -4.0), vec3(8.2, 0.03, 1.3), mat3_turned(0, 0.327, 0),
               scale(terracotta, 0.6), PATTERN_PLAIN);
}

/* Up to a landing on the left, with an iron railing. */
static void add_stairs(struct trace_scene *scene)
{
    const double rise = 0.17, tread = 0.31, z0 = -2.7, z1 = -0.9;
    for (int i = 0; i < 7; i++) {
        double x = -2.35 - tread * i;
        block(scene, vec3(-6.6, rise * i, z0), vec3(x, rise * (i + 1) - 0.002, z1), plaster,
              PATTERN_PLASTER);
        block(scene, vec3(-6.6, rise * (i + 1) - 0.045, z0),
              vec3(x + 0.035, rise * (i + 1), z1 + 0.04), sandstone, PATTERN_STONE);
        rod(scene, vec3(x - 0.15, rise * (i + 1), z1 - 0.08),
            vec3(x - 0.15, rise * (i + 1) + 0.92, z1 - 0.08), 0.014, iron);
    }
    block(scene, vec3(-6.6, 1.145, z0), vec3(-4.50, 1.19, z1 + 0.04), sandstone, PATTERN_STONE);
    rod(scene, vec3(-2.30, 0.0, z1 - 0.08), vec3(-2.30, 1.04, z1 - 0.08), 0.025, iron);
    put(scene, trace_sphere(vec3(-2.30, 1.08, z1 - 0.08), 0.05), iron, PATTERN_PLAIN);
    rod(scene, vec3(-2.30, 0.98, z1 - 0.08), vec3(-4.47, 2.13, z1 - 0.08), 0.024, iron);
    rod(scene, vec3(-4.47, 2.13, z1 - 0.08), vec3(-6.6, 2.13, z1 - 0.08), 0.024, iron);
    for (int i = 0; i < 14; i++) {
        double x = -4.60 - 0.14 * i;
        rod(scene, vec3(x, 1.19, z1 - 0.08), vec3(x, 2.13, z1 - 0.08), 0.014, iron);
    }
    block(scene, vec3(-6.9, 0, -3.1), vec3(-6.4, 4.3, 8), plaster, PATTERN_PLASTER);
    /* A doorway off the landing: jambs, lintel and planks. */
    block(scene, vec3(-6.42, 1.19, -2.45), vec3(-6.33, 3.05, -1.25), oak, PATTERN_WOOD);
    block(scene, vec3(-6.42, 1.19, -2.60), vec3(-6.26, 3.05, -2.45), sandstone, PATTERN_STONE);
    block(scene, vec3(-6.42, 1.19, -1.25), vec3(-6.26, 3.05, -1.10), sandstone, PATTERN_STONE);
    block(scene, vec3(-6.42, 3.05, -2.68), vec3(-6.22, 3.25, -1.02), sandstone, PATTERN_STONE);
}

static void add_fountain(struct trace_scene *scene)
{
    const struct vec3 c = {0.55, 0, -0.95};
    put(scene, trace_cylinder(c, vec3(c.x, 0.10, c.z), 1.22), sandstone, PATTERN_STONE);
    tub(scene, vec3(c.x, 0.10, c.z), 1.02, 0.42, 0.13, sandstone);
    tub(scene, vec3(c.x, 0.52, c.z), 1.07, 0.07, 0.21, sandstone);
    put(scene, trace_disk(vec3(c.x, 0.40, c.z), vec3(0, 1, 0), 0.95), water, PATTERN_PLAIN);
    put(scene, trace_cylinder(vec3(c.x, 0.1, c.z), vec3(c.x, 0.60, c.z), 0.24), sandstone,
        PATTERN_STONE);
    put(scene, trace_cylinder(vec3(c.x, 0.60, c.z), vec3(c.x, 0.68, c.z), 0.32), sandstone,
        PATTERN_STONE);
    put(scene, trace_cylinder(vec3(c.x, 0.68, c.z), vec3(c.x, 1.25, c.z), 0.10), sandstone,
        PATTERN_STONE);
    put(scene, trace_cylinder(vec3(c.x, 1.25, c.z), vec3(c.x, 1.31, c.z), 0.20), sandstone,
        PATTERN_STONE);
    tub(scene, vec3(c.x, 1.31, c.z), 0.46, 0.13, 0.06, sandstone);
    put(scene, trace_cylinder(vec3(c.x, 1.31, c.z), vec3(c.x, 1.37, c.z), 0.43), water,
        PATTERN_PLAIN);
    put(scene, trace_sphere(vec3(c.x, 1.55, c.z), 0.19), chalk, PATTERN_PLAIN);
}

static void add_bench(struct trace_scene *scene, struct vec3 at, double yaw)
{
    struct mat3 axes = mat3_turned(yaw, 0, 0);
    struct mat3 back = mat3_turned(yaw, 0.22, 0);
    for (int i = 0; i < 5; i++) {
        struct vec3 slat = vec3(0, 0.45, -0.20 + 0.10 * i);
        turned_box(scene, add(at, mul_transposed(axes, slat)), vec3(0.95, 0.018, 0.037), axes, oak,
                   PATTERN_WOOD);
    }
    for (int i = 0; i < 4; i++) {
        struct vec3 slat = vec3(0, 0.56 + 0.125 * i, -0.28 - 0.028 * i);
        turned_box(scene, add(at, mul_transposed(axes, slat)), vec3(0.95, 0.042, 0.016), back, oak,
                   PATTERN_WOOD);
    }
    for (int side = -1; side <= 1; side += 2) {
        double x = 0.78 * side;
        turned_box(scene, add(at, mul_transposed(axes, vec3(x, 0.215, 0.18))),
                   vec3(0.03, 0.215, 0.03), axes, iron, PATTERN_PLAIN);
        turned_box(scene, add(at, mul_transposed(axes, vec3(x, 0.215, -0.22))),
                   vec3(0.03, 0.215, 0.03), axes, iron, PATTERN_PLAIN);
        turned_box(scene, add(at, mul_transposed(axes, vec3(x, 0.415, -0.01))),
                   vec3(0.03, 0.017, 0.25), axes, iron, PATTERN_PLAIN);
        turned_box(scene, add(at, mul_transposed(axes, vec3(x, 0.72, -0.345))),
                   vec3(0.025, 0.30, 0.014), back, iron, PATTERN_PLAIN);
    }
}

static void add_fence(struct trace_scene *scene)
{
    const double x = 4.75;
    for (int i = 0; i < 33; i++) {
        double z = -3.0 + 0.2 * i;
        double height = 1.18 + 0.05 * noise_at(i, 6, 6);
        block(scene, vec3(x, 0.08, z), vec3(x + 0.03, height, z + 0.115), bleached, PATTERN_WOOD);
    }
    block(scene, vec3(x + 0.03, 0.30, -3.1), vec3(x + 0.07, 0.40, 4), bleached, PATTERN_WOOD);
    block(scene, vec3(x + 0.03, 0.88, -3.1), vec3(x + 0.07, 0.98, 4), bleached, PATTERN_WOOD);
}

/* Foreground: cubes coloured by their own coordinates, and balls of chalk. */
static void add_cubes(struct trace_scene *scene)
{
    const double h = 0.34;
    const struct vec3 half = {h, h, h};
    turned_box(scene, vec3(-2.10, h, 1.00), half, mat3_turned(0.35, 0, 0), chalk, PATTERN_LOCAL);
    turned_box(scene, vec3(-1.28, h, 0.57), half, mat3_turned(-0.30, 0, 0), chalk, PATTERN_LOCAL);
    turned_box(scene, vec3(-1.74, 3 * h, 0.77), half, mat3_turned(0.80, 0, 0), chalk,
               PATTERN_LOCAL);
    turned_box(scene, vec3(-0.88, 0.434, 1.27), half, mat3_turned(0.55, 0.35, 0), chalk,
               PATTERN_LOCAL);
    put(scene, trace_sphere(vec3(-2.68, 0.26, 1.53), 0.26), chalk, PATTERN_PLAIN);
    put(scene, trace_sphere(vec3(-1.95, 0.15, 1.77), 0.15), chalk, PATTERN_PLAIN);
    put(scene, trace_sphere(vec3(-0.18, 0.19, 0.97), 0.19), terracotta, PATTERN_PLAIN);
}

static void add_crate(struct trace_scene *scene, struct vec3 at, double half, double yaw)
{
    struct mat3 axes = mat3_turned(yaw, 0, 0);
    turned_box(scene, at, vec3(half * 0.93, half * 0.93, half * 0.93), axes, scale(oak, 0.8),
               PATTERN_WOOD);
    for (int i = 0; i < 4; i++) {
        double y = half * (-0.77 + 0.513 * i);
        for (int side = -1; side <= 1; side += 2) {
            double off = half * 0.96 * side;
            turned_box(scene, add(at, mul_transposed(axes, vec3(0, y, off))),
                       vec3(half, half * 0.21, half * 0.04), axes, bleached, PATTERN_WOOD);
            turned_box(scene, add(at, mul_transposed(axes, vec3(off, y, 0))),
                       vec3(half * 0.04, half * 0.21, half), axes, bleached, PATTERN_WOOD);
        }
        turned_box(scene, add(at, mul_transposed(axes, vec3(0, half * 0.96, y))),
                   vec3(half, half * 0.04, half * 0.21), axes, bleached, PATTERN_WOOD);
    }
}

static void add_barrel(struct trace_scene *scene, struct vec3 foot)
{
    put(scene, trace_cylinder(foot, add(foot, vec3(0, 0.86, 0)), 0.31), oak, PATTERN_WOOD);
    tub(scene, add(foot, vec3(0, 0.80, 0)), 0.325, 0.10, 0.03, scale(oak, 0.9));
    for (int i = 0; i < 3; i++) {
        struct vec3 hoop = add(foot, vec3(0, 0.08 + 0.34 * i, 0));
        put(scene, trace_cylinder(hoop, add(hoop, vec3(0, 0.045, 0)), 0.328), iron, PATTERN_PLAIN);
    }
}

static void add_clutter(struct trace_scene *scene)
{
    add_barrel(scene, vec3(3.95, 0, -2.55));
    add_barrel(scene, vec3(3.22, 0, -2.62));
    add_crate(scene, vec3(4.22, 0.30, -1.70), 0.30, 0.2);
    add_crate(scene, vec3(4.20, 0.84, -1.74), 0.24, -0.35);
    /* A ladder against the arcade, rungs and all. */
    for (int side = 0; side < 2; side++) {
        double x = 2.08 + 0.44 * side;
        rod(scene, vec3(x, 0, -2.15), vec3(x, 3.45, -3.02), 0.03, bleached);
    }
    for (int i = 1; i < 11; i++)
        rod(scene, vec3(2.08, 0.31 * i, -2.15 - 0.0782 * i),
            vec3(2.52, 0.31 * i, -2.15 - 0.0782 * i), 0.018, bleached);
    /* Potted topiary on both sides of the steps, and one by the bench. */
    tub(scene, vec3(-1.72, 0, -2.30), 0.28, 0.40, 0.05, terracotta);
    topiary(scene, vec3(-1.72, 0.80, -2.30), 0.46, 210, 0.060);
    tub(scene, vec3(2.72, 0, 0.85), 0.22, 0.30, 0.04, terracotta);
    topiary(scene, vec3(2.72, 0.58, 0.85), 0.31, 150, 0.050);
    put(scene, trace_sphere(vec3(-2.0, 0.12, -0.45), 0.12), chalk, PATTERN_PLAIN);
    put(scene, trace_sphere(vec3(-2.32, 0.09, -0.62), 0.09), terracotta, PATTERN_PLAIN);
    /* Planks that were left leaning under the landing. */
    for (int i = 0; i < 3; i++)
        turned_box(scene, vec3(-4.3 - 0.30 * i, 0.56, -0.60 - 0.03 * i), vec3(0.11, 0.62, 0.02),
                   mat3_turned(0, -0.42, 0.06 * i), bleached, PATTERN_WOOD);
    tub(scene, vec3(-5.55, 0, 0.1), 0.26, 0.36, 0.05, terracotta);
    topiary(scene, vec3(-5.55, 0.66, 0.1), 0.36, 150, 0.055);
}

void courtyard_add(struct trace_scene *scene)
{
    scene->albedo = surface_colour;
    add_ground(scene);
    add_arcade(scene);
    add_stairs(scene);
    add_fountain(scene);
    add_fence(scene);
    add_bench(scene, vec3(3.55, 0, 1.35), -PI / 2 + 0.18);
    add_cubes(scene);
    add_clutter(scene);
}

struct trace_camera courtyard_camera(void)
{
    struct trace_camera camera = {.fov_x_deg = 56.0, .near = 0.1, .far = 100.0};
    trace_camera_look_at(&camera, vec3(0.15, 2.75, 8.6), vec3(0.15, 1.90, -1.2));
    return camera;
}
