/* SPDX-License-Identifier: MIT */
#include "plan.h"

#include "atomic_file.h"
#include "preview.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum path_kind {
    PATH_INPUT,
    PATH_OUTPUT,
    PATH_PREVIEW,
    PATH_WRITE_CAMERA,
    PATH_CAMERA,
    PATH_LIKE,
    PATH_DEPTH,
    PATH_NORMAL,
    PATH_COLOR,
    PATH_KINDS
};

struct patterns {
    struct frame_pattern of[PATH_KINDS];
    bool given[PATH_KINDS];
};

/* one_for_all: one file may serve all frames. extension: what is written there. */
static const struct {
    const char *name;
    bool is_written, one_for_all;
    const char *extension, *format;
} path_table[PATH_KINDS] = {
    [PATH_INPUT] = {.name = "INPUT"},
    [PATH_OUTPUT] = {.name = "--output", .is_written = true},
    [PATH_PREVIEW] = {.name = "--preview",
                      .is_written = true,
                      .extension = ".png",
                      .format = "PNG"},
    [PATH_WRITE_CAMERA] = {.name = "--write-camera",
                           .is_written = true,
                           .one_for_all = true,
                           .extension = ".json",
                           .format = "JSON"},
    [PATH_CAMERA] = {.name = "--camera", .one_for_all = true},
    [PATH_LIKE] = {.name = "--like", .one_for_all = true},
    [PATH_DEPTH] = {.name = "--depth-file"},
    [PATH_NORMAL] = {.name = "--normal-file"},
    [PATH_COLOR] = {.name = "--color-file"},
};

static bool camera_is_none(const struct options *o)
{
    return o->camera_file && strcmp(o->camera_file, "none") == 0;
}

/* What the options say. */
static const char *given_path(const struct options *o, enum path_kind kind)
{
    const char *const paths[PATH_KINDS] = {
        [PATH_INPUT] = o->input,
        [PATH_OUTPUT] = o->output,
        [PATH_PREVIEW] = o->preview,
        [PATH_WRITE_CAMERA] = o->write_camera,
        [PATH_CAMERA] = camera_is_none(o) ? NULL : o->camera_file,
        [PATH_LIKE] = o->like,
        [PATH_DEPTH] = o->file[ROLE_DEPTH],
        [PATH_NORMAL] = o->file[ROLE_NORMAL],
        [PATH_COLOR] = o->file[ROLE_COLOR],
    };
    return paths[kind];
}

static char **path_of(struct plan_frame *frame, enum path_kind kind)
{
    char **paths[PATH_KINDS] = {
        [PATH_INPUT] = &frame->input,
        [PATH_OUTPUT] = &frame->output,
        [PATH_PREVIEW] = &frame->preview,
        [PATH_WRITE_CAMERA] = &frame->write_camera,
        [PATH_CAMERA] = &frame->camera,
        [PATH_LIKE] = &frame->like,
        [PATH_DEPTH] = &frame->file[ROLE_DEPTH],
        [PATH_NORMAL] = &frame->file[ROLE_NORMAL],
        [PATH_COLOR] = &frame->file[ROLE_COLOR],
    };
    return paths[kind];
}

static bool exists(const char *path)
{
    struct stat s;
    return lstat(path, &s) == 0;
}

/* A file that is really called 'x#1.exr' is no pattern; nor is 'x@2x.exr' one that is to be written
 * where there is nothing to count. */
static bool is_literal(const char *path, enum path_kind kind, bool is_sequence)
{
    size_t length;
    if (!path_table[kind].is_written)
        return exists(path);
    return !is_sequence && !frame_token_that_is_clear(path, &length);
}

static bool parse_pattern(const char *path, bool literally, struct frame_pattern *pattern,
                          struct tool_error *err)
{
    if (!literally)
        return frame_pattern_parse(path, pattern, err);
    *pattern = (struct frame_pattern){.prefix = text_copy(path, strlen(path))};
    return pattern->prefix || fail(err, EXIT_MEMORY, "%s: out of memory", path);
}

static bool fail_token(const struct options *o, enum path_kind kind, struct tool_error *err)
{
    const char *path = given_path(o, kind);
    size_t length = 0;
    const char *token = frame_token_that_is_clear(path, &length);
    if (token)
        fail_hint(err, "'%.*s' stands for the number of a frame: INPUT needs one too", (int)length,
                  token);
    return fail(err, EXIT_USAGE, "%s '%s' has a frame token, but INPUT '%s' has none",
                path_table[kind].name, path, o->input);
}

static bool parse_patterns(const struct options *o, struct patterns *patterns,
                           struct tool_error *err)
{
    *patterns = (struct patterns){0};
    bool is_sequence = false;
    for (int k = 0; k < PATH_KINDS; k++) {
        const enum path_kind kind = (enum path_kind)k;
        const char *path = given_path(o, kind);
        patterns->given[k] = path != NULL;
        if (path &&
            !parse_pattern(path, is_literal(path, kind, is_sequence), &patterns->of[k], err))
            return false;
        if (kind == PATH_INPUT)
            is_sequence = frame_pattern_has_token(&patterns->of[k]);
        else if (path && !is_sequence && frame_pattern_has_token(&patterns->of[k]))
            return fail_token(o, kind, err);
    }
    return true;
}

static void free_patterns(struct patterns *patterns)
{
    for (int k = 0; k < PATH_KINDS; k++)
        frame_pattern_free(&patterns->of[k]);
}

/* Many frames written to one file would leave the last alone, and one depth is not that of all. */
static bool check_tokens(const struct options *o, const struct patterns *patterns, size_t frames,
                         struct tool_error *err)
{
    for (int k = 0; frames > 1 && k < PATH_KINDS; k++) {
        if (!patterns->given[k] || path_table[k].one_for_all ||
            frame_pattern_has_token(&patterns->of[k]))
            continue;
        fail_hint(err, "put #### where the frame number belongs");
        return fail(err, EXIT_USAGE, "%s '%s' has no frame token, but there are %zu frames",
                    path_table[k].name, given_path(o, (enum path_kind)k), frames);
    }
    return true;
}

static const char *found_path(const struct frame_list *found, int64_t number)
{
    size_t low = 0, high = found->count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (found->frames[middle].number < number)
            low = middle + 1;
        else
            high = middle;
    }
    return low < found->count && found->frames[low].number == number ? found->frames[low].path
                                                                     : NULL;
}

static bool add_frame(const struct patterns *patterns, const struct frame_list *found,
                      int64_t number, struct plan *plan, struct tool_error *err)
{
    struct plan_frame *frame = &plan->frames[plan->count++];
    frame->number = number;
    for (int k = 0; k < PATH_KINDS; k++) {
        if (!patterns->given[k])
            continue;
        const char *path = k == PATH_INPUT ? found_path(found, number) : NULL;
        char *copy =
            path ? text_copy(path, strlen(path)) : frame_pattern_path(&patterns->of[k], number);
        if (!copy)
            return fail(err, EXIT_MEMORY, "out of memory for a list of frames");
        *path_of(frame, (enum path_kind)k) = copy;
    }
    return true;
}

static bool add_frames(const struct options *o, const struct patterns *patterns,
                       const struct frame_list *wanted, const struct frame_list *found,
                       struct plan *plan, struct tool_error *err)
{
    if (!check_tokens(o, patterns, wanted->count, err))
        return false;
    plan->frames = calloc(wanted->count, sizeof *plan->frames);
    if (!plan->frames)
        return fail(err, EXIT_MEMORY, "out of memory for %zu frames", wanted->count);
    for (size_t i = 0; i < wanted->count; i++)
        if (!add_frame(patterns, found, wanted->frames[i].number, plan, err))
            return false;
    frame_list_describe(found, plan->found, sizeof plan->found);
    return true;
}

static bool list_frames(const struct options *o, const struct patterns *patterns, struct plan *plan,
                        struct tool_error *err)
{
    struct frame_list wanted = {0}, found = {0};
    struct tool_error unseen = {0};
    bool ok = true;
    plan->is_sequence = frame_pattern_has_token(&patterns->of[PATH_INPUT]);
    if (o->frames)
        ok = frame_list_parse(o->frames, o->frame_syntax, &wanted, err);
    if (ok && plan->is_sequence) {
        /* Named frames may lie in a directory that cannot be listed. */
        ok = frame_pattern_scan(&patterns->of[PATH_INPUT], &found, o->frames ? &unseen : err) ||
             o->frames;
        if (ok && !o->frames && found.count == 0)
            ok = fail(err, EXIT_INPUT, "%s: no file matches", o->input);
    }
    struct frame one = {0};
    const struct frame_list single = {&one, 1};
    const struct frame_list *list = o->frames ? &wanted : plan->is_sequence ? &found : &single;
    ok = ok && add_frames(o, patterns, list, &found, plan, err);
    frame_list_free(&wanted);
    frame_list_free(&found);
    return ok;
}

/* FILE.exr -> FILE.camera.json, malloc'ed; NULL if memory runs out. */
static char *camera_path_beside(const char *input)
{
    struct text path = {0};
    size_t stem = strlen(input);
    if (text_ends_with(input, ".exr"))
        stem -= strlen(".exr");
    text_add(&path, "%.*s.camera.json", (int)stem, input);
    if (path.out_of_memory)
        text_free(&path);
    return path.data;
}

bool plan_take_cameras(const struct options *options, struct plan *plan, struct tool_error *err)
{
    size_t beside = 0;
    if (options->camera_file || options->like)
        return true;
    for (size_t i = 0; i < plan->count; i++) {
        struct plan_frame *frame = &plan->frames[i];
        if (!frame->camera && exists(frame->input))
            frame->camera = camera_path_beside(frame->input);
        if (!frame->camera && exists(frame->input))
            return fail(err, EXIT_MEMORY, "%s: out of memory", frame->input);
        beside += frame->camera && exists(frame->camera);
    }
    plan->cameras_lie_beside = beside > 0;
    for (size_t i = 0; beside == 0 && i < plan->count; i++) {
        free(plan->frames[i].camera);
        plan->frames[i].camera = NULL;
    }
    return true;
}

void plan_say_cameras(const struct plan *plan, const struct report *report)
{
    for (size_t i = 0; plan->cameras_lie_beside && i < plan->count; i++) {
        if (!plan->frames[i].camera)
            continue;
        report_note(report, "camera: %s, beside the input%s; --camera takes another, or none",
                    plan->frames[i].camera, plan->is_sequence ? ", and so for each frame" : "");
        return;
    }
}

/* The directory of a path, malloc'ed; NULL if memory runs out. */
static char *directory_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    if (!slash)
        return text_copy(".", 1);
    return text_copy(path, slash == path ? 1 : (size_t)(slash - path));
}

/* Which file a path of a frame leads to. */
struct place {
    dev_t device;
    ino_t inode;
    const char *name; /* of what is still to be written, in that directory; "" of what is there */
    const char *path;
    const struct plan_frame *frame;
    enum path_kind kind;
};

static bool find_place(struct plan_frame *frame, enum path_kind kind, struct place *place,
                       struct tool_error *err)
{
    struct stat s = {0};
    const char *path = *path_of(frame, kind);
    *place = (struct place){.name = "", .path = path, .frame = frame, .kind = kind};
    if (stat(path, &s) != 0) {
        char *directory = directory_of(path);
        if (!directory)
            return fail(err, EXIT_MEMORY, "%s: out of memory", path);
        const bool is_there = stat(directory, &s) == 0;
        place->name = is_there ? text_base_name(path) : path;
        if (!is_there)
            s = (struct stat){0};
        free(directory);
    }
    place->device = s.st_dev;
    place->inode = s.st_ino;
    return true;
}

static int compare_files(const struct place *a, const struct place *b)
{
    if (a->device != b->device)
        return a->device < b->device ? -1 : 1;
    if (a->inode != b->inode)
        return a->inode < b->inode ? -1 : 1;
    return strcmp(a->name, b->name);
}

static int compare_places(const void *a, const void *b)
{
    const struct place *x = a, *y = b;
    const int files = compare_files(x, y);
    if (files != 0)
        return files;
    if (x->frame != y->frame)
        return x->frame < y->frame ? -1 : 1;
    return x->kind < y->kind ? -1 : x->kind > y->kind;
}

static bool fail_same(const struct plan *plan, const struct place *written,
                      const struct place *other, struct tool_error *err)
{
    const char *what = path_table[written->kind].name, *with = path_table[other->kind].name;
    if (written->frame == other->frame || !plan->is_sequence) {
        fail_hint(err, "write to another file; --mode append keeps all of the input in it");
        return fail(err, EXIT_USAGE, "%s: %s and %s are the same file", written->path, what, with);
    }
    fail_hint(err, "write to other files, or remove links among them");
    return fail(err, EXIT_USAGE,
                "%s: %s of frame %" PRId64 " and %s of frame %" PRId64 " are the same file",
                written->path, what, written->frame->number, with, other->frame->number);
}

/* Whether two paths that lead to one file may: of two frames one may serve both, and to write a
 * camera where it was read changes nothing of the picture. */
static bool may_share(enum path_kind written, enum path_kind other)
{
    return (written == other && path_table[written].one_for_all) ||
           (written == PATH_WRITE_CAMERA && other == PATH_CAMERA);
}

/* Of paths to one file, in the order of the frames. */
static bool check_shared(const struct plan *plan, const struct place *places, size_t count,
                         struct tool_error *err)
{
    const struct place *first[PATH_KINDS] = {NULL}, *last[PATH_KINDS] = {NULL};
    for (size_t i = 0; i < count; i++) {
        const enum path_kind kind = places[i].kind;
        first[kind] = first[kind] ? first[kind] : &places[i];
        last[kind] = &places[i];
    }
    for (int w = 0; w < PATH_KINDS; w++)
        for (int k = 0; path_table[w].is_written && first[w] && k < PATH_KINDS; k++)
            if (last[k] && last[k] != first[w] && !may_share((enum path_kind)w, (enum path_kind)k))
                return fail_same(plan, first[w], w == k ? last[k] : first[k], err);
    return true;
}

/* Nothing that a frame writes may be what it, or any other frame, reads or writes. */
static bool check_distinct(const struct plan *plan, struct tool_error *err)
{
    struct place *places = malloc((plan->count * PATH_KINDS + 1) * sizeof *places);
    size_t count = 0, end;
    bool ok = places || fail(err, EXIT_MEMORY, "out of memory for a list of files");
    for (size_t i = 0; ok && i < plan->count; i++)
        for (int k = 0; ok && k < PATH_KINDS; k++)
            if (*path_of(&plan->frames[i], (enum path_kind)k))
                ok = find_place(&plan->frames[i], (enum path_kind)k, &places[count++], err);
    if (ok)
        qsort(places, count, sizeof *places, compare_places);
    for (size_t i = 0; ok && i < count; i = end) {
        for (end = i + 1; end < count && compare_files(&places[i], &places[end]) == 0; end++)
            continue;
        ok = check_shared(plan, places + i, end - i, err);
    }
    free(places);
    return ok;
}

/* What the name of a file says of its contents must be true, as of OUTPUT. */
static bool check_names(const struct options *o, struct tool_error *err)
{
    for (int k = 0; k < PATH_KINDS; k++) {
        const char *path = given_path(o, (enum path_kind)k);
        const char *extension = path_table[k].extension;
        if (!path || !extension || text_has_extension(path, extension))
            continue;
        fail_hint(err, "%s %s%s", path_table[k].name, path, extension);
        return fail(err, EXIT_USAGE,
                    "%s is '%s', want a name that ends in %s: %s is what is "
                    "written",
                    path_table[k].name, path, extension, path_table[k].format);
    }
    return true;
}

/* A dead link is in the way of whoever makes the directory. */
static void hint_at_directory(const char *directory, struct tool_error *err)
{
    char target[256];
    const ssize_t length = readlink(directory, target, sizeof target - 1);
    if (length < 0) {
        fail_hint(err, "make it first: mkdir -p '%s'", directory);
        return;
    }
    target[length] = '\0';
    fail_hint(err, "it is a symbolic link to '%s': make that first, or remove the link", target);
}

/* Where there is no directory, no AO needs to be computed. */
static bool check_directory(const char *path, struct tool_error *err)
{
    struct stat s;
    char *directory = directory_of(path);
    if (!directory)
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    bool ok = stat(directory, &s) == 0 && S_ISDIR(s.st_mode);
    if (!ok) {
        hint_at_directory(directory, err);
        fail(err, EXIT_OUTPUT, "%s: cannot create: there is no directory %s", path, directory);
    }
    free(directory);
    return ok;
}

bool plan_leaves(const struct options *options, const char *path)
{
    struct stat s;
    return options->overwrite == OVERWRITE_SKIP && stat(path, &s) == 0 && S_ISREG(s.st_mode) &&
           s.st_size > 0;
}

/* Of an output that is in the way, with the remedy. */
static bool fail_exists(const struct options *options, const char *path, struct tool_error *err)
{
    fail(err, EXIT_OUTPUT, "%s: exists, not overwritten", path);
    return fail_hint(err, options->overwrite == OVERWRITE_SKIP
                              ? "remove it, or make all frames anew with --overwrite always"
                              : "add --overwrite always");
}

static bool check_place(const struct options *options, const char *path, bool is_replaced,
                        struct tool_error *err)
{
    struct stat s;
    if (!is_replaced && stat(path, &s) == 0)
        return fail_exists(options, path, err);
    return atomic_file_check(path, err);
}

bool plan_replaces_preview(const struct options *options, const struct plan_frame *frame,
                           const char *path)
{
    return options->overwrite == OVERWRITE_ALWAYS ||
           (options->overwrite == OVERWRITE_SKIP && !exists(frame->output) &&
            preview_is_of(path, frame->output));
}

bool plan_check_preview(const struct options *options, const struct plan_frame *frame,
                        const char *path, struct tool_error *err)
{
    return check_place(options, path, plan_replaces_preview(options, frame, path), err);
}

bool plan_check_outputs(const struct options *options, const struct plan_frame *frame,
                        struct tool_error *err)
{
    const char *output = frame->output, *preview = frame->preview;
    if (!check_directory(output, err) || (preview && !check_directory(preview, err)))
        return false;
    return frame->is_left ||
           (check_place(options, output, options->overwrite == OVERWRITE_ALWAYS, err) &&
            (!preview || plan_check_preview(options, frame, preview, err)));
}

/* Somebody else may have made the frame since it was looked for. */
static bool check_outputs_now(const struct options *options, struct plan_frame *frame,
                              struct tool_error *err)
{
    if (plan_check_outputs(options, frame, err))
        return true;
    frame->is_left = plan_leaves(options, frame->output);
    if (frame->is_left)
        *err = (struct tool_error){0};
    return frame->is_left;
}

/* Of inspect, which is told whether a camera exists when it comes to write it: one of a frame that
 * shows nothing is in nobody's way. */
static bool check_camera_place(const struct options *options, const struct plan_frame *frame,
                               struct tool_error *err)
{
    const char *path = frame->write_camera;
    struct stat s;
    if (!path ||
        (options->overwrite != OVERWRITE_ALWAYS && stat(path, &s) == 0 && S_ISREG(s.st_mode)))
        return true;
    return check_directory(path, err) && atomic_file_check(path, err);
}

bool plan_fail_of_frame(const struct plan_frame *frame, struct tool_error *err)
{
    for (int kind = 0; kind < ROLE_FILES; kind++)
        if (frame->file[kind] && text_starts_with(err->message, frame->file[kind]))
            return false;
    return fail_of(err, frame->input);
}

/* A camera that the hundredth frame lacks is found before the first is computed. The input may be
 * missing: what there is of a sequence is told when its frame comes. */
static bool check_there(const struct plan *plan, struct tool_error *err)
{
    for (int k = PATH_INPUT + 1; k < PATH_KINDS; k++) {
        for (size_t i = 0; !path_table[k].is_written && i < plan->count; i++) {
            const char *path = *path_of(&plan->frames[i], (enum path_kind)k);
            struct stat s;
            if (!path || stat(path, &s) == 0)
                continue;
            if (k == PATH_CAMERA && plan->cameras_lie_beside)
                fail_hint(err,
                          "other frames have one beside them; --camera FILE serves all frames, "
                          "--camera none leaves these out");
            else if (plan->is_sequence)
                fail_hint(err, "it is %s of frame %" PRId64 ", input %s", path_table[k].name,
                          plan->frames[i].number, plan->frames[i].input);
            return fail(err, EXIT_INPUT, "%s: cannot open: %s", path, strerror(errno));
        }
    }
    return true;
}

/* What they say too: one that is wrong would end the run in its middle. */
static bool check_cameras(const struct plan *plan, struct tool_error *err)
{
    for (size_t i = 0; i < plan->count; i++) {
        struct camera_set cameras = {0};
        const char *path = plan->frames[i].camera;
        const char *before = i > 0 ? plan->frames[i - 1].camera : NULL;
        if (!path || (before && strcmp(path, before) == 0))
            continue;
        if (!camera_set_read(path, &cameras, err))
            return false;
        camera_set_free(&cameras);
    }
    return true;
}

bool plan_make(const struct options *options, struct plan *plan, struct tool_error *err)
{
    struct patterns patterns;
    *plan = (struct plan){0};
    bool ok = parse_patterns(options, &patterns, err) &&
              list_frames(options, &patterns, plan, err) && plan_take_cameras(options, plan, err);
    ok = ok && check_distinct(plan, err) && check_names(options, err);
    for (size_t i = 0; ok && options->output && i < plan->count; i++)
        plan->frames[i].is_left = plan_leaves(options, plan->frames[i].output);
    for (size_t i = 0; ok && options->output && !options->continue_on_error && i < plan->count; i++)
        ok = check_outputs_now(options, &plan->frames[i], err);
    for (size_t i = 0; ok && i < plan->count; i++)
        ok = check_camera_place(options, &plan->frames[i], err);
    ok = ok && (options->continue_on_error || check_there(plan, err));
    if (ok && options->output && !options->continue_on_error)
        ok = check_cameras(plan, err);
    free_patterns(&patterns);
    if (!ok)
        plan_free(plan);
    return ok;
}

void plan_free(struct plan *plan)
{
    for (size_t i = 0; i < plan->count; i++)
        for (int k = 0; k < PATH_KINDS; k++)
            free(*path_of(&plan->frames[i], (enum path_kind)k));
    free(plan->frames);
    plan->frames = NULL;
    plan->count = 0;
}
