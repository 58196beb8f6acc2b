/* SPDX-License-Identifier: MIT
 *
 * Frame by frame, until somebody quits. */
#include "viewer.h"

#include <stdio.h>
#include <string.h>

/* What is shown, in a form that other programs can read too. */
static void update_title(struct viewer *v)
{
    char title[sizeof v->title], a[64], b[64], frame[64] = "";
    const char *name = v->live                        ? live_scene_name(v->live->kind)
                       : source_is_loaded(&v->source) ? text_base_name(v->source.now.path)
                                                      : "no file";
    side_title(v, v->wipe ? SIDE_A : v->active, a, sizeof a);
    side_title(v, SIDE_B, b, sizeof b);
    if (v->source.plan.count > 1)
        snprintf(frame, sizeof frame, " [%zu/%zu]", v->source.frame + 1, v->source.plan.count);
    snprintf(title, sizeof title, "%s%s - %s - %s%s%s - %.4g %% - vkao-view", name, frame,
             view_names[v->view].title, a, v->wipe ? " | " : "", v->wipe ? b : "",
             v->placing.zoom * 100);
    if (strcmp(title, v->title) == 0)
        return;
    memcpy(v->title, title, sizeof title);
    window_set_title(&v->window, title);
}

static void advance_clock(struct viewer *v, double *last)
{
    double now = window_time();
    if (v->live && v->live->running)
        v->live->seconds += now - *last;
    *last = now;
}

static void save_if_wanted(struct viewer *v)
{
    struct tool_error err = {0};
    if (!v->save_wanted)
        return;
    v->save_wanted = false;
    viewer_draw_more(v); /* the panel says what came of it */
    if (!viewer_save(v, &err))
        viewer_say_error(v, &err);
}

/* Draws, and does what belongs to a frame that was drawn. False without an error in err: there was
 * nothing to draw into. */
static bool run_frame(struct viewer *v, bool last, struct tool_error *err)
{
    bool drawn = viewer_draw(v, last ? v->arguments->screenshot : NULL, err);
    if (drawn) {
        v->frames_drawn++;
        v->frames_wanted -= v->frames_wanted > 0;
        save_if_wanted(v);
        update_title(v);
    }
    if (v->failure.code == EXIT_OK)
        return drawn;
    *err = v->failure;
    return false;
}

bool viewer_run(struct viewer *viewer, struct tool_error *err)
{
    struct viewer *v = viewer;
    const uint32_t frames = v->arguments->frames;
    double last_time = window_time();
    bool drawn_last = false;
    viewer_draw_more(v);
    while (!drawn_last) {
        const bool runs = frames > 0 || (v->live && v->live->running);
        window_poll(&v->window, !runs && v->frames_wanted == 0 && !v->quit, 0);
        if (v->window.input.changed)
            viewer_draw_more(v);
        viewer_handle_input(v);
        v->quit = v->quit || window_should_close(&v->window);
        const VkExtent2D framebuffer = window_framebuffer(&v->window);
        if (framebuffer.width == 0 || framebuffer.height == 0) {
            /* Minimised: there is nothing to draw into, nor anybody to see it. */
            if (v->quit)
                return true;
            window_poll(&v->window, true, 0.1);
            continue;
        }
        advance_clock(v, &last_time);
        const bool last = v->quit || (frames > 0 && v->frames_drawn + 1 >= frames);
        if (last && v->quit && !v->arguments->screenshot && !v->save_wanted)
            return true;
        drawn_last = run_frame(v, last, err) && last;
        if (err->code)
            return false;
    }
    return true;
}
