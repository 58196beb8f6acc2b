/* SPDX-License-Identifier: MIT
 *
 * What the panel shows, and what it lets people change. */
#include "viewer.h"

#include "automatic.h"
#include "summary.h"
#include "widgets.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- Parameters --- */

/* The row, with a range of lengths that goes by the files, whatever their unit, and with ends that
 * what was asked for lies between: else touching the slider would lose it. */
static struct param row_for(const struct viewer *v, const struct param *row)
{
    const vkao_parameter *p = row->parameter;
    struct param fit = *row;
    if (strcmp(p->unit, "scene units") == 0 && v->source.radius > 0) {
        fit.low *= (double)v->source.radius / p->standard;
        fit.high *= (double)v->source.radius / p->standard;
    }
    double asked = fit.low;
    const void *at = parameter_of_const(&v->arguments->settings[v->active], p);
    if (p->type == VKAO_PARAMETER_FLOAT)
        asked = (double)*(const float *)at;
    else if (p->type == VKAO_PARAMETER_UINT)
        asked = (double)*(const uint32_t *)at;
    if (asked > 0) /* 0 is what the file decides, or in range */
        fit.low = fmin(fit.low, asked);
    fit.high = fmax(fit.high, asked);
    return fit;
}

/* The setting at hand, but for the row, which is as the files would have it. */
static struct setting reset(const struct viewer *v, const struct param *row)
{
    struct setting s = v->settings[v->active];
    const void *at = parameter_of(&s, row->parameter);
    param_reset(row, &s);
    if (at == &s.params.radius && v->live)
        s.params.radius = live_scene_radius(v->live->kind);
    else if (at == &s.params.radius && v->source.radius > 0)
        s.params.radius = v->source.radius;
    else if (at == &s.params.bias && v->bias_settled[v->active] > 0)
        s.params.bias = v->bias_settled[v->active];
    return s;
}

static void describe(const struct param *row, const struct setting *standard, char *text,
                     size_t size)
{
    const vkao_parameter *p = row->parameter;
    struct text value = {0};
    parameter_add_value(&value, p, standard);
    const char *number = value.data ? value.data : "";
    if (p->type == VKAO_PARAMETER_FLOAT || p->type == VKAO_PARAMETER_UINT)
        snprintf(text, size,
                 "%s\n\n%.4g to %.4g%s%s, default %s. Right click: default, Ctrl and "
                 "click: type",
                 p->help, row->low, row->high, *p->unit ? " " : "", p->unit, number);
    else
        snprintf(text, size, "%s\n\nRight click: default", p->help);
    text_free(&value);
}

static bool choice_row(const struct param *row, struct setting *s, unsigned there)
{
    const vkao_parameter *p = row->parameter;
    uint32_t now, before;
    memcpy(&now, parameter_of(s, p), sizeof now);
    before = now;
    if (!ui_begin_choice(row->label, (double)now <= p->most ? p->choices[now] : ""))
        return false;
    for (uint32_t c = 0; c <= last_choice(row); c++)
        if (ui_choice(p->choices[c], c == before, choice_is_open(row, c, there)))
            now = c;
    ui_end_choice();
    memcpy(parameter_of(s, p), &now, sizeof now);
    return now != before;
}

static bool widget_row(const struct param *row, struct setting *s, unsigned there)
{
    void *at = parameter_of(s, row->parameter);
    bool on, changed;
    switch (row->parameter->type) {
    case VKAO_PARAMETER_FLOAT:
        return ui_slider_float(row->label, at, (float)row->low, (float)row->high, row->logarithmic);
    case VKAO_PARAMETER_UINT:
        return ui_slider_uint(row->label, at, (uint32_t)row->low, (uint32_t)row->high,
                              row->logarithmic);
    case VKAO_PARAMETER_COLOR:
        return ui_color(row->label, at);
    case VKAO_PARAMETER_CHOICE:
        return choice_row(row, s, there);
    default:
        on = *(VkBool32 *)at;
        changed = ui_checkbox(row->label, &on);
        *(VkBool32 *)at = on;
        return changed;
    }
}

/* Whether it changed. A right click resets; the radius of a file is its automatic one. */
static bool param_row(struct viewer *v, const struct param *row, struct setting *s)
{
    const struct param fit = row_for(v, row), *p = &fit;
    const unsigned there = viewer_images_there(v);
    const uint32_t readers = p->parameter->methods;
    bool idle = (readers && !(readers & 1u << s->effect.method)) || (p->needs & ~there) ||
                !viewer_has_image(v);
    char help[320];
    ui_begin_disabled(idle);
    bool changed = widget_row(p, s, there);
    const struct setting standard = reset(v, p);
    describe(p, &standard, help, sizeof help);
    ui_help(help);
    if (ui_clicked_right()) {
        *s = reset(v, p);
        changed = true;
    }
    ui_end_disabled();
    return changed;
}

static void param_sections(struct viewer *v)
{
    struct setting *s = &v->settings[v->active];
    size_t count;
    const struct param *rows = panel_params(&count);
    bool changed = false;
    for (int g = 0; g < GROUP_COUNT; g++) {
        const bool open = g != GROUP_COMPOSITE || v->view == VIEW_COMPOSITE;
        if (!ui_section(group_names[g], open))
            continue;
        for (size_t i = 0; i < count; i++)
            if ((int)rows[i].group == g)
                changed = param_row(v, &rows[i], s) || changed;
    }
    if (changed)
        viewer_mark_stale(v);
}

static void presets(struct viewer *v)
{
    for (int q = 0; q < QUALITY_COUNT; q++) {
        if (ui_button(quality_names[q])) {
            setting_apply_preset(&v->settings[v->active], (vkao_quality)q);
            viewer_mark_stale(v);
        }
        ui_help("preset: settings by quality");
        ui_same_line();
    }
}

/* --- Files, views, sides --- */

/* Those of the file less its path, which stands above them. */
static void warning_rows(const struct viewer *v)
{
    struct text path = {0}, line = {0};
    text_add_printable(&path, v->source.now.path);
    text_add(&path, ": ");
    for (const char *at = v->warnings.data; at && *at;) {
        const size_t all = strcspn(at, "\n");
        const bool is_of_file = path.data && strncmp(at, path.data, path.length) == 0;
        const size_t left_out = is_of_file ? path.length : 0;
        line.length = 0;
        text_add(&line, "%.*s", (int)(all - left_out), at + left_out);
        if (!line.out_of_memory && line.data)
            ui_paragraph(UI_WARNING, line.data);
        at += all + (at[all] == '\n');
    }
    text_free(&path);
    text_free(&line);
}

/* Of the radius as it is now, once if both sides have the same. */
static void radius_warnings(const struct viewer *v)
{
    const struct setting *a = &v->settings[SIDE_A], *b = &v->settings[SIDE_B];
    for (int i = 0; i < SIDES; i++) {
        struct text warning = {0};
        struct report report = {
            .verbosity = REPORT_QUIET, .heard = viewer_hear, .heard_data = &warning};
        const bool is_said = i == SIDE_B && viewer_needs(v, SIDE_A) &&
                             fabsf(a->params.radius - b->params.radius) <= 0.0f;
        if (viewer_needs(v, (enum side)i) && !is_said)
            check_radius(&v->source.now.gbuffer, v->settings[i].params.radius, &report);
        if (warning.length && !warning.out_of_memory)
            ui_paragraph(UI_WARNING, warning.data);
        text_free(&warning);
    }
}

static void file_rows(struct viewer *v)
{
    const struct source *s = &v->source;
    const struct loaded_frame *l = &s->now;
    if (!source_is_loaded(s)) {
        ui_text("no file: drop one here, or Ctrl+O");
        return;
    }
    /* Names, since paths are long; those stand in the help. */
    ui_paragraph(UI_PLAIN, text_base_name(l->path));
    ui_help(l->path);
    ui_text("%u x %u", l->gbuffer.width, l->gbuffer.height);
    struct text summary = {0};
    text_add_summary(&summary, &l->gbuffer);
    if (l->camera_path)
        text_add(&summary, "\ncamera: %s", l->camera_path);
    if (summary.data)
        ui_help(summary.data);
    text_free(&summary);
    if (l->camera_path)
        ui_paragraph(UI_DIM, text_base_name(l->camera_path));
    warning_rows(v);
    radius_warnings(v);
    if (s->plan.count > 1) {
        uint32_t frame = (uint32_t)s->frame + 1;
        if (ui_slider_uint("frame", &frame, 1, (uint32_t)s->plan.count, false) &&
            frame != s->frame + 1)
            viewer_load(v, frame - 1, l->view);
    }
    if (l->files->view_count > 1 && ui_begin_choice("eye", l->files->views[l->view].name)) {
        size_t chosen = l->view;
        for (size_t i = 0; i < l->files->view_count; i++)
            if (ui_choice(l->files->views[i].name, i == l->view, true))
                chosen = i;
        ui_end_choice();
        if (chosen != l->view)
            viewer_load(v, s->frame, chosen);
    }
}

static void live_rows(struct viewer *v)
{
    struct live *l = v->live;
    const VkExtent2D used = live_used(l);
    float scale = (float)l->scale;
    ui_text("%s, %u x %u", live_scene_name(l->kind), used.width, used.height);
    if (ui_slider_float("resolution", &scale, 0.25f, 1.0f, false))
        l->scale = (double)scale;
    ui_help(
        "share of the window's resolution on each axis: struct ao_view.valid alone changes, and "
        "nothing is allocated anew");
    ui_checkbox("orthographic", &l->camera.orthographic);
    ui_same_line();
    ui_checkbox("clock runs", &l->running);
}

static void gain_row(struct viewer *v)
{
    float gain = (float)v->gain;
    if (ui_slider_float("gain", &gain, 1.0f, 16.0f, true)) {
        v->gain = (double)gain;
        viewer_mark_seen(v);
    }
    ui_help("red: darker than the reference; blue: brighter");
}

static void exposure_row(struct viewer *v)
{
    float stops = (float)v->exposure;
    bool changed = ui_slider_float("exposure", &stops, -MAX_STOPS, MAX_STOPS, false);
    ui_help("stops: light times 2 to the power of it, before sRGB. Right click: 0");
    if (ui_clicked_right()) {
        stops = 0;
        changed = true;
    }
    if (!changed)
        return;
    v->exposure = (double)stops;
    viewer_mark_seen(v);
}

/* Neither end passes the other. */
static void depth_rows(struct viewer *v)
{
    struct depth_shown *d = &v->depth_shown;
    const double most = 2 * (double)v->settings[v->active].params.debug_distance;
    const float longest = (float)fmax(most, d->far);
    float near = (float)d->near, far = (float)d->far;
    bool changed = ui_slider_float("near", &near, 0.0f, longest, false);
    ui_help("view z that shows as black, scene units");
    if (changed && far <= near)
        far = near * 1.001f + longest * 1e-4f;
    if (ui_slider_float("far", &far, 0.0f, longest, false)) {
        changed = true;
        if (far <= near)
            far = near * 1.001f + longest * 1e-4f;
    }
    ui_help("view z that shows as white, scene units");
    if (changed) {
        *d = (struct depth_shown){.near = (double)near, .far = (double)far};
        viewer_mark_seen(v);
    }
    bool automatic = d->is_automatic;
    if (ui_checkbox("automatic", &automatic)) {
        d->is_automatic = automatic;
        viewer_fit_depth(v);
    }
    ui_help("1 % of the first file's foreground is nearer, and 1 % farther");
}

static void view_rows(struct viewer *v)
{
    static const char *const labels[VIEW_KINDS] = {"1 raw",     "2 AO",   "3 composite", "4 depth",
                                                   "5 normals", "6 bent", "7 difference"};
    for (int i = 0; i < VIEW_KINDS; i++) {
        if (i % 4)
            ui_same_line();
        if (ui_radio(labels[i], (int)v->view == i)) {
            v->view = (enum view_kind)i;
            viewer_mark_stale(v);
        }
    }
    if (v->view == VIEW_DIFFERENCE)
        gain_row(v);
    else if (v->view == VIEW_COMPOSITE)
        exposure_row(v);
    if (v->view == VIEW_COMPOSITE && viewer_has_image(v) && !(viewer_images_there(v) & NEEDS_COLOR))
        ui_paragraph(UI_DIM, "the file has no colour: AO alone");
    if (v->view == VIEW_DEPTH)
        depth_rows(v);
}

static void side_rows(struct viewer *v)
{
    char a[64], b[64];
    side_title(v, SIDE_A, a, sizeof a);
    side_title(v, SIDE_B, b, sizeof b);
    if (ui_radio(a, v->active == SIDE_A))
        v->active = SIDE_A;
    ui_same_line();
    if (ui_radio(b, v->active == SIDE_B))
        v->active = SIDE_B;
}

/* On a line with the presets: the names of two methods fill one of their own. */
static void copy_and_wipe(struct viewer *v)
{
    if (ui_button(v->active == SIDE_A ? "to B" : "to A")) {
        v->settings[v->active == SIDE_A ? SIDE_B : SIDE_A] = v->settings[v->active];
        viewer_mark_stale(v);
    }
    ui_help(v->active == SIDE_A ? "gives B the settings of A" : "gives A the settings of B");
    ui_same_line();
    bool wipe = v->wipe;
    if (ui_checkbox("wipe", &wipe)) {
        v->wipe = wipe;
        if (!v->wipe_is_placed)
            v->wipe_at = 0.5;
        v->wipe_is_placed = true;
    }
}

/* --- What was found --- */

static void time_row(const struct viewer *v, enum side side)
{
    const double *ms = v->times[side].ms;
    double total = 0;
    for (int i = 0; i < STAGES; i++)
        total += ms[i];
    ui_text("%c %7.2f %7.2f %7.2f %7.2f %8.2f", side == SIDE_A ? 'A' : 'B', ms[0], ms[1], ms[2],
            ms[3], total);
}

static void time_rows(const struct viewer *v)
{
    if (!v->timestamps) {
        ui_text("this queue has no timestamps");
        return;
    }
    ui_paragraph(UI_DIM, "  prepare    ssao    blur    comp   all ms");
    ui_help("device time of each stage");
    for (int s = 0; s < SIDES; s++)
        if (viewer_needs(v, (enum side)s))
            time_row(v, (enum side)s);
}

/* With as many digits as the panel has room for. */
static void position_row(const double p[3])
{
    enum { MOST_LETTERS = 41 };
    char text[128];
    int digits = 6;
    do
        snprintf(text, sizeof text, "position %10.*g %10.*g %10.*g", digits, p[0], digits, p[1],
                 digits, p[2]);
    while (strlen(text) > MOST_LETTERS && --digits > 2);
    ui_text("%s", text);
}

static void probe_rows(const struct viewer *v)
{
    const struct probe_result *r = &v->probed;
    const VkOffset2D offset = viewer_image_offset(v);
    /* Always three lines: what is below stays where it is. */
    if (!r->valid) {
        ui_paragraph(UI_DIM, "what is under the mouse shows here");
        ui_text(" ");
        ui_text(" ");
        return;
    }
    if (v->wipe)
        ui_text("texel %d, %d   AO %.4f | %.4f", r->x - offset.x, r->y - offset.y, (double)r->ao[0],
                (double)r->ao[1]);
    else
        ui_text("texel %d, %d   AO %.4f", r->x - offset.x, r->y - offset.y, (double)r->ao[0]);
    if (r->background) {
        ui_text("background");
        ui_text(" ");
        return;
    }
    position_row(r->position);
    ui_text("%s %10.4f %10.4f %10.4f", r->normal_is_derived ? "from z  " : "normal  ", r->normal[0],
            r->normal[1], r->normal[2]);
}

/* AO of two radii is not compared unawares. */
static void radius_row(struct viewer *v, enum side side)
{
    struct vkao_params *p = &v->settings[side].params;
    const float wanted = v->source.now.reference_radius;
    char text[128], button[32];
    if (!(wanted > 0) || fabsf(p->radius - wanted) <= 1e-4f * wanted)
        return;
    snprintf(text, sizeof text, "%c: radius %.5g, the reference's is %.5g", side ? 'B' : 'A',
             (double)p->radius, (double)wanted);
    snprintf(button, sizeof button, "take %.5g for %c", (double)wanted, side ? 'B' : 'A');
    ui_paragraph(UI_WARNING, text);
    if (ui_button(button)) {
        p->radius = wanted;
        viewer_mark_stale(v);
    }
}

static void error_rows(struct viewer *v)
{
    if (v->view != VIEW_DIFFERENCE || v->live)
        return;
    for (int s = 0; s < SIDES; s++)
        if (v->error[s] >= 0 && viewer_needs(v, (enum side)s))
            ui_text("%c: RMSE %.4f to %s", s ? 'B' : 'A', v->error[s],
                    v->source.now.reference_channel);
    for (int s = 0; s < SIDES; s++)
        if (v->source.now.reference.image && viewer_needs(v, (enum side)s))
            radius_row(v, (enum side)s);
}

/* Of the side that the panel changes. */
static void histogram_rows(struct viewer *v)
{
    struct histogram *h = &v->histogram;
    const bool was_wanted = h->is_wanted;
    h->is_wanted = ui_section("Histogram", false);
    if (!h->is_wanted)
        return;
    if (!was_wanted)
        viewer_mark_seen(v);
    ui_histogram(h->bins, h->curves, 70.0f);
    ui_help("what is shown, from black on the left to white; both ends count, but do not scale it");
    double black = 0, white = 0, mean = 0;
    const double count = (double)h->count * h->curves;
    for (uint32_t c = 0; c < h->curves; c++) {
        black += h->bins[c][0];
        white += h->bins[c][255];
        for (int i = 0; i < 256; i++)
            mean += (double)h->bins[c][i] * i / 255;
    }
    if (count > 0)
        ui_text("mean %.3f, black %.1f %%, white %.1f %%", mean / count, black / count * 100,
                white / count * 100);
}

static void save_rows(struct viewer *v)
{
    struct tool_error err = {0};
    ui_begin_disabled(!viewer_has_image(v));
    if (ui_button("Save"))
        v->save_wanted = true;
    ui_help("writes the picture, its AO as EXR, and the command line of vkao that makes it; of a "
            "live scene its G-buffer too");
    ui_same_line();
    if (ui_button("copy command") && !viewer_copy_command(v, &err))
        viewer_say_error(v, &err);
    ui_end_disabled();
    if (!v->live) {
        ui_same_line();
        if (ui_button("open"))
            viewer_browse(v);
        ui_help("lists the folder: Ctrl+O");
    }
    if (v->status.text[0])
        ui_paragraph(v->status.bad ? UI_BAD : UI_DIM, v->status.text);
}

/* --- On the picture --- */

/* Why a side shows nothing; NULL if it shows something. */
static const char *missing_of(const struct viewer *v, enum side side)
{
    if (!viewer_has_image(v))
        return "drop an EXR file here, or press Ctrl+O";
    if (v->view == VIEW_BENT && !method_has_bent(v->settings[side].effect.method))
        return "bent normals come with vbao, gtao and raymarch";
    if (v->view == VIEW_DIFFERENCE && v->live)
        return "a live scene has no reference";
    if (v->view == VIEW_DIFFERENCE && !v->source.now.reference.image)
        return "no reference: drop one here, or give --reference";
    return NULL;
}

/* The letter alone where there is no room for more. */
static void side_label(const struct viewer *v, enum side side, float from, float to)
{
    const enum ui_place place = side == SIDE_A ? UI_LEFT_OF : UI_RIGHT_OF;
    char title[64];
    side_title(v, side, title, sizeof title);
    if (!ui_label(from, to, 0, place, title))
        ui_label(from, to, 0, place, side == SIDE_A ? "A" : "B");
}

/* The panel says it otherwise; there is no room for all of what went well. */
static void status_label(const struct viewer *v, float from, float to)
{
    char text[sizeof v->status.text];
    if (!v->status.is_new || v->show_panel || !v->status.text[0])
        return;
    memcpy(text, v->status.text, sizeof text);
    if (!v->status.bad)
        text[strcspn(text, "\n")] = '\0';
    ui_label(from, to, (float)v->swapchain.extent.height, UI_ABOVE, text);
}

static void labels(const struct viewer *v)
{
    const VkRect2D area = viewer_area(v);
    const float left = (float)area.offset.x, right = left + (float)area.extent.width;
    const float middle = (float)area.extent.height / 2;
    const char *a = missing_of(v, SIDE_A), *b = missing_of(v, SIDE_B);
    status_label(v, left, right);
    if (!v->wipe || a == b) {
        const char *missing = v->active == SIDE_A ? a : b;
        if (missing)
            ui_label(left, right, middle, UI_AROUND, missing);
    }
    if (!v->wipe)
        return;
    const float line = (float)floor(v->wipe_at * v->swapchain.extent.width);
    if (a && a != b)
        ui_label(left, line, middle, UI_AROUND, a);
    if (b && a != b)
        ui_label(line + 1, right, middle, UI_AROUND, b);
    if (!v->show_panel)
        return;
    side_label(v, SIDE_A, left, line);
    side_label(v, SIDE_B, fmaxf(line + 1, left), right);
}

/* --- The list of files --- */

/* As many rows as the window has room for, the chosen one among them. */
static void file_list(struct viewer *v)
{
    enum { LEAST_ROWS = 3, MOST_ROWS = 20, OTHER_LINES = 5 };
    const struct browser *b = &v->browser;
    const VkExtent2D window = v->swapchain.extent;
    const size_t lines = ui_lines((float)window.height);
    const size_t room = lines > LEAST_ROWS + OTHER_LINES ? lines - OTHER_LINES : LEAST_ROWS;
    const size_t rows = room < MOST_ROWS ? room : MOST_ROWS;
    const size_t most = b->shown_count > rows ? b->shown_count - rows : 0;
    const size_t middle = b->at > rows / 2 ? b->at - rows / 2 : 0;
    const size_t first = middle < most ? middle : most;
    bool is_clicked = false;
    ui_begin_box((float)window.width, (float)window.height);
    char *whole = realpath(b->folder, NULL);
    ui_paragraph(UI_PLAIN, whole ? whole : b->folder);
    free(whole);
    ui_text("find: %s_", b->filter);
    for (size_t i = first; i < first + rows && i < b->shown_count; i++) {
        const struct browser_entry *entry = &b->entries[b->shown[i]];
        char row[300];
        /* Whatever lies under the mouse is brighter than what Enter opens. */
        snprintf(row, sizeof row, "%s%s%s##%zu", i == b->at ? "> " : "  ", entry->name,
                 entry->is_folder ? "/" : "", i);
        if (ui_choice(row, i == b->at, true)) {
            v->browser.at = i;
            is_clicked = true;
        }
    }
    ui_paragraph(v->status.bad && v->status.is_new ? UI_BAD : UI_DIM,
                 v->status.bad && v->status.is_new
                     ? v->status.text
                     : "type to find, Enter opens, Backspace: folder above, Esc");
    ui_end_box();
    if (is_clicked)
        viewer_choose_file(v);
}

void viewer_panel(struct viewer *viewer)
{
    struct viewer *v = viewer;
    labels(v);
    if (v->browser.is_open)
        file_list(v);
    if (v->show_help)
        ui_overlay((float)v->swapchain.extent.width, (float)v->swapchain.extent.height,
                   arguments_keys);
    if (!v->show_panel)
        return;
    ui_begin_panel((float)viewer_panel_width(v), (float)v->swapchain.extent.height);
    if (v->live)
        live_rows(v);
    else
        file_rows(v);
    ui_separator();
    view_rows(v);
    error_rows(v);
    ui_separator();
    side_rows(v);
    presets(v);
    copy_and_wipe(v);
    ui_begin_scroll();
    param_sections(v);
    ui_end_scroll();
    ui_separator();
    time_rows(v);
    histogram_rows(v);
    probe_rows(v);
    ui_separator();
    save_rows(v);
    if (!ui_end_panel())
        viewer_draw_more(v);
}
