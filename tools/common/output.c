/* SPDX-License-Identifier: MIT */
#include "output.h"

#include "png_file.h"
#include "preview.h"
#include "record.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NAME_BYTES = 512, STRINGS = 3 };

/* Of the part, and of the channel of AO in it; "": R, G and B alike. */
struct ao_names {
    char part[NAME_BYTES], channel[NAME_BYTES];
};

/* What exr_new_part points into. */
struct part_storage {
    char name[NAME_BYTES], channel[NAME_BYTES];
    struct exr_write channels[7];
    struct exr_string strings[STRINGS];
    char *params, version[VERSION_BYTES];
};

/* --- Names --- */

static bool is_blender(const struct exr_info *info)
{
    for (size_t p = 0; p < info->part_count; p++)
        for (size_t i = 0; i < info->parts[p].attribute_count; i++)
            if (strcmp(info->parts[p].attributes[i].name, "BlenderMultiChannel") == 0)
                return true;
    return false;
}

static bool has_channel(const struct exr_info *info, const char *name)
{
    for (size_t p = 0; p < info->part_count; p++)
        for (size_t c = 0; c < info->parts[p].channel_count; c++)
            if (strcmp(info->parts[p].channels[c].name, name) == 0)
                return true;
    return false;
}

/* Blender lists a pass 'ViewLayer.AO.V' where it lists 'ViewLayer.Depth.Z'. Its own pass AO is of
 * three channels. False if the depth is not called so. */
static bool blender_names(const struct exr_info *info, const struct role *depth, const char *view,
                          struct ao_names *names)
{
    char own[NAME_BYTES];
    if (!depth->found || depth->info != info || !is_blender(info) ||
        info->parts[depth->part].multi_view_count > 0)
        return false;
    const char *channel = depth->channels[0]->name, *pass = strrchr(channel, '.');
    while (pass && pass > channel && pass[-1] != '.')
        pass--;
    if (!pass || pass == channel)
        return false;
    const int layer = (int)(pass - channel);
    snprintf(own, sizeof own, "%.*sAO.R", layer, channel);
    const char *name = has_channel(info, own) ? "SSAO" : "AO";
    snprintf(names->part, NAME_BYTES, "%.*s%s%s%s", layer, channel, name, *view ? "-" : "", view);
    snprintf(names->channel, NAME_BYTES, "%.*s%s.V", layer, channel, name);
    return true;
}

/* 'ao', 'ao.left'; a lone AO part needs no name. R, G and B are what every program shows as it is;
 * of Y alone ffmpeg stretches the contrast. Zip makes hardly more of three than of one. */
static struct ao_names name_ao(const struct options *o, const struct exr_info *info,
                               const struct role *depth, const char *view)
{
    struct ao_names names;
    const bool is_appended = o->mode == OUTPUT_APPEND;
    const char *base = o->part_name ? o->part_name : is_appended || *view ? "ao" : "";
    if (!is_appended || o->part_name || !blender_names(info, depth, view, &names)) {
        snprintf(names.part, NAME_BYTES, "%s%s%s", base, *view ? "." : "", view);
        snprintf(names.channel, NAME_BYTES, "%s", is_appended ? "AO" : "");
    }
    if (o->channel)
        snprintf(names.channel, NAME_BYTES, "%s", o->channel);
    return names;
}

static void color_part_name(const struct options *o, const struct rendered_view *view,
                            size_t view_count, char name[NAME_BYTES])
{
    const struct role *color = &view->gbuffer.roles.kind[ROLE_COLOR];
    const struct exr_info *info = color->info;
    const struct exr_part *part = &info->parts[color->part];
    const char *base = o->part_name ? o->part_name : part->name ? part->name : "";
    bool shared =
        view_count > 1 && (o->part_name || info->part_count == 1 || !part->view || !*part->view);
    if (shared)
        snprintf(name, NAME_BYTES, "%s.%s", *base ? base : "rgba", view->name);
    else
        snprintf(name, NAME_BYTES, "%s", base);
}

/* The plan checked the path as given; what it becomes for each view is known only now. Names of
 * views may differ in what a path cannot have. */
static bool check_previews(const struct options *options, const struct plan_frame *frame,
                           const struct frame_source *source, struct tool_error *err)
{
    const struct view *views = source->views;
    struct text paths[MAX_VIEWS] = {0};
    bool ok = true;
    for (size_t v = 0; ok && source->view_count > 1 && v < source->view_count; v++) {
        preview_path(frame->preview, views[v].name, source->view_count, &paths[v]);
        if (!paths[v].data || paths[v].out_of_memory)
            ok = fail(err, EXIT_MEMORY, "%s: out of memory", frame->preview);
        for (size_t other = 0; ok && other < v; other++)
            if (strcmp(paths[v].data, paths[other].data) == 0) {
                fail_hint(err, "choose one: --view NAME");
                ok = fail(err, EXIT_OUTPUT, "%s: the preview of both views '%s' and '%s'",
                          paths[v].data, views[other].name, views[v].name);
            }
        ok = ok && plan_check_preview(options, frame, paths[v].data, err);
    }
    for (size_t v = 0; v < source->view_count; v++)
        text_free(&paths[v]);
    return ok;
}

static const char *const bent_names[] = {"bent.X", "bent.Y", "bent.Z"};

static bool check_channel(const struct options *o, struct tool_error *err)
{
    if (!o->channel)
        return true;
    if (o->mode == OUTPUT_COMP)
        return fail(err, EXIT_USAGE,
                    "--channel names the channel of AO, which --mode comp does not write");
    for (size_t i = 0; o->setting.effect.bent_normals && i < 3; i++)
        if (strcmp(o->channel, bent_names[i]) == 0)
            return fail(err, EXIT_USAGE, "--channel is '%s', which --bent-normals writes",
                        o->channel);
    return true;
}

bool output_check_names(const struct options *options, const struct plan_frame *frame,
                        const struct frame_source *source, struct tool_error *err)
{
    if (frame->preview && !frame->is_left && !check_previews(options, frame, source, err))
        return false;
    if (!check_channel(options, err))
        return false;
    for (size_t v = 0; options->mode == OUTPUT_APPEND && v < source->view_count; v++) {
        const struct gbuffer_options view = view_options(options, &source->views[v]);
        struct roles roles = {0};
        struct tool_error unseen = {0}; /* whoever loads the view tells */
        roles_resolve(&source->info, &view.roles, &roles, &unseen);
        const struct ao_names names =
            name_ao(options, &source->info, &roles.kind[ROLE_DEPTH], source->views[v].name);
        for (size_t p = 0; p < source->info.part_count; p++) {
            const char *taken = source->info.parts[p].name;
            if (!taken || strcmp(taken, names.part) != 0)
                continue;
            fail_hint(err, "give the new part another name: --part-name NAME");
            return fail(err, EXIT_OUTPUT, "%s: has a part '%s' already", source->info.path,
                        names.part);
        }
    }
    return true;
}

/* --- EXR --- */

static uint32_t window_width(const struct exr_box *w)
{
    return (uint32_t)((int64_t)w->x_max - w->x_min + 1);
}

static uint32_t window_height(const struct exr_box *w)
{
    return (uint32_t)((int64_t)w->y_max - w->y_min + 1);
}

static size_t window_texels(const struct exr_box *w)
{
    return (size_t)window_width(w) * window_height(w);
}

/* Of what goes out. */
static const struct exr_box *output_window(const struct options *o, const struct gbuffer *g)
{
    return o->mode == OUTPUT_COMP ? &g->color_window : &g->data_window;
}

/* The alpha of colour goes out as it came in; the library passes it on, but through its own image
 * format. */
static void restore_alpha(const struct rendered_view *view)
{
    const size_t texels = window_texels(&view->gbuffer.color_window);
    for (size_t i = 0; i < texels; i++)
        view->result.output[i * 4 + 3] = view->gbuffer.color[i * 4 + 3];
}

static size_t fill_channels(const struct options *o, const struct rendered_view *view,
                            const char *ao, struct exr_write channels[7])
{
    static const char *const names[] = {"R", "G", "B", "A"};
    size_t count = 0;
    if (o->mode == OUTPUT_COMP) {
        restore_alpha(view);
        size_t colors = view->gbuffer.color_has_alpha ? 4 : 3;
        for (; count < colors; count++)
            channels[count] =
                (struct exr_write){names[count], o->pixel_type, view->result.output + count, 4};
    } else if (*ao) {
        channels[count++] = (struct exr_write){ao, o->pixel_type, view->result.ao, 1};
    } else {
        for (; count < 3; count++)
            channels[count] = (struct exr_write){names[count], o->pixel_type, view->result.ao, 1};
    }
    for (size_t i = 0; view->result.bent && i < 3; i++)
        channels[count++] =
            (struct exr_write){bent_names[i], o->pixel_type, view->result.bent + i, 4};
    return count;
}

/* Of an attribute that it does not know ffmpeg 5 and 6 read 255 bytes, and take the rest for
 * attributes: a name and a type of 255 characters, and a value of 255. A text that ends where such
 * a one would is read as if nothing had happened. Spaces behind JSON mean nothing. */
static char *pad_record(char *json)
{
    enum { KNOWN = 255, TAKEN = 255 + 1 + 255 + 1 + 4 + 255 };
    const size_t length = strlen(json);
    if (length <= KNOWN)
        return json;
    const size_t rest = (length - KNOWN) % TAKEN, spaces = rest ? TAKEN - rest : 0;
    char *padded = malloc(length + spaces + 1);
    if (padded) {
        memcpy(padded, json, length);
        memset(padded + length, ' ', spaces);
        padded[length + spaces] = '\0';
    }
    free(json);
    return padded;
}

static bool fill_part(const struct options *o, const struct frame_source *source,
                      const struct rendered_view *view, const char *device,
                      struct part_storage *storage, struct exr_new_part *part,
                      struct tool_error *err)
{
    const struct gbuffer *g = &view->gbuffer;
    const struct role *likeness = &g->roles.kind[o->mode == OUTPUT_COMP ? ROLE_COLOR : ROLE_DEPTH];
    version_string(storage->version);
    storage->params = record_write(o, &view->setting, view->name, g, device);
    if (storage->params)
        storage->params = pad_record(storage->params);
    if (!storage->params)
        return fail(err, EXIT_MEMORY, "%s: out of memory", source->info.path);
    storage->strings[0] = (struct exr_string){"vkao/version", storage->version};
    storage->strings[1] = (struct exr_string){"vkao/params", storage->params};
    storage->strings[2] = (struct exr_string){"vkao/source", text_base_name(source->info.path)};
    if (o->mode == OUTPUT_COMP)
        color_part_name(o, view, source->view_count, storage->name);
    const struct ao_names names = name_ao(o, &source->info, &g->roles.kind[ROLE_DEPTH], view->name);
    if (o->mode != OUTPUT_COMP)
        memcpy(storage->name, names.part, sizeof storage->name);
    memcpy(storage->channel, names.channel, sizeof storage->channel);
    /* A file that names its views in channels must not name them in parts as well. */
    bool views_in_channels = o->mode == OUTPUT_APPEND && source->info.parts[0].multi_view_count > 0;
    *part = (struct exr_new_part){
        .name = storage->name,
        .view = views_in_channels ? "" : view->name,
        .data_window = *output_window(o, g),
        .display_window = g->display_window,
        .pixel_aspect = g->pixel_aspect,
        .compression = o->compression,
        .channels = storage->channels,
        .channel_count = fill_channels(o, view, storage->channel, storage->channels),
        .strings = storage->strings,
        .string_count = STRINGS,
        .attributes_from = likeness->info,
        .attributes_from_part = likeness->part,
    };
    return true;
}

static bool prepare_exr(const struct options *o, const struct plan_frame *frame,
                        const struct frame_source *source, const struct rendered_view *views,
                        const char *device, struct atomic_file *file, struct tool_error *err)
{
    struct part_storage *storage = calloc(source->view_count, sizeof *storage);
    struct exr_new_part *parts = calloc(source->view_count, sizeof *parts);
    bool ok = storage && parts;
    if (!ok)
        fail(err, EXIT_MEMORY, "%s: out of memory", frame->output);
    for (size_t i = 0; ok && i < source->view_count; i++)
        ok = fill_part(o, source, &views[i], device, &storage[i], &parts[i], err);
    ok =
        ok && exr_prepare_file(file, frame->output, o->mode == OUTPUT_APPEND ? &source->info : NULL,
                               parts, source->view_count, o->overwrite == OVERWRITE_ALWAYS, err);
    for (size_t i = 0; storage && i < source->view_count; i++)
        free(storage[i].params);
    free(storage);
    free(parts);
    return ok;
}

/* --- PNG --- */

static bool prepare_preview(const struct options *o, const struct plan_frame *frame,
                            const char *path, const struct rendered_view *view,
                            struct atomic_file *file, struct tool_error *err)
{
    bool grey = o->mode != OUTPUT_COMP;
    const struct exr_box *window = output_window(o, &view->gbuffer);
    size_t texels = window_texels(window), bytes;
    if (!size_multiply(texels, grey ? 1 : 3, &bytes))
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    uint8_t *pixels = malloc(bytes);
    if (!pixels)
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    for (size_t i = 0; i < texels; i++) {
        if (grey)
            pixels[i] = byte_of((double)view->result.ao[i]);
        for (size_t c = 0; !grey && c < 3; c++)
            pixels[i * 3 + c] = byte_of(srgb_of((double)view->result.output[i * 4 + c]));
    }
    char key[] = PREVIEW_OWNER_KEY, *owner = preview_owner(path, frame->output);
    const struct png_picture picture = {
        .width = window_width(window),
        .height = window_height(window),
        .channels = grey ? 1 : 3,
        .pixels = pixels,
        .key = owner ? key : NULL,
        .text = owner,
    };
    bool ok = png_file_prepare(file, path, &picture, plan_replaces_preview(o, frame, path), err);
    free(owner);
    free(pixels);
    return ok;
}

static bool prepare_previews(const struct options *o, const struct plan_frame *frame,
                             const struct frame_source *source, const struct rendered_view *views,
                             struct atomic_file *files, struct tool_error *err)
{
    for (size_t i = 0; i < source->view_count; i++) {
        struct text path = {0};
        preview_path(frame->preview, views[i].name, source->view_count, &path);
        bool ok = path.data && !path.out_of_memory
                      ? prepare_preview(o, frame, path.data, &views[i], &files[i], err)
                      : fail(err, EXIT_MEMORY, "%s: out of memory", frame->preview);
        text_free(&path);
        if (!ok)
            return false;
    }
    return true;
}

/* The EXR file is the last: where it is, the frame is whole, whoever ends the run. What is left to
 * fail when all is written is a rename. Then nothing may stay that the next run would stop at. */
static bool commit_all(const struct options *o, const struct plan_frame *frame,
                       struct atomic_file *files, size_t count, struct tool_error *err)
{
    const size_t done = atomic_files_commit(files, count, err);
    /* Where somebody else has made the frame meanwhile, its previews are as good as theirs. */
    if (done < count && !plan_leaves(o, frame->output))
        atomic_files_withdraw(files, done);
    return done == count;
}

static size_t count_previews(const struct plan_frame *frame, const struct frame_source *source)
{
    return frame->preview ? source->view_count : 0;
}

bool output_prepare(const struct options *options, const struct plan_frame *frame,
                    const struct frame_source *source, const struct rendered_view *views,
                    const char *device, struct atomic_file *files, struct tool_error *err)
{
    const size_t previews = count_previews(frame, source);
    return (!previews || prepare_previews(options, frame, source, views, files, err)) &&
           prepare_exr(options, frame, source, views, device, &files[previews], err);
}

static bool write_files(const struct options *o, const struct plan_frame *frame,
                        const struct frame_source *source, const struct rendered_view *views,
                        const char *device, struct atomic_file *files, size_t previews,
                        struct tool_error *err)
{
    const bool ok = output_prepare(o, frame, source, views, device, files, err) &&
                    commit_all(o, frame, files, previews + 1, err);
    for (size_t i = 0; i <= previews; i++)
        atomic_file_abort(&files[i]);
    return ok;
}

/* Whether somebody who makes the same frame put a preview there after this run had looked. */
static bool has_preview_come(const struct options *o, const struct plan_frame *frame,
                             const struct atomic_file *files, size_t previews)
{
    for (size_t i = 0; i < previews; i++)
        if (files[i].path[0] && !files[i].replace && plan_replaces_preview(o, frame, files[i].path))
            return true;
    return false;
}

bool output_write(const struct options *options, const struct plan_frame *frame,
                  const struct frame_source *source, const struct rendered_view *views,
                  const char *device, struct tool_error *err)
{
    const size_t previews = count_previews(frame, source);
    struct atomic_file *files = calloc(previews + 1, sizeof *files);
    if (!files)
        return fail(err, EXIT_MEMORY, "%s: out of memory", frame->output);
    bool ok = write_files(options, frame, source, views, device, files, previews, err);
    if (!ok && has_preview_come(options, frame, files, previews)) {
        *err = (struct tool_error){0};
        ok = write_files(options, frame, source, views, device, files, previews, err);
    }
    free(files);
    return ok;
}
