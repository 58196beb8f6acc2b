/* SPDX-License-Identifier: MIT
 *
 * Facts are collected as JSON, once; inspect_print.c tells them. */
#include "commands.h"

#include "atomic_file.h"
#include "automatic.h"
#include "inspect_print.h"
#include "json_text.h"
#include "plan.h"
#include "views.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- Collecting --- */

static void add_box(cJSON *object, const char *name, const struct exr_box *box)
{
    const int values[] = {box->x_min, box->y_min, box->x_max, box->y_max};
    cJSON_AddItemToObject(object, name, cJSON_CreateIntArray(values, 4));
}

static cJSON *describe_part(const struct exr_part *part, size_t index)
{
    cJSON *object = cJSON_CreateObject();
    cJSON_AddNumberToObject(object, "index", (double)index);
    cJSON_AddStringToObject(object, "name", part->name ? part->name : "");
    cJSON_AddStringToObject(object, "view", part->view ? part->view : "");
    cJSON_AddStringToObject(object, "type", part->type);
    cJSON_AddStringToObject(object, "compression", part->compression);
    cJSON_AddStringToObject(object, "line_order", part->line_order);
    add_box(object, "data_window", &part->data_window);
    add_box(object, "display_window", &part->display_window);
    cJSON_AddNumberToObject(object, "pixel_aspect", (double)part->pixel_aspect);
    cJSON *channels = cJSON_AddArrayToObject(object, "channels");
    for (size_t i = 0; i < part->channel_count; i++) {
        const struct exr_channel *c = &part->channels[i];
        cJSON *channel = cJSON_CreateObject();
        cJSON_AddStringToObject(channel, "name", c->name);
        cJSON_AddStringToObject(channel, "type", pixel_type_name(c->type));
        cJSON_AddNumberToObject(channel, "x_sampling", c->x_sampling);
        cJSON_AddNumberToObject(channel, "y_sampling", c->y_sampling);
        cJSON_AddItemToArray(channels, channel);
    }
    return object;
}

static void add_roles(cJSON *object, const struct roles *roles)
{
    cJSON *list = cJSON_AddObjectToObject(object, "roles");
    for (int k = 0; k < ROLE_KINDS; k++) {
        const struct role *role = &roles->kind[k];
        if (!role->found) {
            /* Those that nothing but an option finds are not missed. */
            if (k < ROLE_THICKNESS)
                cJSON_AddNullToObject(list, role_names[k].key);
            continue;
        }
        cJSON *entry = cJSON_AddObjectToObject(list, role_names[k].key);
        cJSON_AddStringToObject(entry, "name", role->label);
        cJSON_AddStringToObject(entry, "file", role->info->path);
        cJSON_AddNumberToObject(entry, "part", (double)role->part);
        cJSON_AddStringToObject(entry, "type", pixel_type_name(role->channels[0]->type));
        cJSON *channels = cJSON_AddArrayToObject(entry, "channels");
        for (size_t c = 0; c < role->channel_count; c++)
            cJSON_AddItemToArray(channels, cJSON_CreateString(role->channels[c]->name));
    }
}

static void add_camera(cJSON *object, const struct camera *camera)
{
    cJSON *entry = cJSON_AddObjectToObject(object, "camera");
    bool ortho = camera->type == CAMERA_ORTHOGRAPHIC;
    if (camera->unsupported[0]) {
        cJSON_AddStringToObject(entry, "unsupported", camera->unsupported);
        return;
    }
    cJSON_AddStringToObject(entry, "type", ortho ? "orthographic" : "perspective");
    cJSON_AddStringToObject(entry, "source", camera->source[0] ? camera->source : "assumed");
    if (camera->remark[0])
        cJSON_AddStringToObject(entry, "remark", camera->remark);
    if (ortho)
        cJSON_AddNumberToObject(entry, "ortho_width", camera->half_width * 2.0);
    else
        cJSON_AddNumberToObject(entry, "fov_x_deg", camera_fov_x_deg(camera));
    if (camera->bound > 0)
        cJSON_AddNumberToObject(entry, "uncertainty", camera->bound);
    if (camera->near_plane > 0 && isfinite(camera->near_plane))
        cJSON_AddNumberToObject(entry, "near", camera->near_plane);
    if (camera->far_plane > 0 && isfinite(camera->far_plane))
        cJSON_AddNumberToObject(entry, "far", camera->far_plane);
    cJSON_AddNumberToObject(entry, "shift_x", camera->shift_x);
    cJSON_AddNumberToObject(entry, "shift_y", camera->shift_y);
    cJSON_AddStringToObject(entry, "rotation",
                            camera->has_rotation ? camera->rotation_source : "unknown");
}

static const char *const reason_names[] = {
    "none",          "--background",  "far plane",       "alpha is 0",
    "normals are 0", "far and alike", "taken for a wall"};
static const char *const source_names[] = {"assumed",
                                           "--depth-type",
                                           "by its name",
                                           "flat things are flat so",
                                           "agreement of the normals",
                                           "from positions",
                                           "convention of the program",
                                           "camera file",
                                           "--near and --far, or --depth-range"};

static void add_depth_facts(cJSON *entry, const struct gbuffer *g)
{
    cJSON_AddNumberToObject(entry, "min_z", g->min_z);
    cJSON_AddNumberToObject(entry, "median_z", g->median_z);
    cJSON_AddNumberToObject(entry, "max_z", g->max_z);
    cJSON_AddNumberToObject(entry, "background_share", g->background_share);
    cJSON_AddNumberToObject(entry, "invalid_share", g->invalid_share);
    cJSON_AddNumberToObject(entry, "filtered_share", g->filtered_share);
    cJSON_AddNumberToObject(entry, "block_size", g->block_size);
    cJSON_AddNumberToObject(entry, "noise", g->noise);
    const struct background *b = &g->background;
    cJSON *background = cJSON_AddObjectToObject(entry, "background");
    cJSON_AddStringToObject(background, "why", reason_names[b->reason]);
    if (b->reason != BACKGROUND_NONE)
        cJSON_AddNumberToObject(background, "value", b->value);
    if (b->has_point)
        cJSON_AddBoolToObject(background, "alone", true);
    else if (b->reason != BACKGROUND_NONE && b->reason != BACKGROUND_DOUBT)
        cJSON_AddNumberToObject(background, "from", b->limit);
    if (g->planes.count == 0)
        return;
    cJSON *planes = cJSON_AddObjectToObject(entry, "flat_things");
    cJSON_AddNumberToObject(planes, "planar", g->planes.planar);
    cJSON_AddNumberToObject(planes, "radial", g->planes.radial);
    cJSON_AddNumberToObject(planes, "linear", g->planes.linear);
    cJSON_AddNumberToObject(planes, "with_offset", g->planes.offset_share);
}

/* Without normals or positions wrong options look as right ones do. */
static void add_unconfirmed(cJSON *entry, const struct gbuffer *g)
{
    const enum depth_source source = g->depth_source;
    if (strcmp(g->camera.source, "positions") == 0)
        return;
    cJSON *list = cJSON_AddArrayToObject(entry, "unconfirmed");
    cJSON_AddItemToArray(list, cJSON_CreateString("camera"));
    if (source == DEPTH_ASSUMED || source == DEPTH_BY_OPTION || source == DEPTH_BY_NAME ||
        source == DEPTH_BY_CAMERA || source == DEPTH_BY_ENDS)
        cJSON_AddItemToArray(list, cJSON_CreateString("depth type"));
}

static void add_conventions(cJSON *object, const struct gbuffer *g)
{
    cJSON *entry = cJSON_AddObjectToObject(object, "conventions");
    cJSON_AddStringToObject(entry, "depth_type", depth_type_name(g->depth_type));
    if (!g->depth)
        return; /* pixels could not be used: the problem says why */
    cJSON_AddStringToObject(entry, "depth_source", source_names[g->depth_source]);
    add_depth_facts(entry, g);
    bool normals = g->normal_space != NORMAL_SPACE_AUTO;
    cJSON_AddStringToObject(entry, "normal_space",
                            normals ? normal_space_name(g->normal_space) : "none");
    if (!normals) {
        add_unconfirmed(entry, g);
        return;
    }
    cJSON_AddStringToObject(entry, "normal_encoding", normal_encoding_name(g->normal_encoding));
    cJSON_AddNumberToObject(entry, "normal_agreement", g->normal_agreement);
}

/* The camera as it is used: the normals may have told which way it looks, and what depth is, which
 * they might not through a camera that is told. */
static struct camera used_camera(const struct gbuffer *g)
{
    struct camera camera = g->camera;
    const enum depth_type named = g->roles.kind[ROLE_DEPTH].depth_type;
    if (g->depth_source == DEPTH_BY_NORMALS &&
        g->depth_type != (named != DEPTH_AUTO ? named : DEPTH_PLANAR))
        camera.depth_type = g->depth_type;
    for (int i = 0; g->normal_space == NORMAL_SPACE_WORLD && i < 9; i++)
        camera.world_to_view[i] = (double)g->view.normal_to_view[i % 3 * 3 + i / 3];
    if (g->normal_space == NORMAL_SPACE_WORLD && !g->camera.axis_certain &&
        camera.world_to_view[8] * g->camera.world_to_view[8] < 0)
        camera.translation[2] = -camera.translation[2];
    return camera;
}

static void add_passed_over(void *data, enum role_kind kind, const char *label, const char *reason)
{
    cJSON *entry = cJSON_CreateObject();
    cJSON_AddStringToObject(entry, "role", role_names[kind].key);
    cJSON_AddStringToObject(entry, "name", label);
    cJSON_AddStringToObject(entry, "why", reason);
    cJSON_AddItemToArray(data, entry);
}

/* What a role would be good for, if it is not there. */
static void add_missing(cJSON *object, const struct gbuffer_options *options,
                        const struct roles *roles)
{
    static const char *const gains[ROLE_AO] = {
        "nothing can be computed without: --depth NAME",
        "they would be derived from depth: a pass of unfiltered normals makes edges exact",
        "only --mode comp needs one: --color NAME"};
    cJSON *missing = cJSON_AddObjectToObject(object, "missing");
    for (int k = 0; k < ROLE_POSITION; k++)
        if (!roles->kind[k].found)
            cJSON_AddStringToObject(missing, role_names[k].key,
                                    k == ROLE_NORMAL && options->roles.no_normals ? "not wanted"
                                                                                  : gains[k]);
}

/* What a run would do with these options. */
static void add_verdict(cJSON *object, const struct options *options, const struct gbuffer *g,
                        bool ok, struct report *report)
{
    cJSON *entry = cJSON_AddObjectToObject(object, "verdict");
    cJSON_AddBoolToObject(entry, "can_be_processed", ok);
    if (!ok)
        return;
    /* It takes neither --radius nor --like. */
    const float radius = relative_radius_of(&options->relative_radius, g);
    check_radius(g, radius, report);
    cJSON_AddNumberToObject(entry, "radius", (double)radius);
    cJSON_AddTrueToObject(entry, "radius_is_auto");
    cJSON_AddNumberToObject(entry, "bias",
                            (double)automatic_bias(g, radius, options->setting.params.bias));
}

static void hear_warning(void *data, const char *warning)
{
    cJSON_AddItemToArray(data, cJSON_CreateString(warning));
}

/* NULL if memory ran out, or of a frame that shows nothing and is to wait; whatever else is wrong
 * becomes the problem, whose exit code is kept in *code. cameras: where the camera of the view
 * goes, as a camera file has it. */
static cJSON *describe_view(const struct options *options, const struct frame_source *source,
                            const struct view *view, cJSON *cameras, struct report *report,
                            int *code, struct tool_error *untold)
{
    struct gbuffer_options wanted = view_options(options, view);
    struct tool_error err = {0};
    struct gbuffer g;
    cJSON *object = cJSON_CreateObject(), *warnings = cJSON_CreateArray();
    struct report listening = *report;
    wanted.want_color = false;
    listening.heard = hear_warning;
    listening.heard_data = warnings;
    bool ok = gbuffer_load(&source->info, &wanted, view->camera, &listening, &g, &err);
    cJSON_AddStringToObject(object, "name", view->name);
    add_roles(object, &g.roles);
    add_missing(object, &wanted, &g.roles);
    roles_passed_over(&source->info, &wanted.roles, &g.roles, add_passed_over,
                      cJSON_AddArrayToObject(object, "passed_over"));
    if (g.width > 0) {
        const struct camera camera = used_camera(&g);
        if (camera.source[0] && !camera.unsupported[0])
            cJSON_AddItemToObject(cameras, view->name, camera_json(&camera));
        add_camera(object, &g.camera);
        add_conventions(object, &g);
    } else if (source->info.part_count > 0) {
        /* Without depth too, the header tells of the camera. */
        camera_resolve(&wanted.camera, view->camera, &source->info, 0, &g.camera);
        add_camera(object, &g.camera);
    }
    cJSON_AddItemToObject(object, "warnings", warnings);
    add_verdict(object, options, &g, ok, &listening);
    if (!ok) {
        cJSON_AddStringToObject(object, "problem", err.message);
        cJSON_AddStringToObject(object, "hint", err.hint);
        *code = *code ? *code : err.code;
    }
    gbuffer_free(&g);
    if (err.code != EXIT_MEMORY && !err.shows_nothing)
        return object;
    *untold = err;
    cJSON_Delete(object);
    return NULL;
}

static bool shows_something(const cJSON *view)
{
    const cJSON *facts = cJSON_GetObjectItemCaseSensitive(view, "conventions");
    const cJSON *median = cJSON_GetObjectItemCaseSensitive(facts, "median_z");
    return cJSON_IsNumber(median) && median->valuedouble > 0;
}

/* A file whose roles are not found is inspected all the same: that is what the command is for.
 * *code is then what a run would end with. Damaged files are an error. */
static cJSON *describe(const struct options *options, const struct plan_frame *frame,
                       cJSON *cameras, struct report *report, int *code, struct tool_error *err)
{
    struct frame_source source = {0};
    struct tool_error views_err = {0};
    if (!frame_source_read_header(frame->input, &source, err) ||
        !frame_source_read_files((const char *const *)frame->file, &source, err)) {
        frame_source_close(&source);
        return NULL;
    }
    const unsigned begun = json_begin();
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "file", frame->input);
    cJSON *parts = cJSON_AddArrayToObject(root, "parts");
    for (size_t i = 0; i < source.info.part_count; i++)
        cJSON_AddItemToArray(parts, describe_part(&source.info.parts[i], i));
    struct options every = *options;
    struct tool_error run_err = {0};
    frame_source_choose_views(options, frame->camera, &source, &run_err);
    if (!every.view && !every.gbuffer.roles.name[ROLE_DEPTH])
        every.view = roles_view_count(&source.info) > 0 ? "all" : NULL;
    cJSON *views = cJSON_AddArrayToObject(root, "views");
    if (!frame_source_choose_views(&every, frame->camera, &source, &views_err)) {
        if (views_err.code == EXIT_INPUT || views_err.code == EXIT_MEMORY)
            *err = views_err; /* a camera file that cannot be read is no fact about the image */
        cJSON_AddStringToObject(root, "problem", views_err.message);
        cJSON_AddStringToObject(root, "hint", views_err.hint);
        *code = views_err.code;
    } else {
        if (run_err.code) { /* views are told each, but a run wants one chosen */
            cJSON_AddStringToObject(root, "problem", run_err.message);
            cJSON_AddStringToObject(root, "hint", run_err.hint);
            *code = run_err.code;
        }
        struct options seen = *options;
        for (size_t i = 0; !err->code && i < source.view_count; i++) {
            cJSON *view =
                describe_view(&seen, &source, &source.views[i], cameras, report, code, err);
            if (seen.gbuffer.empty == EMPTY_IS_LATE && shows_something(view))
                seen.gbuffer.empty = EMPTY_IS_OPEN;
            cJSON_AddItemToArray(views, view);
        }
    }
    frame_source_close(&source);
    if (!err->code && json_is_whole(begun))
        return root;
    if (!err->code)
        fail(err, EXIT_MEMORY, "%s: out of memory", frame->input);
    cJSON_Delete(root);
    return NULL;
}

/* --- Writing the camera --- */

/* The views of a camera file, or its only camera. */
static char *camera_file_text(cJSON *cameras)
{
    const unsigned begun = json_begin();
    cJSON *only = cameras->child && !cameras->child->string[0] ? cameras->child : NULL;
    cJSON *root = only ? NULL : cJSON_CreateObject();
    if (root)
        cJSON_AddItemToObject(root, "views", cJSON_Duplicate(cameras, true));
    char *text = json_text(only ? only : root, true, begun);
    cJSON_Delete(root);
    return text;
}

static bool leaves_camera(const struct options *options, const struct plan_frame *frame,
                          const struct report *report)
{
    const bool is_left = plan_leaves(options, frame->write_camera);
    if (is_left)
        report_note(report, "%s: exists, left as it is", frame->write_camera);
    return is_left;
}

static bool write_camera(const struct options *options, const struct plan_frame *frame,
                         cJSON *cameras, const struct report *report, struct tool_error *err)
{
    struct atomic_file file = {0};
    const char *path = frame->write_camera;
    if (leaves_camera(options, frame, report))
        return true;
    if (!cameras->child) {
        fail_hint(err, "give it with --fov, --ortho or --camera");
        return fail(err, EXIT_CHANNELS, "%s: no camera was found: nothing to write to %s",
                    frame->input, path);
    }
    char *text = camera_file_text(cameras);
    if (!text)
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    bool ok = atomic_file_open(&file, path, options->overwrite == OVERWRITE_ALWAYS, err) &&
              atomic_file_write(&file, text, strlen(text), err) &&
              atomic_file_write(&file, "\n", 1, err) && atomic_file_commit(&file, err);
    atomic_file_abort(&file);
    free(text);
    return ok;
}

/* Of a frame that is told no further, unless it shows nothing. */
static bool write_only(const struct options *options, const struct plan_frame *frame,
                       const struct report *report, struct tool_error *err)
{
    struct options waiting = *options;
    struct report silent = {.verbosity = REPORT_QUIET};
    int code = EXIT_OK;
    waiting.gbuffer.empty = EMPTY_IS_LATE;
    if (leaves_camera(options, frame, report))
        return true;
    cJSON *cameras = cJSON_CreateObject();
    if (!cameras)
        return fail(err, EXIT_MEMORY, "%s: out of memory", frame->input);
    cJSON *root = describe(&waiting, frame, cameras, &silent, &code, err);
    const bool is_empty = !root && err->shows_nothing;
    if (is_empty) {
        report_note(report, "%s: no camera is written for it", err->message);
        *err = (struct tool_error){0};
    }
    const bool ok = is_empty || (root && write_camera(options, frame, cameras, report, err));
    cJSON_Delete(root);
    cJSON_Delete(cameras);
    return ok;
}

/* That of the frame that is told; with a frame token, those of the others too. */
static bool write_cameras(const struct options *options, const struct plan *plan, size_t told,
                          cJSON *cameras, const struct report *report, struct tool_error *err)
{
    const char *path = plan->frames[told].write_camera;
    if (!path)
        return true;
    if (!write_camera(options, &plan->frames[told], cameras, report, err))
        return false;
    for (size_t i = told + 1; i < plan->count; i++)
        if (strcmp(plan->frames[i].write_camera, path) != 0 &&
            !write_only(options, &plan->frames[i], report, err))
            return false;
    return true;
}

/* Of a sequence, its first frame that shows something; the first one if none does. */
static cJSON *describe_first(const struct options *options, const struct plan *plan, cJSON *cameras,
                             struct report *report, struct report *silent, int *code, size_t *told,
                             struct tool_error *err)
{
    struct options waiting = *options;
    waiting.gbuffer.empty = EMPTY_IS_LATE;
    for (*told = 0; plan->count > 1 && *told < plan->count; ++*told) {
        struct report listening = *silent;
        cJSON *root = describe(&waiting, &plan->frames[*told], cameras, &listening, code, err);
        if (root || !err->shows_nothing)
            return root;
        report_note(report, "%s: the first frame that shows something is told", err->message);
        *err = (struct tool_error){0};
        *code = EXIT_OK;
    }
    *told = 0;
    return describe(options, &plan->frames[0], cameras, silent, code, err);
}

/* Ends as a run would end. */
int command_inspect(const struct options *options, struct report *report)
{
    size_t told = 0;
    int code = EXIT_OK;
    struct tool_error err = {0};
    struct plan plan;
    if (plan_make(options, &plan, &err)) {
        plan_say_cameras(&plan, report);
        struct report silent = *report;
        silent.verbosity = report->verbosity == REPORT_VERBOSE ? REPORT_VERBOSE : REPORT_QUIET;
        cJSON *cameras = cJSON_CreateObject();
        cJSON *root = NULL;
        if (!cameras)
            fail(&err, EXIT_MEMORY, "%s: out of memory", plan.frames[0].input);
        else
            root = describe_first(options, &plan, cameras, report, &silent, &code, &told, &err);
        if (root && write_cameras(options, &plan, told, cameras, report, &err))
            inspect_print(root, options->json, &err);
        cJSON_Delete(root);
        cJSON_Delete(cameras);
        plan_free(&plan);
    }
    if (err.code != EXIT_OK)
        report_error(&err);
    return err.code != EXIT_OK ? err.code : code;
}
