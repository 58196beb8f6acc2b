/* SPDX-License-Identifier: MIT */
#include "flicker.h"

#include "camera.h"
#include "vec3.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double depth_tolerance = 0.01, normal_cosine = 0.98480775301220806; /* 10 degrees */

/* In the world. */
struct track_point {
    struct vec3 position, normal;
};

/* Welford's: the mean, and the sum of squared differences from it. */
struct track_moments {
    float mean, squares;
};

/* --- A frame as a picture of the world --- */

struct picture {
    const struct scene *scene;
    bool is_parallel;
    struct mat3 to_view;
    struct vec3 translation;
    double x, y, step_x, step_y; /* where texels look: at 0, 0, and from one to the next */
};

static struct picture picture_of(const struct scene *scene)
{
    const struct gbuffer *g = &scene->gbuffer;
    const double *m = g->camera.world_to_view, *t = g->camera.translation;
    double x, y;
    struct picture p = {
        .scene = scene,
        .is_parallel = g->camera.type == CAMERA_ORTHOGRAPHIC,
        .to_view = {vec3(m[0], m[1], m[2]), vec3(m[3], m[4], m[5]), vec3(m[6], m[7], m[8])},
        .translation = vec3(t[0], t[1], t[2])};
    camera_ray(&g->camera, &g->display_window, &g->data_window, 0, 0, &p.x, &p.y);
    camera_ray(&g->camera, &g->display_window, &g->data_window, 1, 1, &x, &y);
    p.step_x = x - p.x;
    p.step_y = y - p.y;
    return p;
}

/* In view space, of a length that is 1 along the axis. */
struct sight {
    struct vec3 origin, direction;
};

static struct sight sight_of(const struct picture *p, size_t texel)
{
    const uint32_t width = p->scene->gbuffer.width;
    const double x = p->x + p->step_x * (double)(texel % width);
    const double y = p->y + p->step_y * (double)(texel / width);
    if (p->is_parallel)
        return (struct sight){vec3(x, y, 0), vec3(0, 0, -1)};
    return (struct sight){vec3(0, 0, 0), vec3(x, y, -1)};
}

/* Where the padded images of the scene have a texel. */
static size_t padded(const struct scene *scene, size_t texel)
{
    const size_t width = scene->gbuffer.width, row = texel / width + scene->placement.top;
    return row * (width + scene->placement.left) + texel % width + scene->placement.left;
}

static double depth_at(const struct picture *p, size_t texel)
{
    const struct gbuffer *g = &p->scene->gbuffer;
    return gbuffer_view_z(g, g->depth[padded(p->scene, texel)], texel);
}

/* In view space, of any length. */
static struct vec3 normal_at(const struct picture *p, size_t texel)
{
    const float *n = p->scene->gbuffer.normals + padded(p->scene, texel) * 4;
    const float *m = p->scene->gbuffer.view.normal_to_view;
    double v[3];
    for (int row = 0; row < 3; row++)
        v[row] = (double)m[row] * (double)n[0] + (double)m[3 + row] * (double)n[1] +
                 (double)m[6 + row] * (double)n[2];
    return vec3(v[0], v[1], v[2]);
}

/* --- Points --- */

static struct track_point point_at(const struct picture *p, size_t texel)
{
    const struct sight s = sight_of(p, texel);
    const struct vec3 in_view = mad(s.direction, depth_at(p, texel), s.origin);
    return (struct track_point){
        .position = mul_transposed(p->to_view, sub(in_view, p->translation)),
        .normal = mul_transposed(p->to_view, normal_at(p, texel)),
    };
}

static bool start(struct flicker *f, const struct picture *p, struct tool_error *err)
{
    const struct scene *scene = p->scene;
    const struct gbuffer *g = &scene->gbuffer;
    const size_t texels = (size_t)g->width * g->height;
    snprintf(f->first, sizeof f->first, "%s", scene->name);
    f->width = g->view.viewport.extent.width;
    f->height = g->view.viewport.extent.height;
    f->points = malloc(texels * sizeof *f->points);
    f->texels = malloc(texels * sizeof *f->texels);
    f->seen = calloc(texels, sizeof *f->seen);
    if (!f->points || !f->texels || !f->seen)
        return fail(err, EXIT_MEMORY, "%s: out of memory for %zu points", scene->name, texels);
    for (size_t i = 0; i < texels; i++)
        if (scene->foreground[i])
            f->points[f->count++] = point_at(p, i);
    return true;
}

/* Whether the texel shows a point that is at `at` in view space: the depth at its own centre may
 * be another one, by as much as the tangent plane says. */
static bool shows(const struct picture *p, size_t texel, struct vec3 at, struct vec3 normal)
{
    const struct vec3 own = normal_at(p, texel);
    const struct sight s = sight_of(p, texel);
    const double z = -at.z, found = depth_at(p, texel), slope = dot(s.direction, normal);
    const double plane = dot(sub(at, s.origin), normal) / (fabs(slope) < 1e-6 ? 1e-6 : slope);
    return (fabs(found - z) < depth_tolerance * z || fabs(found - plane) < depth_tolerance * z) &&
           dot(own, normal) > normal_cosine * length(own) * length(normal);
}

/* SIZE_MAX if the point is not seen. */
static size_t find(const struct picture *p, const struct track_point *point)
{
    const struct gbuffer *g = &p->scene->gbuffer;
    const struct vec3 at = add(mul_mat(p->to_view, point->position), p->translation);
    const double scale = p->is_parallel ? 1.0 : -at.z;
    if (!(at.z < 0))
        return SIZE_MAX;
    const double column = rint((at.x / scale - p->x) / p->step_x);
    const double row = rint((at.y / scale - p->y) / p->step_y);
    if (!(column >= 0 && column < g->width && row >= 0 && row < g->height))
        return SIZE_MAX;
    const size_t texel = (size_t)row * g->width + (size_t)column;
    return p->scene->foreground[texel] && shows(p, texel, at, mul_mat(p->to_view, point->normal))
               ? texel
               : SIZE_MAX;
}

/* --- Frames --- */

static bool check(const struct flicker *f, const struct scene *scene, struct tool_error *err)
{
    const struct gbuffer *g = &scene->gbuffer;
    const VkExtent2D size = g->view.viewport.extent;
    if (!g->camera.has_translation)
        return fail(err, EXIT_INPUT,
                    "%s/%s.camera.json: no 'world_to_view', which a sequence needs", scene->folder,
                    scene->name);
    if (!g->normals)
        return fail(err, EXIT_INPUT, "%s/%s.exr: no normals, which a sequence needs", scene->folder,
                    scene->name);
    if (f->frames > 0 && (size.width != f->width || size.height != f->height))
        return fail(err, EXIT_INPUT, "%s/%s.exr: %u x %u texels, want %u x %u as %s.exr has",
                    scene->folder, scene->name, size.width, size.height, f->width, f->height,
                    f->first);
    return true;
}

bool flicker_track(struct flicker *f, const struct scene *scene, struct tool_error *err)
{
    const struct picture picture = picture_of(scene);
    if (!check(f, scene, err) || (f->frames == 0 && !start(f, &picture, err)))
        return false;
    f->frames++;
    for (size_t i = 0; i < f->count; i++) {
        f->texels[i] = find(&picture, &f->points[i]);
        f->seen[i] += f->texels[i] != SIZE_MAX;
    }
    return true;
}

/* --- Errors --- */

bool flicker_add(struct flicker *f, size_t slot, const struct image_pair *pair,
                 struct tool_error *err)
{
    if (!f->slots[slot])
        f->slots[slot] = calloc(f->count ? f->count : 1, sizeof *f->slots[slot]);
    if (!f->slots[slot])
        return fail(err, EXIT_MEMORY, "out of memory for %zu points", f->count);
    for (size_t i = 0; i < f->count; i++) {
        struct track_moments *m = &f->slots[slot][i];
        if (f->texels[i] == SIZE_MAX)
            continue;
        const double error = metrics_error(pair, f->texels[i]);
        const double before = error - (double)m->mean;
        const double mean = (double)m->mean + before / f->seen[i];
        m->squares = (float)((double)m->squares + before * (error - mean));
        m->mean = (float)mean;
    }
    return true;
}

static bool counts(const struct flicker *f, size_t point)
{
    return f->seen[point] >= 3 && f->seen[point] * 2 >= f->frames;
}

double flicker_of(const struct flicker *f, size_t slot)
{
    double sum = 0;
    size_t counted = 0;
    for (size_t i = 0; f->slots[slot] && i < f->count; i++) {
        if (!counts(f, i))
            continue;
        sum += (double)f->slots[slot][i].squares / (f->seen[i] - 1);
        counted++;
    }
    return counted ? sqrt(sum / (double)counted) : NAN;
}

double flicker_share(const struct flicker *f)
{
    size_t counted = 0;
    for (size_t i = 0; i < f->count; i++)
        counted += counts(f, i);
    return f->count ? (double)counted / (double)f->count : 0;
}

void flicker_free(struct flicker *f)
{
    for (size_t i = 0; i < FLICKER_SLOTS; i++)
        free(f->slots[i]);
    free(f->points);
    free(f->texels);
    free(f->seen);
    *f = (struct flicker){0};
}
