/* SPDX-License-Identifier: MIT */
#include "light.h"

enum { DIMENSIONS = 6, MAX_BOUNCES = 5 };

static const struct vec3 sun_direction = {0.7176, 0.5126, 0.4716}; /* unit, towards the sun */
static const struct vec3 sun_light = {1.12, 0.83, 0.53};           /* irradiance / pi, face on */
static const double sun_radius = 0.022; /* radians; the real one has 0.0047 */

/* Random numbers: the first six of every path from Roberts' R6 sequence, later ones from a hash. */
struct sampler {
    double shift[DIMENSIONS];
    uint32_t seed, drawn;
    int index;
};

static double draw(struct sampler *s)
{
    /* 1/g, 1/g^2 ... with g the root of g^7 = g + 1. */
    static const double step[DIMENSIONS] = {0.8986537126286993, 0.8075784952213448,
                                            0.7257334129697599, 0.6521830259439717,
                                            0.5860866975779695, 0.5266889867007359};
    uint32_t k = s->drawn++;
    if (k < DIMENSIONS) {
        double x = s->shift[k] + s->index * step[k];
        return x - floor(x);
    }
    return trace_hash(s->seed ^ trace_hash((uint32_t)s->index * 64u + k)) * 0x1p-32;
}

static struct vec3 sky(struct vec3 d)
{
    static const struct vec3 zenith = {0.12, 0.23, 0.50}, horizon = {0.40, 0.46, 0.54},
                             glow = {0.60, 0.38, 0.18};
    double up = d.y > 0 ? d.y : 0;
    double towards = fmax(0, dot(d, sun_direction));
    return mad(glow, 0.5 * pow(towards, 24), mix3(horizon, zenith, pow(up, 0.55)));
}

/* What an unobstructed sky above a sunlit court sends to a surface facing n. */
static struct vec3 open_sky(struct vec3 n)
{
    static const struct vec3 above = {0.29, 0.34, 0.43}, below = {0.25, 0.20, 0.14};
    return mix3(below, above, 0.5 + 0.5 * n.y);
}

static struct vec3 sun_on(const struct trace_scene *scene, struct vec3 position, struct vec3 n,
                          struct sampler *s)
{
    double r = sun_radius * sqrt(draw(s)), phi = 2 * PI * draw(s);
    struct mat3 frame = mat3_around(sun_direction);
    struct vec3 d = normalize(mul_transposed(frame, vec3(r * cos(phi), 1, r * sin(phi))));
    double cosine = dot(n, d);
    if (cosine <= 0 || trace_any(scene, position, d, 0, INFINITY))
        return vec3(0, 0, 0);
    return scale(sun_light, cosine);
}

static struct vec3 radiance(const struct trace_scene *scene, struct trace_ray ray,
                            struct trace_hit hit, enum light_mode mode, struct sampler *s)
{
    struct vec3 sum = {0, 0, 0}, weight = {1, 1, 1}, d = ray.direction;
    for (int bounce = 0;; bounce++) {
        struct vec3 n = trace_facing(&hit, d);
        struct vec3 origin = mad(n, 1e-7, hit.position);
        weight = mul(weight, trace_albedo(scene, &hit));
        sum = add(sum, mul(weight, sun_on(scene, origin, n, s)));
        if (mode == LIGHT_FLAT)
            return add(sum, mul(weight, open_sky(n)));
        if (bounce == MAX_BOUNCES)
            return sum;
        double u = draw(s), v = draw(s);
        d = trace_cosine(n, u, v);
        if (!trace_closest(scene, origin, d, 0, INFINITY, &hit))
            return add(sum, mul(weight, sky(d)));
    }
}

struct vec3 light_texel(const struct trace_scene *scene, const struct trace_camera *camera,
                        enum light_mode mode, int column, int row, int width, int height,
                        int samples)
{
    struct sampler s = {.seed = trace_hash((uint32_t)(row * width + column))};
    for (int k = 0; k < DIMENSIONS; k++)
        s.shift[k] = trace_hash(s.seed + (uint32_t)k) * 0x1p-32;
    struct vec3 sum = {0, 0, 0};
    for (s.index = 0; s.index < samples; s.index++) {
        s.drawn = 0;
        double x = column + draw(&s), y = row + draw(&s);
        struct trace_hit hit;
        struct trace_ray ray;
        bool seen = trace_primary(scene, camera, x, y, width, height, &hit, &ray);
        sum = add(sum, seen ? radiance(scene, ray, hit, mode, &s) : sky(ray.direction));
    }
    return scale(sum, 1.0 / samples);
}
