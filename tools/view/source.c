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
    gpu_image_destroy(gpu, &l->depth);
    gpu_image_destroy(gpu, &l->normals);
    gpu_image_destroy(gpu, &l->color);
    gpu_image_destroy(gpu, &l->reference);
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

/* AO by the names that vkao, the harness and renderers use; else the first channel of the file. */
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

static bool read_reference(struct gpu *gpu, struct loaded_frame *l, struct tool_error *err)
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
    l->reference_radius = reference_radius(&info);
    if (ok)
        snprintf(l->reference_channel, sizeof l->reference_channel, "%s", channel);
    free(values);
    exr_info_free(&info);
    return ok;
}

/* --- The G-buffer --- */

/* Colour is wanted where there is some. */
static bool load_gbuffer(struct source *s, struct loaded_frame *l, size_t view,
                         struct report *report, struct tool_error *err)
{
    struct options options = s->options;
    l->files = calloc(1, sizeof *l->files);
    if (!l->files)
        return fail(err, EXIT_MEMORY, "%s: out of memory", l->path);
    if (!frame_source_open(&options, l->path, l->camera_path, l->files, err))
        return false;
    if (view >= l->files->view_count)
        view = 0;
    struct gbuffer_options wanted = view_options(&options, &l->files->views[view]);
    struct roles roles;
    struct tool_error unseen = {0};
    memset(&roles, 0, sizeof roles);
    wanted.want_color = roles_resolve(&l->files->info, &wanted.roles, &roles, &unseen) &&
                        roles.kind[ROLE_COLOR].found;
    if (!gbuffer_load(&l->files->info, &wanted, l->files->views[view].camera, report, &l->gbuffer,
                      err) ||
        !placement_expand(&l->gbuffer, &l->placement, err))
        return false;
    const VkExtent2D extent = padded_extent(&l->gbuffer, &l->placement);
    const struct gbuffer *g = &l->gbuffer;
    const VkFormat vector = VK_FORMAT_R32G32B32A32_SFLOAT;
    l->view = view;
    return upload(s->gpu, &l->depth, VK_FORMAT_R32_SFLOAT, extent, g->depth, err) &&
           upload(s->gpu, &l->normals, vector, extent, g->normals, err) &&
           upload(s->gpu, &l->color, vector, extent, g->color, err);
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
    if (!load_gbuffer(s, l, view, report, err))
        return false;
    struct tool_error unusable = {0};
    if (!l->reference_path || read_reference(s->gpu, l, &unusable))
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
    if (!(s->radius > 0))
        s->radius = s->options.radius_is_auto
                        ? relative_radius_of(&s->options.relative_radius, &s->now.gbuffer)
                        : s->options.setting.params.radius;
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

static bool make_plan(char *const *paths, size_t count, const char *camera, struct plan *plan,
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

bool source_drop(struct source *source, char *const *paths, size_t count, struct source_undo *undo,
                 struct tool_error *err)
{
    struct source *s = source;
    struct plan plan = {0};
    /* --camera was said of other files; none is said of all. */
    struct options options = s->options;
    if (options.camera_file && strcmp(options.camera_file, "none") != 0)
        options.camera_file = NULL;
    const bool camera = count == 1 && s->now.path && text_ends_with(paths[0], ".json");
    const bool reference = count == 1 && s->now.path && !camera && is_reference(paths[0]);
    char *const same[] = {s->now.path};
    bool ok =
        camera || reference
            ? make_plan(same, 1, camera ? paths[0] : s->now.camera_path, &plan, err)
            : make_plan(paths, count, NULL, &plan, err) && plan_take_cameras(&options, &plan, err);
    if (!ok) {
        plan_free(&plan);
        return false;
    }
    *undo = (struct source_undo){.plan = s->plan,
                                 .frame = s->frame,
                                 .radius = s->radius,
                                 .reference_given = s->reference_given};
    memcpy(undo->reference_dropped, s->reference_dropped, sizeof undo->reference_dropped);
    s->plan = plan;
    s->frame = 0;
    if (reference) {
        snprintf(s->reference_dropped, sizeof s->reference_dropped, "%s", paths[0]);
        s->reference_given = s->reference_dropped;
    } else if (!camera) {
        s->reference_given = NULL;
        s->radius = 0; /* of other files */
    }
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
    return inputs;
}
