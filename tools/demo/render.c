/* SPDX-License-Identifier: MIT
 *
 * vkao-demo-render: draws the demo's courtyard as the G-buffer of a renderer that has no ambient
 * occlusion pass, with the camera in the header; and the ray-traced truth to compare with. */
#include "courtyard.h"
#include "error.h"
#include "exr_file.h"
#include "light.h"
#include "parallel.h"
#include "text.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BACKGROUND_Z 1e10f /* as Blender has it */

static const char usage[] =
    "Usage: vkao-demo-render OUT.exr [options]\n"
    "  --size WxH          default 640x360\n"
    "  --samples N         per texel of the picture, default 256\n"
    "  --beauty flat|path  sun and constant sky light (default), or path tracing\n"
    "  --bare              depth and normals alone, as floats and not rounded\n"
    "  --camera-json FILE  write the camera too, for vkao --camera\n"
    "  --truth FILE        write ray-traced AO_threshold and AO_falloff\n"
    "  --radius R          of the truth, scene units, default 0.5\n"
    "  --rays N            of the truth, per texel, default 1024\n";

struct settings {
    const char *output, *camera_json, *truth;
    int width, height, samples, rays;
    double radius;
    enum light_mode light;
    bool bare;
};

/* Planes of width * height; color, normal and albedo have three numbers per texel. */
struct picture {
    float *color, *normal, *albedo, *z, *alpha, *threshold, *falloff;
};

struct job {
    const struct settings *settings;
    const struct trace_scene *scene;
    struct trace_camera camera;
    struct picture picture;
};

/* --- command line --- */

static bool whole_number(const char *text, int *value)
{
    int64_t number;
    if (!text_to_integer(text, &number) || number < 1 || number > 65535)
        return false;
    *value = (int)number;
    return true;
}

static bool size_of_image(const char *text, struct settings *s)
{
    int end = 0;
    return sscanf(text, "%5dx%5d%n", &s->width, &s->height, &end) == 2 && !text[end] &&
           s->width > 0 && s->height > 0;
}

static bool option(const char *name, const char *value, struct settings *s)
{
    if (!strcmp(name, "--size"))
        return size_of_image(value, s);
    if (!strcmp(name, "--samples"))
        return whole_number(value, &s->samples);
    if (!strcmp(name, "--rays"))
        return whole_number(value, &s->rays);
    if (!strcmp(name, "--radius"))
        return text_to_number(value, &s->radius) && s->radius > 0 && isfinite(s->radius);
    if (!strcmp(name, "--beauty")) {
        s->light = strcmp(value, "path") == 0 ? LIGHT_PATH : LIGHT_FLAT;
        return s->light == LIGHT_PATH || strcmp(value, "flat") == 0;
    }
    const char **file = !strcmp(name, "--camera-json") ? &s->camera_json
                        : !strcmp(name, "--truth")     ? &s->truth
                                                       : NULL;
    if (file)
        *file = value;
    return file;
}

static bool parse(int argc, char **argv, struct settings *s, struct tool_error *err)
{
    for (int i = 1; i < argc; i++) {
        if (!strcmp(argv[i], "--bare")) {
            s->bare = true;
        } else if (argv[i][0] == '-') {
            const char *value = i + 1 < argc ? argv[i + 1] : "";
            if (!option(argv[i], value, s))
                return fail(err, EXIT_USAGE, "what is '%s %s'?", argv[i], value);
            i++;
        } else if (s->output) {
            return fail(err, EXIT_USAGE, "one output, please, not '%s' too", argv[i]);
        } else {
            s->output = argv[i];
        }
    }
    return s->output ? true : fail(err, EXIT_USAGE, "no output is named");
}

/* --- drawing --- */

static void store3(float *out, size_t texel, struct vec3 v)
{
    out[texel * 3] = (float)v.x;
    out[texel * 3 + 1] = (float)v.y;
    out[texel * 3 + 2] = (float)v.z;
}

/* A job of parallel_run. */
static void draw_row(void *data, uint32_t index)
{
    const struct job *job = data;
    const int row = (int)index;
    const struct settings *s = job->settings;
    const struct picture *p = &job->picture;
    struct trace_gbuffer gbuffer = {.z = p->z, .normal = p->normal, .albedo = p->albedo};
    trace_gbuffer(job->scene, &job->camera, s->width, s->height, row, row + 1, &gbuffer);
    if (s->truth)
        trace_ao_image(job->scene, &job->camera, s->width, s->height, row, row + 1, s->radius,
                       s->rays, p->threshold, p->falloff);
    for (int x = 0; x < s->width && !s->bare; x++) {
        size_t texel = (size_t)row * (size_t)s->width + (size_t)x;
        struct vec3 color = light_texel(job->scene, &job->camera, s->light, x, row, s->width,
                                        s->height, s->samples);
        store3(p->color, texel, color);
        p->alpha[texel] = 1.0f;
    }
}

static void picture_free(struct picture *p)
{
    free(p->color);
    free(p->normal);
    free(p->albedo);
    free(p->z);
    free(p->alpha);
    free(p->threshold);
    free(p->falloff);
}

static bool picture_allocate(struct picture *p, size_t texels)
{
    p->color = calloc(texels, 3 * sizeof(float));
    p->normal = calloc(texels, 3 * sizeof(float));
    p->albedo = calloc(texels, 3 * sizeof(float));
    p->z = calloc(texels, sizeof(float));
    p->alpha = calloc(texels, sizeof(float));
    p->threshold = calloc(texels, sizeof(float));
    p->falloff = calloc(texels, sizeof(float));
    return p->color && p->normal && p->albedo && p->z && p->alpha && p->threshold && p->falloff;
}

/* --- writing --- */

/* Finer steps do not compress, and nobody sees them: a relative 2^-17 of depth and 0.06 degrees. */
static void round_gbuffer(float *z, float *normal, size_t texels)
{
    for (size_t i = 0; i < texels; i++) {
        int exponent;
        float mantissa = frexpf(z[i], &exponent);
        z[i] = ldexpf(roundf(ldexpf(mantissa, 16)), exponent - 16);
    }
    for (size_t i = 0; i < 3 * texels; i++)
        normal[i] = roundf(normal[i] * 512.0f) / 512.0f;
}

static struct exr_new_part new_part(const struct settings *s, const char *name)
{
    struct exr_box window = {0, 0, s->width - 1, s->height - 1};
    return (struct exr_new_part){
        .name = name, .data_window = window, .display_window = window, .pixel_aspect = 1.0f};
}

static bool write_picture(const struct job *job, struct tool_error *err)
{
    const struct settings *s = job->settings;
    const struct picture *p = &job->picture;
    struct exr_matrix matrices[2] = {{.name = "worldToCamera"}, {.name = "worldToNDC"}};
    trace_camera_exr_matrices(&job->camera, s->width, s->height, matrices[0].m, matrices[1].m);
    const struct exr_write beauty[] = {
        {"R", EXR_HALF, p->color, 3},
        {"G", EXR_HALF, p->color + 1, 3},
        {"B", EXR_HALF, p->color + 2, 3},
        {"A", EXR_HALF, p->alpha, 1},
        {"albedo.R", EXR_HALF, p->albedo, 3},
        {"albedo.G", EXR_HALF, p->albedo + 1, 3},
        {"albedo.B", EXR_HALF, p->albedo + 2, 3},
    };
    const enum exr_pixel_type normal_type = s->bare ? EXR_FLOAT : EXR_HALF;
    const struct exr_write gbuffer[] = {
        {"Z", EXR_FLOAT, p->z, 1},
        {"N.X", normal_type, p->normal, 3},
        {"N.Y", normal_type, p->normal + 1, 3},
        {"N.Z", normal_type, p->normal + 2, 3},
    };
    struct exr_new_part parts[2] = {new_part(s, "beauty"), new_part(s, "gbuffer")};
    parts[0].channels = beauty;
    parts[0].channel_count = sizeof beauty / sizeof *beauty;
    parts[0].compression = "dwab";
    parts[0].level = 300;
    parts[1].channels = gbuffer;
    parts[1].channel_count = sizeof gbuffer / sizeof *gbuffer;
    parts[1].compression = "zip";
    parts[1].level = 9;
    for (int i = 0; i < 2; i++) {
        parts[i].matrices = matrices;
        parts[i].matrix_count = 2;
    }
    return s->bare ? exr_write_file(s->output, NULL, &parts[1], 1, true, err)
                   : exr_write_file(s->output, NULL, parts, 2, true, err);
}

static bool write_truth(const struct job *job, struct tool_error *err)
{
    const struct settings *s = job->settings;
    const struct exr_write channels[] = {
        {"AO_falloff", EXR_FLOAT, job->picture.falloff, 1},
        {"AO_threshold", EXR_FLOAT, job->picture.threshold, 1},
    };
    char radius[32], rays[32];
    snprintf(radius, sizeof radius, "%g", s->radius);
    snprintf(rays, sizeof rays, "%d", s->rays);
    const struct exr_string strings[] = {{"aoRadius", radius}, {"aoSamples", rays}};
    struct exr_new_part part = new_part(s, "");
    part.channels = channels;
    part.channel_count = 2;
    part.compression = "zip";
    part.level = 9;
    part.strings = strings;
    part.string_count = 2;
    return exr_write_file(s->truth, NULL, &part, 1, true, err);
}

static bool write_camera(const struct job *job, struct tool_error *err)
{
    const struct trace_camera *c = &job->camera;
    const char *path = job->settings->camera_json;
    const struct vec3 rows[3] = {c->rotation.x, c->rotation.y, c->rotation.z};
    const double moved[3] = {c->translation.x, c->translation.y, c->translation.z};
    FILE *file = fopen(path, "w");
    if (!file)
        return fail(err, EXIT_OUTPUT, "%s: %s", path, strerror(errno));
    fprintf(file, "{\n  \"type\": \"%s\",\n", c->orthographic ? "orthographic" : "perspective");
    if (c->orthographic)
        fprintf(file, "  \"ortho_width\": %.17g,\n", c->ortho_width);
    else
        fprintf(file, "  \"fov_x_deg\": %.17g,\n", c->fov_x_deg);
    fprintf(file, "  \"near\": %.17g,\n  \"far\": %.17g,\n  \"world_to_view\": [\n", c->near,
            c->far);
    for (int i = 0; i < 3; i++)
        fprintf(file, "    [%.17g, %.17g, %.17g, %.17g],\n", rows[i].x, rows[i].y, rows[i].z,
                moved[i]);
    fprintf(file, "    [0, 0, 0, 1]\n  ]\n}\n");
    bool good = !ferror(file);
    if (fclose(file) || !good)
        return fail(err, EXIT_OUTPUT, "%s: cannot write", path);
    return true;
}

static bool render(const struct settings *s, struct tool_error *err)
{
    struct trace_scene scene = {0};
    courtyard_add(&scene);
    struct job job = {.settings = s, .scene = &scene, .camera = courtyard_camera()};
    size_t texels = (size_t)s->width * (size_t)s->height;
    bool good = trace_build(&scene) && picture_allocate(&job.picture, texels);
    if (!good) {
        fail(err, EXIT_MEMORY, "out of memory");
    } else {
        parallel_run(NULL, (uint32_t)s->height, draw_row, &job);
        if (!s->bare)
            round_gbuffer(job.picture.z, job.picture.normal, texels);
        for (size_t i = 0; i < texels; i++)
            job.picture.z[i] = job.picture.z[i] > 0.0f ? job.picture.z[i] : BACKGROUND_Z;
        good = write_picture(&job, err) && (!s->truth || write_truth(&job, err)) &&
               (!s->camera_json || write_camera(&job, err));
    }
    picture_free(&job.picture);
    trace_scene_free(&scene);
    return good;
}

int main(int argc, char **argv)
{
    struct settings settings = {
        .width = 640, .height = 360, .samples = 256, .rays = 1024, .radius = 0.5};
    struct tool_error err = {0};
    if (argc == 2 && !strcmp(argv[1], "--help")) {
        fputs(usage, stdout);
        return EXIT_OK;
    }
    if (!parse(argc, argv, &settings, &err) || !render(&settings, &err)) {
        fprintf(stderr, "vkao-demo-render: %s\n", err.message);
        if (err.code == EXIT_USAGE)
            fputs(usage, stderr);
        return err.code;
    }
    return EXIT_OK;
}
