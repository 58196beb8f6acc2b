/* SPDX-License-Identifier: MIT */
#include "corpus.h"

#include "ao_radius.h"
#include "text.h"

#include <dirent.h>
#include <errno.h>
#include <fnmatch.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char truth_suffix[] = ".gt.exr", camera_suffix[] = ".camera.json";
/* By vkao_falloff. */
static const char *const truth_channels[2] = {"AO_falloff", "AO_threshold"};

/* --- The folder --- */

struct names {
    char **list;
    size_t count, capacity;
};

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static bool add_name(struct names *names, const char *name, size_t length)
{
    if (names->count == names->capacity) {
        size_t capacity = names->capacity ? names->capacity * 2 : 64;
        char **list = realloc(names->list, capacity * sizeof *list);
        if (!list)
            return false;
        names->list = list;
        names->capacity = capacity;
    }
    names->list[names->count] = text_copy(name, length);
    return names->list[names->count++] != NULL;
}

static void free_names(struct names *names)
{
    for (size_t i = 0; i < names->count; i++)
        free(names->list[i]);
    free(names->list);
    *names = (struct names){0};
}

static bool list_folder(const char *folder, struct names *names, struct tool_error *err)
{
    DIR *dir = opendir(folder);
    struct dirent *entry;
    bool ok = true;
    if (!dir)
        return fail(err, EXIT_INPUT, "%s: %s", folder, strerror(errno));
    while (ok && (entry = readdir(dir)) != NULL)
        ok = add_name(names, entry->d_name, strlen(entry->d_name));
    closedir(dir);
    if (!ok)
        return fail(err, EXIT_MEMORY, "%s: out of memory", folder);
    if (names->count > 0)
        qsort(names->list, names->count, sizeof *names->list, compare_names);
    return true;
}

/* A name that starts with stem and a dot, and goes on to end with suffix. */
static bool has_companion(const struct names *names, const char *stem, size_t length,
                          const char *suffix)
{
    for (size_t i = 0; i < names->count; i++) {
        const char *name = names->list[i];
        if (strlen(name) >= length + strlen(suffix) && strncmp(name, stem, length) == 0 &&
            name[length] == '.' && text_ends_with(name, suffix))
            return true;
    }
    return false;
}

static bool is_gbuffer(const struct names *names, const char *name, size_t *stem)
{
    char camera[256];
    if (!text_ends_with(name, ".exr") || text_ends_with(name, truth_suffix))
        return false;
    *stem = strlen(name) - strlen(".exr");
    snprintf(camera, sizeof camera, "%.*s%s", (int)*stem, name, camera_suffix);
    const char *key = camera;
    return bsearch(&key, names->list, names->count, sizeof *names->list, compare_names) &&
           has_companion(names, name, *stem, truth_suffix);
}

bool corpus_open(const char *folder, const char *part_of_name, struct corpus *corpus,
                 struct tool_error *err)
{
    struct names all = {0}, stems = {0};
    *corpus = (struct corpus){0};
    bool ok = list_folder(folder, &all, err);
    for (size_t i = 0; ok && i < all.count; i++) {
        size_t stem;
        if (!is_gbuffer(&all, all.list[i], &stem))
            continue;
        if ((!part_of_name || strstr(all.list[i], part_of_name)) &&
            !add_name(&stems, all.list[i], stem))
            ok = fail(err, EXIT_MEMORY, "%s: out of memory", folder);
    }
    free_names(&all);
    corpus->folder = text_copy(folder, strlen(folder));
    corpus->stems = stems.list;
    corpus->count = stems.count;
    if (ok && !corpus->folder)
        ok = fail(err, EXIT_MEMORY, "%s: out of memory", folder);
    if (ok && stems.count == 0) {
        fail_hint(err, "want X.exr with X%s and X%s beside it", camera_suffix, truth_suffix);
        ok = fail(err, EXIT_INPUT, "%s: no G-buffer with camera and truth%s%s", folder,
                  part_of_name ? " whose name contains " : "", part_of_name ? part_of_name : "");
    }
    if (!ok)
        corpus_close(corpus);
    return ok;
}

void corpus_close(struct corpus *corpus)
{
    struct names stems = {.list = corpus->stems, .count = corpus->count};
    free_names(&stems);
    free(corpus->folder);
    *corpus = (struct corpus){0};
}

/* --- Frames of a sequence --- */

/* The digits behind the last dot, NULL if there is anything else. */
static const char *frame_digits(const char *stem)
{
    const char *dot = strrchr(stem, '.');
    if (!dot || !dot[1] || strspn(dot + 1, "0123456789") != strlen(dot + 1))
        return NULL;
    return dot + 1;
}

/* Numbers of any length, with any zeros before them; only of names with frame_digits. */
static int compare_frames(const void *a, const void *b)
{
    const char *x = frame_digits(*(char *const *)a), *y = frame_digits(*(char *const *)b);
    x += strspn(x, "0");
    y += strspn(y, "0");
    if (strlen(x) != strlen(y))
        return strlen(x) < strlen(y) ? -1 : 1;
    return strcmp(x, y);
}

static bool check_frames(const struct corpus *corpus, struct tool_error *err)
{
    const char *first = corpus->stems[0], *digits = frame_digits(first);
    for (size_t i = 0; i < corpus->count; i++) {
        const char *stem = corpus->stems[i], *own = frame_digits(stem);
        if (!own)
            return fail(err, EXIT_INPUT, "%s/%s.exr: no frame of a sequence", corpus->folder, stem);
        if (own - stem != digits - first || strncmp(stem, first, (size_t)(own - stem)) != 0)
            return fail(err, EXIT_INPUT, "%s/%s.exr: no frame of the sequence of %s.exr",
                        corpus->folder, stem, first);
    }
    if (corpus->count < 3)
        return fail(err, EXIT_INPUT, "%s: a sequence of %zu, want at least 3 frames",
                    corpus->folder, corpus->count);
    return true;
}

bool corpus_order_frames(struct corpus *corpus, struct tool_error *err)
{
    if (!check_frames(corpus, err))
        return fail_hint(err, "frames are STEM.NUMBER.exr; --files PART chooses among G-buffers");
    qsort(corpus->stems, corpus->count, sizeof *corpus->stems, compare_frames);
    return true;
}

/* --- Patterns --- */

/* The next of comma-separated patterns; false at the end. */
static bool next_pattern(const char **patterns, char *pattern, size_t size)
{
    *patterns += strspn(*patterns, ",");
    const size_t length = strcspn(*patterns, ",");
    snprintf(pattern, size, "%.*s", (int)length, *patterns);
    *patterns += length;
    return length > 0;
}

bool corpus_fits(const struct corpus *corpus, size_t index, const char *patterns)
{
    char pattern[256];
    while (next_pattern(&patterns, pattern, sizeof pattern))
        if (fnmatch(pattern, corpus->stems[index], 0) == 0)
            return true;
    return false;
}

bool corpus_check_patterns(const struct corpus *corpus, const char *option, const char *patterns,
                           struct tool_error *err)
{
    char pattern[256];
    while (next_pattern(&patterns, pattern, sizeof pattern)) {
        bool found = false;
        for (size_t i = 0; !found && i < corpus->count; i++)
            found = fnmatch(pattern, corpus->stems[i], 0) == 0;
        if (!found)
            return fail(err, EXIT_USAGE, "%s: '%s' fits no G-buffer of %s", option, pattern,
                        corpus->folder);
    }
    return true;
}

/* --- Files --- */

static char *path_of(const struct corpus *corpus, size_t index, const char *view,
                     const char *suffix, struct tool_error *err)
{
    struct text path = {0};
    text_add(&path, "%s/%s%s%s%s", corpus->folder, corpus->stems[index], *view ? "." : "", view,
             suffix);
    if (!path.out_of_memory)
        return path.data;
    text_free(&path);
    fail(err, EXIT_MEMORY, "%s: out of memory", corpus->stems[index]);
    return NULL;
}

bool corpus_read(const struct corpus *corpus, size_t index, struct frame_source *source,
                 struct tool_error *err)
{
    const struct options options = {.command = COMMAND_RENDER}; /* every view, every role found */
    char *image = path_of(corpus, index, "", ".exr", err);
    char *camera = path_of(corpus, index, "", camera_suffix, err);
    *source = (struct frame_source){0};
    bool ok = image && camera && frame_source_open(&options, image, camera, source, err);
    free(image);
    free(camera);
    return ok;
}

/* --- Truth --- */

static const struct exr_part *part_with(const struct exr_info *info, const char *channel)
{
    for (size_t p = 0; p < info->part_count; p++)
        for (size_t c = 0; c < info->parts[p].channel_count; c++)
            if (strcmp(info->parts[p].channels[c].name, channel) == 0)
                return &info->parts[p];
    return NULL;
}

static bool read_truth(const struct exr_info *info, vkao_falloff falloff, struct scene *scene,
                       struct tool_error *err)
{
    const struct gbuffer *g = &scene->gbuffer;
    const char *channel = truth_channels[falloff];
    const struct exr_part *part = part_with(info, channel);
    if (!part)
        return fail(err, EXIT_CHANNELS, "%s: no channel '%s'", info->path, channel);
    int64_t width = (int64_t)part->data_window.x_max - part->data_window.x_min + 1;
    int64_t height = (int64_t)part->data_window.y_max - part->data_window.y_min + 1;
    if (width != g->width || height != g->height)
        return fail(err, EXIT_INPUT, "%s: truth is %lld x %lld, its G-buffer %u x %u", info->path,
                    (long long)width, (long long)height, g->width, g->height);
    scene->truth[falloff] = calloc((size_t)g->width * g->height, sizeof **scene->truth);
    if (!scene->truth[falloff])
        return fail(err, EXIT_MEMORY, "%s: out of memory", info->path);
    const struct exr_read read = {channel, scene->truth[falloff], 1};
    return exr_read_channels(info, (size_t)(part - info->parts), &read, 1, err);
}

static bool load_truth(const char *path, const bool wanted[2], struct scene *scene,
                       struct tool_error *err)
{
    struct exr_info info = {0};
    bool ok = exr_info_read(path, &info, err);
    for (int f = 0; ok && f < 2; f++)
        ok = !wanted[f] || read_truth(&info, (vkao_falloff)f, scene, err);
    if (ok)
        scene->radius = reference_radius(&info);
    exr_info_free(&info);
    return ok;
}

/* --- Scene --- */

/* Beyond 1e7 a distance stands for the sky in files that know no infinity. */
static bool counts(const struct gbuffer *g, size_t texel)
{
    float d = g->depth[texel];
    bool background = !(d < g->background_depth) && !(d > g->background_depth);
    bool is_length = g->view.depth_encoding == VKAO_DEPTH_VIEW_Z ||
                     g->view.depth_encoding == VKAO_DEPTH_DISTANCE;
    return isfinite(d) && !background && (!is_length || (d > 0 && d < 1e7f));
}

static bool mark_foreground(struct scene *scene, struct tool_error *err)
{
    size_t texels = (size_t)scene->gbuffer.width * scene->gbuffer.height;
    scene->foreground = calloc(texels, 1);
    if (!scene->foreground)
        return fail(err, EXIT_MEMORY, "%s: out of memory", scene->name);
    for (size_t i = 0; i < texels; i++)
        scene->foreground[i] = counts(&scene->gbuffer, i);
    return true;
}

bool scene_load(const struct corpus *corpus, size_t index, const struct frame_source *source,
                size_t view, const bool wanted[2], struct report *report, struct scene *scene,
                struct tool_error *err)
{
    const struct options options = {.command = COMMAND_RENDER};
    const struct view *v = &source->views[view];
    const struct gbuffer_options read = view_options(&options, v);
    *scene = (struct scene){.folder = corpus->folder};
    snprintf(scene->name, sizeof scene->name, "%s%s%s", corpus->stems[index], *v->name ? "." : "",
             v->name);
    char *truth = path_of(corpus, index, v->name, truth_suffix, err);
    bool ok = truth &&
              gbuffer_load(&source->info, &read, v->camera, report, &scene->gbuffer, err) &&
              load_truth(truth, wanted, scene, err) && mark_foreground(scene, err) &&
              placement_expand(&scene->gbuffer, &scene->placement, err);
    free(truth);
    return ok;
}

void scene_free(struct scene *scene)
{
    gbuffer_free(&scene->gbuffer);
    free(scene->foreground);
    free(scene->truth[0]);
    free(scene->truth[1]);
    *scene = (struct scene){0};
}

void scene_fill_job(const struct scene *scene, struct ao_job *job)
{
    const struct gbuffer *g = &scene->gbuffer;
    job->width = g->width + scene->placement.left;
    job->height = g->height + scene->placement.top;
    job->depth = g->depth;
    job->normals = g->normals;
    job->view = g->view;
}
