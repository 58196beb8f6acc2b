/* SPDX-License-Identifier: MIT */
#include "views.h"

#include "ao.h"

#include <string.h>

static void list_views(const struct exr_info *info, struct text *list)
{
    for (size_t i = 0; i < roles_view_count(info); i++)
        text_add(list, "%s%s", i ? ", " : "", roles_view_name(info, i));
}

/* Of a camera file, or of the records. */
static bool has_named_cameras(const struct frame_source *source)
{
    return (source->cameras.count > 0 && source->cameras.views[0].name[0]) ||
           (source->records.count > 0 && source->records.records[0].view[0]);
}

/* The view that was asked for, NULL if none was: by an option, or by a record of only one. */
static const char *wanted_view(const struct options *options, const struct frame_source *source)
{
    const struct record_set *set = &source->records;
    if (options->view)
        return options->view;
    return set->count == 1 && set->records[0].view[0] ? set->records[0].view : NULL;
}

struct gbuffer_options view_options(const struct options *options, const struct view *view)
{
    struct gbuffer_options g = options->gbuffer;
    g.roles.view = view->name;
    memcpy(g.roles.file, view->file, sizeof g.roles.file);
    return g;
}

void view_reserve_work(struct gbuffer_options *options, const vkao_effect_info *effect)
{
    struct gbuffer_options *o = options;
    o->work_texel_bytes = ao_job_texel_bytes(false, o->want_color, effect);
    o->work_normals_texel_bytes =
        ao_job_texel_bytes(true, o->want_color, effect) - o->work_texel_bytes;
}

static struct view view_of(const struct frame_source *source, const char *name)
{
    struct view view = {.name = name};
    for (int kind = 0; kind < ROLE_FILES; kind++)
        view.file[kind] = source->files[kind].path ? &source->files[kind] : NULL;
    return view;
}

/* camera_name differs from name where a mono image was made by one camera of a stereo pair. */
static bool add_view(struct frame_source *source, const char *name, const char *camera_name,
                     const char *camera_path, struct tool_error *err)
{
    if (source->view_count == MAX_VIEWS)
        return fail(err, EXIT_CHANNELS, "%s: more than %d views; choose one with --view",
                    source->info.path, MAX_VIEWS);
    struct view *view = &source->views[source->view_count++];
    *view = view_of(source, name);
    view->record = record_set_find(&source->records, camera_name);
    if (source->records.count > 0 && !view->record) {
        fail_hint(err, "choose a view with --view NAME");
        return fail(err, EXIT_CHANNELS, "%s: the file of --like has no record of view '%s'",
                    source->info.path, camera_name);
    }
    if (!camera_path && view->record)
        view->camera = &view->record->camera;
    if (source->cameras.count == 0)
        return true;
    view->camera = camera_set_find(&source->cameras, camera_name);
    if (view->camera)
        return true;
    struct text list = {0};
    for (size_t i = 0; i < source->cameras.count; i++)
        text_add(&list, "%s%s", i ? ", " : "", source->cameras.views[i].name);
    if (*camera_name)
        fail(err, EXIT_CHANNELS, "%s: no camera for view '%s', only for %s", camera_path,
             camera_name, list.data ? list.data : "none");
    else
        fail(err, EXIT_CHANNELS, "%s: cameras for the views %s, but %s has no views", camera_path,
             list.data ? list.data : "none", source->info.path);
    fail_hint(err, "choose a camera with --view NAME");
    text_free(&list);
    return false;
}

/* Without --view: a --depth that names the channel of one view chooses that view. */
static bool add_views_with_depth(const struct options *options, const char *camera_path,
                                 struct frame_source *source, struct tool_error *err)
{
    const struct exr_info *info = &source->info;
    for (size_t i = 0; i < roles_view_count(info); i++) {
        const struct view view = view_of(source, roles_view_name(info, i));
        struct role_request request = view_options(options, &view).roles;
        struct roles *roles = &(struct roles){0};
        struct tool_error unseen = {0};
        for (int kind = ROLE_DEPTH + 1; kind < ROLE_KINDS; kind++)
            request.name[kind] = NULL;
        request.file[ROLE_NORMAL] = request.file[ROLE_COLOR] = NULL;
        request.no_normals = true;
        if (roles_resolve(info, &request, roles, &unseen) &&
            !roles->kind[ROLE_DEPTH].of_another_view &&
            !add_view(source, view.name, view.name, camera_path, err))
            return false;
    }
    return true;
}

static bool fail_many_views(const struct exr_info *info, struct tool_error *err)
{
    struct text list = {0};
    list_views(info, &list);
    fail(err, EXIT_CHANNELS, "%s: several views: %s", info->path, list.data ? list.data : "");
    fail_hint(err, "add --view NAME, --view all, or --camera FILE.json with \"views\"");
    text_free(&list);
    return false;
}

static bool add_named_view(const char *wanted, const char *camera_path, struct frame_source *source,
                           struct tool_error *err)
{
    const struct exr_info *info = &source->info;
    size_t count = roles_view_count(info);
    for (size_t i = 0; i < count; i++)
        if (strcmp(roles_view_name(info, i), wanted) == 0)
            return add_view(source, roles_view_name(info, i), wanted, camera_path, err);
    if (count == 0 && has_named_cameras(source))
        return add_view(source, "", wanted, camera_path, err);
    struct text list = {0};
    list_views(info, &list);
    fail(err, EXIT_CHANNELS, "%s: no view '%s'; views: %s", info->path, wanted,
         list.data ? list.data : "none");
    text_free(&list);
    return false;
}

bool frame_source_choose_views(const struct options *options, const char *camera_path,
                               struct frame_source *source, struct tool_error *err)
{
    const struct exr_info *info = &source->info;
    size_t count = roles_view_count(info);
    source->view_count = 0;
    if (camera_path && source->cameras.count == 0 &&
        !camera_set_read(camera_path, &source->cameras, err))
        return false;
    const char *wanted = wanted_view(options, source);
    bool all = wanted && strcmp(wanted, "all") == 0;
    if (wanted && !all)
        return add_named_view(wanted, camera_path, source, err);
    if (count == 0)
        return add_view(source, "", "", camera_path, err);
    if (!all && count > 1 && options->gbuffer.roles.name[ROLE_DEPTH]) {
        if (!add_views_with_depth(options, camera_path, source, err))
            return false;
        bool enough = source->view_count == 1 || has_named_cameras(source);
        if (source->view_count > 0 && enough)
            return true;
        source->view_count = 0;
    }
    if (!all && count > 1 && !has_named_cameras(source))
        return fail_many_views(info, err);
    for (size_t i = 0; i < count; i++) {
        const char *name = roles_view_name(info, i);
        if (!add_view(source, name, name, camera_path, err))
            return false;
    }
    return true;
}

bool frame_source_read_header(const char *path, struct frame_source *source, struct tool_error *err)
{
    *source = (struct frame_source){0};
    return exr_info_read(path, &source->info, err);
}

bool frame_source_read_files(const char *const paths[ROLE_FILES], struct frame_source *source,
                             struct tool_error *err)
{
    for (int kind = 0; kind < ROLE_FILES; kind++)
        if (paths[kind] && !exr_info_read(paths[kind], &source->files[kind], err))
            return false;
    return true;
}

bool frame_source_read_like(const char *like_path, struct frame_source *source,
                            struct tool_error *err)
{
    return record_set_read(like_path, &source->records, err);
}

bool frame_source_open(const struct options *options, const char *path, const char *camera_path,
                       struct frame_source *source, struct tool_error *err)
{
    return frame_source_read_header(path, source, err) &&
           frame_source_choose_views(options, camera_path, source, err);
}

void frame_source_close(struct frame_source *source)
{
    exr_info_free(&source->info);
    for (int kind = 0; kind < ROLE_FILES; kind++)
        exr_info_free(&source->files[kind]);
    camera_set_free(&source->cameras);
    record_set_free(&source->records);
    *source = (struct frame_source){0};
}
