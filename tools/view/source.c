/* SPDX-License-Identifier: MIT */
#include "source.h"

#include "ao_radius.h"
#include "automatic.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static bool exists(const char *path)
{
    struct stat s;
    return stat(path, &s) == 0;
}

/* FILE.exr -> FILE + suffix, malloc'ed; NULL if there is no such file. */
static char *beside(const char *path, const char *suffix)
{
    struct text text = {0};
    size_t stem = strlen(path);
    if (text_ends_with(path, ".exr"))
        stem -= strlen(".exr");
    text_add(&text, "%.*s%s", (int)stem, path, suffix);
    if (text.data && !text.out_of_memory && exists(text.data))
        return text.data;
    text_free(&text);
    return NULL;
}

static char *copy_or_null(const char *string)
{
    return string ? text_copy(string, strlen(string)) : NULL;
}

bool source_open(struct source *source, struct gpu *gpu, const struct options *options,
                 const char *reference, struct tool_error *err)
{
    *source = (struct source){.gpu = gpu, .options = *options, .reference_given = reference};
    return !options->input || plan_make(options, &source->plan, err);
}

/* --- Loading --- */

static void loaded_free(struct gpu *gpu, struct loaded_frame *l)
{
    struct gpu_image *const images[] = {&l->depth,  &l->normals,  &l->color,        &l->thickness,
                                        &l->albedo, &l->specular, &l->second_depth, &l->kept,
                                        &l->before, &l->reference};
    for (size_t i = 0; i < sizeof images / sizeof *images; i++)
        gpu_image_destroy(gpu, images[i]);
    gbuffer_free(&l->gbuffer);
    if (l->files)
        frame_source_close(l->files);
    free(l->files);
    free(l->reference_values);
    free(l->path);
    free(l->camera_path);
    free(l->reference_path);
    *l = (struct loaded_frame){0};
}

static bool upload(struct gpu *gpu, struct gpu_image *image, VkFormat format, VkExtent2D extent,
                   const float *values, struct tool_error *err)
{
    if (!values)
        return true;
    uint64_t bytes = (uint64_t)extent.width * extent.height * gpu_format_bytes(format);
    return gpu_image_create(gpu, format, extent, VK_IMAGE_USAGE_SAMPLED_BIT, image, err) &&
           gpu_image_upload(gpu, image, values, bytes, err);
}

static VkExtent2D padded_extent(const struct gbuffer *g, const struct placement *p)
{
    return (VkExtent2D){g->width + p->left, g->height + p->top};
}

/* --- The reference --- */

/* AO by the names that vkao, the harness and renderers use; false if the file has none of them. */
static bool find_reference(const struct exr_info *info, size_t *part, const char **channel)
{
    static const char *const names[] = {"AO_falloff", "AO", "ao", "AO.Y", "Y", "R"};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++)
        for (size_t p = 0; p < info->part_count; p++)
            for (size_t c = 0; !info->parts[p].deep && c < info->parts[p].channel_count; c++)
                if (strcmp(info->parts[p].channels[c].name, names[n]) == 0) {
                    *part = p;
                    *channel = info->parts[p].channels[c].name;
                    return true;
                }
    return false;
}

static bool read_reference(struct gpu *gpu, struct loaded_frame *l, struct report *report,
                           struct tool_error *err)
{
    const struct gbuffer *g = &l->gbuffer;
    const VkExtent2D extent = padded_extent(g, &l->placement);
    struct exr_info info = {0};
    size_t part = 0, texels = (size_t)extent.width * extent.height;
    const char *channel = NULL;
    float *values = NULL;
    if (!exr_info_read(l->reference_path, &info, err))
        return false;
    bool ok = find_reference(&info, &part, &channel) ||
              fail(err, EXIT_CHANNELS, "%s: no AO channel", info.path);
    if (ok) {
        const struct exr_box *box = &info.parts[part].data_window;
        if ((int64_t)box->x_max - box->x_min + 1 != g->width ||
            (int64_t)box->y_max - box->y_min + 1 != g->height)
            ok = fail(err, EXIT_INPUT, "%s: the reference is not %u x %u texels, as %s is",
                      info.path, g->width, g->height, l->path);
    }
    if (ok) {
        values = calloc(texels ? texels : 1, sizeof *values);
        l->reference_values = calloc((size_t)g->width * g->height + 1, sizeof *values);
        ok = (values && l->reference_values) ||
             fail(err, EXIT_MEMORY, "%s: out of memory", info.path);
    }
    const struct exr_read read = {channel, l->reference_values, 1};
    ok = ok && exr_read_channels(&info, part, &read, 1, err);
    for (size_t row = 0; ok && row < g->height; row++)
        memcpy(values + (row + l->placement.top) * extent.width + l->placement.left,
               l->reference_values + row * g->width, g->width * sizeof *values);
    ok = ok && upload(gpu, &l->reference, VK_FORMAT_R32_SFLOAT, extent, values, err);
    size_t unknown = 0;
    for (size_t i = 0; ok && i < (size_t)g->width * g->height; i++)
        unknown += isfinite(l->reference_values[i]) ? 0 : 1;
    if (unknown > 0)
        report_warn(report, "reference values",
                    "%s: %zu texels of '%s' are not finite: RMSE is of the others", info.path,
                    unknown, channel);
    if (ok) {
        l->reference_radius = reference_radius(&info);
        snprintf(l->reference_channel, sizeof l->reference_channel, "%s", channel);
    } else {
        free(l->reference_values);
        l->reference_values = NULL;
    }
    free(values);
    exr_info_free(&info);
    return ok;
}

/* --- The G-buffer --- */

/* What the composite does not darken, of colour that gbuffer_load has split. */
static bool upload_light(struct source *s, struct loaded_frame *l, struct tool_error *err)
{
    const struct gbuffer *g = &l->gbuffer;
    const VkExtent2D extent = {g->width, g->height};
    const VkFormat vector = VK_FORMAT_R32G32B32A32_SFLOAT;
    const size_t texels = (size_t)g->width * g->height;
    if (!g->kept && !g->holdout)
        return true;
    float *kept = calloc(texels * 4 + 1, sizeof *kept);
    float *before = g->color && g->holdout ? calloc(texels * 4 + 1, sizeof *before) : NULL;
    bool ok = (kept && (before || !g->color || !g->holdout)) ||
              fail(err, EXIT_MEMORY, "%s: out of memory", l->path);
    for (size_t i = 0; ok && i < texels; i++) {
        const size_t row = i / g->width + l->placement.top, column = i % g->width;
        const size_t padded = row * (g->width + l->placement.left) + column + l->placement.left;
        for (size_t c = 0; c < 3; c++) {
            kept[i * 4 + c] = g->kept ? g->kept[i * 4 + c] : 0.0f;
            if (before)
                before[i * 4 + c] = g->color[padded * 4 + c] + kept[i * 4 + c] +
                                    (g->specular ? g->specular[padded * 4 + c] : 0.0f);
        }
        kept[i * 4 + 3] = g->holdout ? g->holdout[i] : 0.0f;
    }
    ok = ok && upload(s->gpu, &l->kept, vector, extent, kept, err) &&
         upload(s->gpu, &l->before, vector, extent, before, err);
    free(kept);
    free(before);
    return ok;
}

static bool upload_gbuffer(struct source *s, struct loaded_frame *l, struct tool_error *err)
{
    const struct gbuffer *g = &l->gbuffer;
    const VkExtent2D extent = padded_extent(g, &l->placement);
    const VkFormat vector = VK_FORMAT_R32G32B32A32_SFLOAT, scalar = VK_FORMAT_R32_SFLOAT;
    return upload(s->gpu, &l->depth, scalar, extent, g->depth, err) &&
           upload(s->gpu, &l->normals, vector, extent, g->normals, err) &&
           upload(s->gpu, &l->color, vector, extent, g->color, err) &&
           upload(s->gpu, &l->thickness, scalar, extent, g->thickness, err) &&
           upload(s->gpu, &l->second_depth, scalar, extent, g->second_depth, err) &&
           upload(s->gpu, &l->albedo, vector, extent, g->albedo, err) &&
           upload(s->gpu, &l->specular, vector, extent, g->specular, err) &&
           upload_light(s, l, err);
}

/* Options that say something of the colour want it; else it is shown where there is some. */
static bool asks_for_color(const struct role_request *request)
{
    return request->name[ROLE_COLOR] || request->file[ROLE_COLOR] || request->name[ROLE_INDIRECT] ||
           request->name[ROLE_ALBEDO] || request->name[ROLE_SPECULAR];
}

static bool read_gbuffer(struct source *s, struct loaded_frame *l, bool want_color,
                         struct report *report, struct tool_error *err)
{
    const struct view *view = &l->files->views[l->view];
    struct gbuffer_options wanted = view_options(&s->options, view);
    wanted.memory = &s->cameras[l->view];
    wanted.want_color = want_color;
    view_reserve_work(&wanted, &s->options.setting.effect);
    return gbuffer_load(&l->files->info, &wanted, view->camera, report, &l->gbuffer, err);
}

static bool load_pixels(struct source *s, struct loaded_frame *l, struct report *report,
                        struct tool_error *err)
{
    const struct role_request request = view_options(&s->options, &l->files->views[l->view]).roles;
    const bool asks = asks_for_color(&request);
    struct roles roles;
    struct tool_error without_color = {0}, unseen = {0};
    memset(&roles, 0, sizeof roles);
    const bool has =
        roles_resolve(&l->files->info, &request, &roles, &unseen) && roles.kind[ROLE_COLOR].found;
    if (read_gbuffer(s, l, asks || has, report, err))
        return true;
    /* AO is made of it all the same, unless that is what is wrong. */
    if (asks || !has || !read_gbuffer(s, l, false, report, &without_color))
        return false;
    report_warn(report, "color", "shown without its colour: %s", err->message);
    *err = (struct tool_error){0};
    return true;
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* A few texels far off or at the camera do not count. */
static bool measure_depth(struct loaded_frame *l, struct tool_error *err)
{
    enum { MOST_SAMPLES = 1 << 16 };
    const struct gbuffer *g = &l->gbuffer;
    const size_t texels = (size_t)g->width * g->height, step = texels / MOST_SAMPLES + 1;
    double *z = malloc((texels / step + 1) * sizeof *z);
    size_t count = 0;
    for (size_t i = 0; z && i < texels; i += step) {
        const size_t row = i / g->width + l->placement.top;
        const float depth =
            g->depth[row * (g->width + l->placement.left) + i % g->width + l->placement.left];
        if (depth < g->background_depth || depth > g->background_depth)
            z[count++] = gbuffer_view_z(g, depth, i);
    }
    if (count > 0) {
        qsort(z, count, sizeof *z, compare);
        l->near_z = z[count / 100];
        l->far_z = z[count - 1 - count / 100];
    }
    free(z);
    return z || fail(err, EXIT_MEMORY, "%s: out of memory", l->path);
}

static bool load_gbuffer(struct source *s, const struct plan_frame *frame, struct loaded_frame *l,
                         size_t view, struct report *report, struct tool_error *err)
{
    l->files = calloc(1, sizeof *l->files);
    if (!l->files)
        return fail(err, EXIT_MEMORY, "%s: out of memory", l->path);
    if (!frame_source_read_header(l->path, l->files, err) ||
        !frame_source_read_files((const char *const *)frame->file, l->files, err) ||
        !frame_source_choose_views(&s->options, l->camera_path, l->files, err))
        return false;
    l->view = view < l->files->view_count ? view : 0;
    return (load_pixels(s, l, report, err) || plan_fail_of_frame(frame, err)) &&
           placement_expand(&l->gbuffer, &l->placement, err) && measure_depth(l, err) &&
           upload_gbuffer(s, l, err);
}

static bool load_frame(struct source *s, const struct plan_frame *frame, size_t view,
                       struct loaded_frame *l, struct report *report, struct tool_error *err)
{
    l->path = copy_or_null(frame->input);
    l->camera_path = copy_or_null(frame->camera);
    l->reference_path =
        s->reference_given ? copy_or_null(s->reference_given) : beside(frame->input, ".gt.exr");
    if (!l->path || (frame->camera && !l->camera_path))
        return fail(err, EXIT_MEMORY, "%s: out of memory", frame->input);
    if (!load_gbuffer(s, frame, l, view, report, err))
        return false;
    struct tool_error unusable = {0};
    if (!l->reference_path || read_reference(s->gpu, l, report, &unusable))
        return true;
    /* One that was asked for must be there; one that merely lies there need not fit. */
    if (s->reference_given || unusable.code == EXIT_DEVICE || unusable.code == EXIT_MEMORY) {
        *err = unusable;
        return false;
    }
    report_warn(report, "reference", "%s", unusable.message);
    return true;
}

bool source_load(struct source *source, size_t frame, size_t view, struct report *report,
                 struct tool_error *err)
{
    struct source *s = source;
    struct loaded_frame l = {0};
    if (frame >= s->plan.count)
        return fail(err, EXIT_BUG, "there is no frame %zu", frame);
    if (!load_frame(s, &s->plan.frames[frame], view, &l, report, err)) {
        loaded_free(s->gpu, &l);
        return false;
    }
    loaded_free(s->gpu, &s->now);
    s->now = l;
    s->frame = frame;
    /* An empty frame tells nothing of the others. */
    if (!(s->radius > 0) && !s->options.radius_is_auto)
        s->radius = s->options.setting.params.radius;
    else if (!(s->radius > 0) && s->now.gbuffer.median_z > 0)
        s->radius = relative_radius_of(&s->options.relative_radius, &s->now.gbuffer);
    return true;
}

void source_close(struct source *source)
{
    if (!source->gpu)
        return;
    loaded_free(source->gpu, &source->now);
    plan_free(&source->plan);
    *source = (struct source){0};
}

/* --- Dropped files --- */

/* Of its channels: is it a picture of AO and nothing that vkao could work on? */
static bool is_reference(const char *path)
{
    struct exr_info info = {0};
    struct tool_error unseen = {0};
    struct roles roles;
    const struct role_request any = {0};
    const char *channel;
    size_t part;
    memset(&roles, 0, sizeof roles);
    if (!exr_info_read(path, &info, &unseen))
        return false;
    bool yes =
        !roles_resolve(&info, &any, &roles, &unseen) && find_reference(&info, &part, &channel);
    exr_info_free(&info);
    return yes;
}

static bool make_plan(const char *const *paths, size_t count, const char *camera, struct plan *plan,
                      struct tool_error *err)
{
    *plan = (struct plan){.is_sequence = count > 1};
    plan->frames = calloc(count, sizeof *plan->frames);
    for (size_t i = 0; plan->frames && i < count; i++) {
        struct plan_frame *f = &plan->frames[plan->count];
        f->number = (int64_t)i + 1;
        f->input = copy_or_null(paths[i]);
        f->camera = copy_or_null(camera);
        if (!f->input || (camera && !f->camera))
            break;
        plan->count++;
    }
    if (plan->count == count)
        return true;
    plan_free(plan);
    return fail(err, EXIT_MEMORY, "out of memory for %zu files", count);
}

/* camera may be NULL. What was copied is to be freed with the plan, also on failure. */
static bool copy_frame(const struct plan_frame *from, const char *camera, struct plan_frame *to)
{
    to->number = from->number;
    to->input = copy_or_null(from->input);
    to->camera = copy_or_null(camera);
    bool ok = to->input && (to->camera || !camera);
    for (int kind = 0; kind < ROLE_FILES; kind++) {
        to->file[kind] = copy_or_null(from->file[kind]);
        ok = ok && (to->file[kind] || !from->file[kind]);
    }
    return ok;
}

/* The frames that there are, with another camera if there is one. */
static bool make_same_plan(const struct source *s, const char *camera, struct plan *plan,
                           struct tool_error *err)
{
    *plan = s->plan;
    plan->cameras_lie_beside = s->plan.cameras_lie_beside && !camera;
    plan->count = 0;
    plan->frames = calloc(s->plan.count, sizeof *plan->frames);
    bool ok = plan->frames != NULL;
    for (size_t i = 0; ok && i < s->plan.count; i++) {
        const struct plan_frame *from = &s->plan.frames[i];
        ok = copy_frame(from, camera ? camera : from->camera, &plan->frames[plan->count++]);
    }
    return ok || fail(err, EXIT_MEMORY, "out of memory for %zu files", s->plan.count);
}

static bool lies_beside(const char *path, const char *gbuffer)
{
    static const char *const suffixes[] = {".camera.json", ".gt.exr"};
    bool yes = false;
    for (size_t i = 0; i < sizeof suffixes / sizeof *suffixes; i++) {
        char *other = beside(gbuffer, suffixes[i]);
        yes = yes || (other && strcmp(other, path) == 0);
        free(other);
    }
    return yes;
}

/* G-buffers come first, and one camera file is theirs. What lies beside one of them is found all
 * the same, as it is for vkao. */
static bool sort_out(char *const *paths, size_t count, const char **gbuffers, size_t *gbuffer_count,
                     const char **camera, struct tool_error *err)
{
    *gbuffer_count = 0;
    *camera = NULL;
    for (size_t i = 0; i < count; i++) {
        bool is_found = false;
        for (size_t k = 0; k < count && !is_found; k++)
            is_found = k != i && lies_beside(paths[i], paths[k]);
        if (is_found)
            continue;
        if (!text_ends_with(paths[i], ".json"))
            gbuffers[(*gbuffer_count)++] = paths[i];
        else if (*camera)
            return fail(err, EXIT_INPUT, "%s and %s: one camera file at a time", *camera, paths[i]);
        else
            *camera = paths[i];
    }
    return true;
}

/* G-buffers, and what came with them. */
static bool make_dropped_plan(const struct source *s, char *const *paths, size_t count,
                              struct plan *plan, struct tool_error *err)
{
    /* --camera was said of other files; none is said of all. */
    struct options options = s->options;
    const char **gbuffers = calloc(count, sizeof *gbuffers), *camera;
    size_t gbuffer_count;
    if (options.camera_file && strcmp(options.camera_file, "none") != 0)
        options.camera_file = NULL;
    bool ok = gbuffers || fail(err, EXIT_MEMORY, "out of memory for %zu files", count);
    ok = ok && sort_out(paths, count, gbuffers, &gbuffer_count, &camera, err);
    if (ok && gbuffer_count == 0)
        ok = fail(err, EXIT_INPUT, "%s: a camera, and no file that it is of", paths[0]);
    ok = ok && make_plan(gbuffers, gbuffer_count, camera, plan, err) &&
         (camera || plan_take_cameras(&options, plan, err));
    free(gbuffers);
    return ok;
}

static void take_reference(struct source *s, const char *path)
{
    /* Of a sequence each frame has its own, if this is how it is named. */
    char *own = beside(s->now.path, ".gt.exr");
    const bool is_own = own && strcmp(own, path) == 0;
    snprintf(s->reference_dropped, sizeof s->reference_dropped, "%s", path);
    s->reference_given = is_own ? NULL : s->reference_dropped;
    free(own);
}

bool source_drop(struct source *source, char *const *paths, size_t count, struct source_undo *undo,
                 struct tool_error *err)
{
    struct source *s = source;
    struct plan plan = {0};
    const bool camera = count == 1 && s->now.path && text_ends_with(paths[0], ".json");
    const bool reference = count == 1 && s->now.path && !camera && is_reference(paths[0]);
    const bool same = camera || reference;
    const bool ok = same ? make_same_plan(s, camera ? paths[0] : NULL, &plan, err)
                         : make_dropped_plan(s, paths, count, &plan, err);
    if (!ok) {
        plan_free(&plan);
        return false;
    }
    *undo = (struct source_undo){.plan = s->plan,
                                 .frame = s->frame,
                                 .radius = s->radius,
                                 .reference_given = s->reference_given};
    memcpy(undo->cameras, s->cameras, sizeof undo->cameras);
    memcpy(undo->reference_dropped, s->reference_dropped, sizeof undo->reference_dropped);
    s->plan = plan;
    if (!reference)
        memset(s->cameras, 0, sizeof s->cameras);
    if (reference)
        take_reference(s, paths[0]);
    if (same)
        return true;
    s->frame = 0;
    s->reference_given = NULL;
    s->radius = 0; /* of other files */
    return true;
}

void source_settle(struct source *source, struct source_undo *undo, bool loaded)
{
    if (loaded) {
        plan_free(&undo->plan);
        return;
    }
    plan_free(&source->plan);
    source->plan = undo->plan;
    source->frame = undo->frame;
    source->radius = undo->radius;
    memcpy(source->cameras, undo->cameras, sizeof undo->cameras);
    source->reference_given = undo->reference_given;
    memcpy(source->reference_dropped, undo->reference_dropped, sizeof undo->reference_dropped);
}

struct inputs source_inputs(const struct source *source)
{
    const struct loaded_frame *l = &source->now;
    struct inputs inputs = {.images = vkao_images_default(),
                            .extent = padded_extent(&l->gbuffer, &l->placement),
                            .view = l->gbuffer.view,
                            .depth = l->depth.image,
                            .normals = l->normals.image};
    inputs.images.depth = gpu_image_slot(&l->depth);
    if (l->normals.image)
        inputs.images.normals = gpu_image_slot(&l->normals);
    if (l->color.image)
        inputs.images.color = gpu_image_slot(&l->color);
    if (l->thickness.image)
        inputs.images.thickness = gpu_image_slot(&l->thickness);
    if (l->second_depth.image)
        inputs.images.second_depth = gpu_image_slot(&l->second_depth);
    if (l->albedo.image)
        inputs.images.albedo = gpu_image_slot(&l->albedo);
    if (l->specular.image)
        inputs.images.specular = gpu_image_slot(&l->specular);
    return inputs;
}
