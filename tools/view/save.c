/* SPDX-License-Identifier: MIT
 *
 * Save: the picture as PNG, the values as EXR, and the command line of vkao that makes them. Files
 * are written as vkao itself writes them. */
#include "save.h"

#include "atomic_file.h"
#include "png_file.h"
#include "shell.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static bool exists(const char *path)
{
    struct stat s;
    return lstat(path, &s) == 0;
}

static void fill_names(struct save_names *n, const char *stem, unsigned number)
{
    char tail[16] = "";
    if (number > 1)
        snprintf(tail, sizeof tail, ".%u", number);
    snprintf(n->exr, sizeof n->exr, "%.*s%s.exr", SAVE_STEM_MAX, stem, tail);
    snprintf(n->png, sizeof n->png, "%.*s%s.png", SAVE_STEM_MAX, stem, tail);
    snprintf(n->script, sizeof n->script, "%.*s%s.sh", SAVE_STEM_MAX, stem, tail);
    snprintf(n->gbuffer, sizeof n->gbuffer, "%.*s%s.gbuffer.exr", SAVE_STEM_MAX, stem, tail);
    snprintf(n->camera, sizeof n->camera, "%.*s%s.camera.json", SAVE_STEM_MAX, stem, tail);
}

/* The first number whose files are not there yet: nothing is overwritten. */
static bool choose_names(const struct viewer *v, struct save_names *n, struct tool_error *err)
{
    char stem[SAVE_STEM_MAX];
    const char *path = v->live ? live_scene_name(v->live->kind) : v->source.now.path;
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    size_t length = strlen(name);
    if (text_ends_with(name, ".exr"))
        length -= strlen(".exr");
    if (v->arguments->save)
        snprintf(stem, sizeof stem, "%s", v->arguments->save);
    else
        snprintf(stem, sizeof stem, "%.*s.view", (int)length, name);
    for (unsigned i = 1; i < 10000; i++) {
        fill_names(n, stem, i);
        if (!exists(n->exr) && !exists(n->png) && !exists(n->script) &&
            (!v->live || (!exists(n->gbuffer) && !exists(n->camera))))
            return true;
    }
    return fail(err, EXIT_OUTPUT, "%s: no name is free for another picture", stem);
}

/* --- Command line --- */

/* Options of vkao that read the file as it was read here. */
static void add_file_options(const struct viewer *v, struct text *out)
{
    const struct arguments *a = v->arguments;
    const struct loaded_frame *l = &v->source.now;
    bool has_view = false;
    for (size_t i = 0; i < a->file_word_count; i++) {
        text_add(out, " ");
        text_add_quoted(out, a->file_words[i]);
        has_view = has_view || strncmp(a->file_words[i], "--view", strlen("--view")) == 0;
    }
    if (l->camera_path) {
        text_add(out, " --camera ");
        text_add_quoted(out, l->camera_path);
    }
    if (!has_view && *l->files.views[l->view].name) {
        text_add(out, " --view ");
        text_add_quoted(out, l->files.views[l->view].name);
    }
}

/* Views of which vkao itself writes the picture. It knows no direct light, as live scenes have. */
static bool vkao_draws(const struct viewer *v)
{
    return v->view == VIEW_RAW || v->view == VIEW_AO || (v->view == VIEW_COMPOSITE && !v->live);
}

static bool shows_colour(const struct viewer *v)
{
    return v->view == VIEW_COMPOSITE && !v->live && v->source.now.color.image;
}

static bool build_command(const struct viewer *v, const struct save_names *n, struct text *command,
                          struct text *unsaid, struct tool_error *err)
{
    text_add(command, "vkao ");
    if (v->live) {
        text_add_quoted(command, n->gbuffer);
        text_add(command, " --normal-space camera --camera ");
        text_add_quoted(command, n->camera);
    } else {
        text_add_quoted(command, v->source.now.path);
        add_file_options(v, command);
    }
    /* Of a composite that vkao does not draw the AO is said. */
    setting_add_options(&v->settings[v->active],
                        v->view == VIEW_COMPOSITE && v->live ? VIEW_AO : v->view, command, unsaid);
    if (shows_colour(v))
        text_add(command, " --mode comp");
    if (v->view == VIEW_BENT && method_has_bent(v->settings[v->active].effect.method))
        text_add(command, " --bent-normals");
    text_add(command, " --pixel-type float --overwrite always -o ");
    text_add_quoted(command, n->exr);
    if (vkao_draws(v)) {
        text_add(command, " --preview ");
        text_add_quoted(command, n->png);
    }
    return (!command->out_of_memory && !unsaid->out_of_memory) ||
           fail(err, EXIT_MEMORY, "%s: out of memory", n->script);
}

static bool write_script(const struct viewer *v, const struct save_names *n, const char *command,
                         const char *unsaid, struct tool_error *err)
{
    struct atomic_file *file = calloc(1, sizeof *file);
    struct text text = {0};
    text_add(&text, "#!/bin/sh\n");
    if (!vkao_draws(v))
        text_add(&text, "# vkao writes no picture of this view (%s); this is the AO behind it.\n",
                 view_names[v->view].word);
    if (unsaid)
        text_add(&text, "# Set in the viewer, and without an option of vkao: %s\n", unsaid);
    text_add(&text, "%s\n", command);
    bool ok = file && !text.out_of_memory;
    if (!ok)
        fail(err, EXIT_MEMORY, "%s: out of memory", n->script);
    ok = ok && atomic_file_open(file, n->script, false, err);
    if (ok && atomic_file_write(file, text.data, text.length, err))
        ok = atomic_file_commit(file, err);
    else if (ok)
        ok = false;
    if (file)
        atomic_file_abort(file);
    text_free(&text);
    free(file);
    return ok;
}

const struct computation *save_result(const struct viewer *viewer)
{
    /* The frame in flight before the one that comes next. */
    uint32_t last = (viewer->swapchain.frame + FRAMES_IN_FLIGHT - 1) % FRAMES_IN_FLIGHT;
    return &viewer->results[viewer->active][viewer->live ? last : 0];
}

static bool check_saveable(const struct viewer *v, struct tool_error *err)
{
    if (viewer_has_image(v) && save_result(v)->frame)
        return true;
    return fail(err, EXIT_INPUT, "there is no picture that could be saved");
}

bool viewer_save(struct viewer *viewer, struct tool_error *err)
{
    struct viewer *v = viewer;
    struct save_names *names = calloc(1, sizeof *names);
    struct text command = {0}, unsaid = {0};
    bool ok = (names || fail(err, EXIT_MEMORY, "out of memory")) && check_saveable(v, err) &&
              choose_names(v, names, err) && build_command(v, names, &command, &unsaid, err) &&
              (v->live ? save_live_values(v, names, err) : save_file_values(v, names, err)) &&
              write_script(v, names, command.data, unsaid.data, err);
    if (ok) {
        viewer_say(v, "saved %s, .exr and .png:\n%s", names->script, command.data);
        ok = report_text(command.data, err);
        printf("\n");
        fflush(stdout);
    }
    free(names);
    text_free(&command);
    text_free(&unsaid);
    return ok;
}

bool viewer_copy_command(struct viewer *viewer, struct tool_error *err)
{
    struct save_names *names = calloc(1, sizeof *names);
    struct text command = {0}, unsaid = {0};
    bool ok = (names || fail(err, EXIT_MEMORY, "out of memory")) && check_saveable(viewer, err) &&
              choose_names(viewer, names, err) &&
              build_command(viewer, names, &command, &unsaid, err);
    if (ok) {
        window_set_clipboard(&viewer->window, command.data);
        viewer_say(viewer, "in the clipboard:\n%s", command.data);
    }
    free(names);
    text_free(&command);
    text_free(&unsaid);
    return ok;
}
