/* SPDX-License-Identifier: MIT
 *
 * What keys, mouse and dropped files do. */
#include "viewer.h"

#include "widgets.h"

#include <math.h>

enum { WIPE_REACH = 8 /* units from the line that the mouse takes hold of it */ };

static const double zoom_levels[] = {1.0 / 16, 1.0 / 8, 1.0 / 4, 1.0 / 2, 1,  2,  3,
                                     4,        6,       8,       12,      16, 24, 32};
enum { ZOOM_LEVELS = sizeof zoom_levels / sizeof *zoom_levels };

/* --- Zoom and pan --- */

static double next_zoom(double zoom, bool closer)
{
    for (int i = 0; i < ZOOM_LEVELS; i++) {
        double level = zoom_levels[closer ? i : ZOOM_LEVELS - 1 - i];
        if (closer ? level > zoom * 1.001 : level < zoom / 1.001)
            return level;
    }
    return zoom;
}

/* What is at x, y on the screen stays there. */
static void zoom_to(struct viewer *v, double zoom, double x, double y)
{
    struct placing *p = &v->placing;
    double column = (x - p->x) / p->zoom, row = (y - p->y) / p->zoom;
    *p = (struct placing){
        .zoom = zoom, .x = floor(x - column * zoom + 0.5), .y = floor(y - row * zoom + 0.5)};
}

static void zoom_centre(struct viewer *v, double zoom)
{
    const VkRect2D area = viewer_area(v);
    if (!v->live)
        zoom_to(v, zoom, area.offset.x + area.extent.width / 2.0,
                area.offset.y + area.extent.height / 2.0);
}

static void scroll(struct viewer *v, const struct input *in)
{
    double notches = in->scroll;
    if (v->live) {
        orbit_zoom(&v->live->camera, notches);
        return;
    }
    for (; notches >= 0.5; notches -= 1)
        zoom_to(v, next_zoom(v->placing.zoom, true), in->x, in->y);
    for (; notches <= -0.5; notches += 1)
        zoom_to(v, next_zoom(v->placing.zoom, false), in->x, in->y);
}

/* --- Keys --- */

static void step(struct viewer *v, int by)
{
    const size_t count = v->source.plan.count;
    if (v->live || count < 2)
        return;
    const size_t at = v->source.frame;
    if (by < 0 ? at > 0 : at + 1 < count)
        viewer_load(v, by < 0 ? at - 1 : at + 1, v->source.now.view);
}

static void toggle_wipe(struct viewer *v)
{
    const VkRect2D area = viewer_area(v);
    v->wipe = !v->wipe;
    if (!v->wipe_is_placed)
        v->wipe_at = (area.offset.x + area.extent.width / 2.0) / v->swapchain.extent.width;
    v->wipe_is_placed = true;
}

/* Ends what is open; the window only if nothing is. */
static void escape(struct viewer *v)
{
    if (widgets_close_choice())
        return;
    if (v->browser.is_open)
        browser_close(&v->browser);
    else if (v->show_help)
        v->show_help = false;
    else
        v->quit = true;
}

static void copy_probe(struct viewer *v)
{
    const struct probe_result *r = &v->probed;
    const VkOffset2D offset = viewer_image_offset(v);
    struct text text = {0};
    if (!r->valid) {
        viewer_say(v, "the mouse is on no texel that could be copied");
        return;
    }
    text_add(&text, "texel %d %d AO %.6g", r->x - offset.x, r->y - offset.y, (double)r->ao[0]);
    if (v->wipe)
        text_add(&text, " B %.6g", (double)r->ao[1]);
    if (r->background)
        text_add(&text, " background");
    else
        text_add(&text, " position %.6g %.6g %.6g normal %.6g %.6g %.6g", r->position[0],
                 r->position[1], r->position[2], r->normal[0], r->normal[1], r->normal[2]);
    if (!text.out_of_memory) {
        window_set_clipboard(&v->window, text.data);
        viewer_say(v, "copied: %s", text.data);
    }
    text_free(&text);
}

static void press_key(struct viewer *v, enum key_action key)
{
    struct history_state state;
    if (key >= KEY_VIEW_1 && key < KEY_VIEW_1 + VIEW_KINDS) {
        v->view = (enum view_kind)(key - KEY_VIEW_1);
        viewer_mark_stale(v);
        return;
    }
    switch (key) {
    case KEY_SWAP:
        v->active = v->active == SIDE_A ? SIDE_B : SIDE_A;
        break;
    case KEY_WIPE:
        toggle_wipe(v);
        break;
    case KEY_ZOOM_IN:
        zoom_centre(v, next_zoom(v->placing.zoom, true));
        break;
    case KEY_ZOOM_OUT:
        zoom_centre(v, next_zoom(v->placing.zoom, false));
        break;
    case KEY_FIT:
        viewer_fit(v);
        break;
    case KEY_FULL_SIZE:
        zoom_centre(v, 1);
        break;
    case KEY_PREVIOUS:
    case KEY_NEXT:
        step(v, key == KEY_NEXT ? 1 : -1);
        break;
    case KEY_SAVE:
        v->save_wanted = true;
        break;
    case KEY_PANEL:
        v->show_panel = !v->show_panel;
        break;
    case KEY_PROJECTION:
        if (v->live)
            v->live->camera.orthographic = !v->live->camera.orthographic;
        break;
    case KEY_PAUSE:
        if (v->live)
            v->live->running = !v->live->running;
        break;
    case KEY_UNDO:
    case KEY_REDO:
        if (history_step(&v->history, key == KEY_UNDO ? -1 : 1, &state))
            viewer_take_state(v, &state);
        break;
    case KEY_COPY:
        copy_probe(v);
        break;
    case KEY_OPEN:
        viewer_browse(v);
        break;
    case KEY_HELP:
        v->show_help = !v->show_help;
        break;
    case KEY_ESCAPE:
        escape(v);
        break;
    case KEY_QUIT:
        v->quit = true;
        break;
    default:
        break;
    }
}

/* --- Mouse --- */

static bool is_at_line(const struct viewer *v, double x)
{
    return v->wipe && fabs(x - v->wipe_at * v->swapchain.extent.width) <= WIPE_REACH * v->scale;
}

/* The line covers the column that the mouse is in. */
static void place_wipe(struct viewer *v, double x)
{
    const double width = v->swapchain.extent.width;
    double column = fmin(fmax(floor(x), 0), width - 1);
    v->wipe_at = (column + 0.5) / width;
}

static void drag_on(struct viewer *v, const struct input *in)
{
    double dx = in->x - v->drag_x, dy = in->y - v->drag_y;
    const double height = v->swapchain.extent.height;
    if (v->drag == DRAG_WIPE)
        place_wipe(v, in->x);
    else if (v->drag == DRAG_ORBIT && v->drag_is_left)
        orbit_drag(&v->live->camera, dx / height, dy / height);
    else if (v->drag == DRAG_ORBIT)
        orbit_pan(&v->live->camera, dx / height, dy / height);
    if (v->drag == DRAG_PAN && !(dx >= 0 && dx <= 0 && dy >= 0 && dy <= 0)) {
        v->placing.fit = false;
        v->placing.x += dx;
        v->placing.y += dy;
    }
    v->drag_x = in->x;
    v->drag_y = in->y;
}

bool viewer_has_mouse(const struct viewer *viewer, double x)
{
    const bool is_panel = viewer->show_panel && x < viewer_panel_width(viewer);
    return !is_panel && !viewer->browser.is_open && !widgets_hold_mouse();
}

static void use_mouse(struct viewer *v, const struct input *in)
{
    if (v->drag == DRAG_NONE && viewer_has_mouse(v, in->press_x) &&
        (in->left_pressed || in->right_pressed)) {
        const bool line = in->left_pressed && is_at_line(v, in->press_x);
        v->drag = line ? DRAG_WIPE : v->live ? DRAG_ORBIT : in->left_pressed ? DRAG_PAN : DRAG_NONE;
        /* The button may be up again by now, and the mouse elsewhere. */
        v->drag_is_left = in->left_pressed;
        v->drag_x = in->press_x;
        v->drag_y = in->press_y;
    }
    if (v->drag != DRAG_NONE)
        drag_on(v, in);
    if (!in->left && !in->right) {
        /* Texels of the image on texels of the screen. */
        if (v->drag == DRAG_PAN && v->placing.zoom >= 1) {
            v->placing.x = floor(v->placing.x + 0.5);
            v->placing.y = floor(v->placing.y + 0.5);
        }
        v->drag = DRAG_NONE;
    }
    const bool wipes = v->drag == DRAG_WIPE || (v->drag == DRAG_NONE && is_at_line(v, in->x));
    window_set_cursor(&v->window, wipes ? CURSOR_WIPE : CURSOR_ARROW);
    if (viewer_has_mouse(v, in->x) && fabs(in->scroll) > 0)
        scroll(v, in);
}

/* --- Files --- */

static bool open_files(struct viewer *v, char *const *paths, size_t count)
{
    struct source_undo undo;
    struct tool_error err = {0};
    if (v->live) {
        fail(&err, EXIT_INPUT, "%s: a live scene takes no files", paths[0]);
    } else if (source_drop(&v->source, paths, count, &undo, &err)) {
        v->report.said_count = 0;
        plan_say_cameras(&v->source.plan, &v->report);
        const bool loaded = viewer_load(v, v->source.frame, v->source.now.view);
        source_settle(&v->source, &undo, loaded);
        if (loaded)
            viewer_fit_depth(v); /* another camera may measure another depth */
        return loaded;
    }
    if (err.code)
        viewer_say_error(v, &err);
    return false;
}

void viewer_browse(struct viewer *viewer)
{
    struct tool_error err = {0};
    const char *path = viewer->source.now.path;
    if (viewer->browser.is_open)
        browser_close(&viewer->browser);
    else if (viewer->live)
        viewer_say(viewer, "a live scene takes no files");
    else if (!browser_open(&viewer->browser, path, &err))
        viewer_say_error(viewer, &err);
}

void viewer_choose_file(struct viewer *viewer)
{
    struct tool_error err = {0};
    char path[sizeof viewer->browser.folder + 256];
    char *const paths[] = {path};
    if (browser_choose(&viewer->browser, path, sizeof path, &err)) {
        if (open_files(viewer, paths, 1))
            browser_close(&viewer->browser);
    } else if (err.code) {
        viewer_say_error(viewer, &err);
    }
}

/* All keys are the list's while it is open. */
static void press_key_in_list(struct viewer *v, enum key_action key, uint32_t character)
{
    enum { PAGE = 10 };
    const long all = (long)v->browser.count;
    struct tool_error err = {0};
    switch (key) {
    case KEY_CHARACTER:
        browser_type(&v->browser, character);
        break;
    case KEY_UP:
    case KEY_DOWN:
        browser_move(&v->browser, key == KEY_UP ? -1 : 1);
        break;
    case KEY_PAGE_UP:
    case KEY_PAGE_DOWN:
        browser_move(&v->browser, key == KEY_PAGE_UP ? -PAGE : PAGE);
        break;
    case KEY_FIRST:
    case KEY_LAST:
        browser_move(&v->browser, key == KEY_FIRST ? -all : all);
        break;
    case KEY_ERASE:
        if (!browser_erase(&v->browser, &err))
            viewer_say_error(v, &err);
        break;
    case KEY_ENTER:
        viewer_choose_file(v);
        break;
    case KEY_OPEN:
        viewer_browse(v);
        break;
    case KEY_ESCAPE:
        escape(v);
        break;
    default:
        break;
    }
}

void viewer_handle_input(struct viewer *viewer)
{
    const struct input *in = &viewer->window.input;
    /* A drag is one step. */
    const struct history_state now = viewer_state(viewer);
    if (!in->left)
        history_note(&viewer->history, &now);
    if (in->key_count > 0)
        viewer->status.is_new = false;
    for (size_t i = 0; i < in->key_count; i++) {
        if (viewer->browser.is_open)
            press_key_in_list(viewer, in->keys[i], in->characters[i]);
        else if (!widgets_want_keyboard())
            press_key(viewer, in->keys[i]);
    }
    if (!viewer->browser.is_open)
        use_mouse(viewer, in);
    else if (fabs(in->scroll) > 0)
        browser_move(&viewer->browser, -lround(in->scroll * 3));
    if (in->dropped_count > 0)
        open_files(viewer, in->dropped, in->dropped_count);
}
