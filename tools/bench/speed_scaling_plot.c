/* SPDX-License-Identifier: MIT
 *
 * Growth with pixels, samples and radius, log-log: what grows in proportion follows the dashes. */
#include "speed.h"

#include "axis.h"
#include "png_file.h"

#include <math.h>
#include <stdio.h>

enum {
    PANEL_WIDTH = 640,
    PANEL_HEIGHT = 560,
    LEFT = 110,
    RIGHT = 20,
    TOP = 70,
    BOTTOM = 90,
    SCALE = AXIS_TEXT_SCALE
};

static const struct rgb grey = {120, 120, 130};

static const struct line {
    enum stage stage;
    enum marker marker;
    struct rgb color;
} lines[] = {
    {STAGE_TOTAL, MARKER_DISC, {213, 94, 0}},
    {STAGE_SSAO, MARKER_SQUARE, {0, 114, 178}},
};
enum { LINES = sizeof lines / sizeof lines[0] };

struct panel {
    struct canvas *canvas;
    const struct speed_row *rows; /* of one series */
    size_t count;
    struct axis x, y;
};

/* Millions of pixels, whose labels are shorter. */
static double value_of(const struct speed_row *row)
{
    return row->series == SERIES_PIXELS ? row->value * 1e-6 : row->value;
}

static struct point point_of(const struct panel *p, size_t row, enum stage stage)
{
    return (struct point){axis_place(&p->x, value_of(&p->rows[row])),
                          axis_place(&p->y, p->rows[row].median[stage])};
}

/* From the last point back, as far as the frame allows: the first ones hold what never varies. */
static void draw_proportion(const struct panel *p, enum stage stage)
{
    const struct speed_row *first = &p->rows[0], *last = &p->rows[p->count - 1];
    double per_value = last->median[stage] / value_of(last);
    double low = fmax(value_of(first), p->y.low / per_value);
    const struct point from = {axis_place(&p->x, low), axis_place(&p->y, low * per_value)};
    canvas_line(p->canvas, from, point_of(p, p->count - 1, stage), 1.5, 6, grey);
}

static void draw_line(const struct panel *p, const struct line *line)
{
    for (size_t i = 1; i < p->count; i++)
        canvas_line(p->canvas, point_of(p, i - 1, line->stage), point_of(p, i, line->stage), 2, 0,
                    line->color);
    for (size_t i = 0; i < p->count; i++)
        canvas_marker(p->canvas, line->marker, point_of(p, i, line->stage), 8, line->color);
}

static void draw_legend(const struct panel *p)
{
    for (int i = 0; i < LINES; i++) {
        struct point at = {p->x.end - 96, p->y.start - 24 - (LINES - 1 - i) * 26};
        canvas_marker(p->canvas, lines[i].marker, at, 8, lines[i].color);
        canvas_text(p->canvas, stage_name(lines[i].stage), (struct point){at.x + 18, at.y - 7},
                    SCALE, lines[i].color);
    }
}

static void draw_panel(struct panel *p, double offset)
{
    const struct speed_row *row = p->rows;
    char title[96];
    p->x = (struct axis){.low = INFINITY, .high = 0};
    for (size_t i = 0; i < p->count; i++)
        axis_include(&p->x, value_of(&p->rows[i]));
    axis_widen(&p->x, 1.3);
    p->x.start = offset + LEFT;
    p->x.end = offset + PANEL_WIDTH - RIGHT;
    if (row->series == SERIES_PIXELS)
        snprintf(title, sizeof title, "%s", row->name);
    else
        snprintf(title, sizeof title, "%s, %u x %u", config_method_name(&row->config),
                 row->extent.width, row->extent.height);
    axes_draw(p->canvas, &p->x, &p->y, title,
              row->series == SERIES_PIXELS ? "megapixels" : speed_series_name(row->series), "ms");
    for (int i = 0; i < LINES; i++) {
        if (row->series != SERIES_RADIUS)
            draw_proportion(p, lines[i].stage);
        draw_line(p, &lines[i]);
    }
    draw_legend(p);
}

bool speed_scaling_plot(const struct speed *speed, const char *path, struct tool_error *err)
{
    struct canvas canvas;
    struct axis y = {.low = INFINITY, .high = 0, .start = PANEL_HEIGHT - BOTTOM, .end = TOP};
    uint32_t panels = 0;
    for (size_t i = 0; i < speed->count; i++) {
        panels += i == 0 || speed->rows[i].series != speed->rows[i - 1].series;
        for (int l = 0; l < LINES; l++)
            axis_include(&y, speed->rows[i].median[lines[l].stage]);
    }
    axis_widen(&y, 1.5);
    if (!canvas_create(&canvas, panels * PANEL_WIDTH, PANEL_HEIGHT, err))
        return false;
    panels = 0;
    for (size_t begin = 0, end = 0; begin < speed->count; begin = end) {
        while (end < speed->count && speed->rows[end].series == speed->rows[begin].series)
            end++;
        struct panel panel = {
            .canvas = &canvas, .rows = speed->rows + begin, .count = end - begin, .y = y};
        draw_panel(&panel, (double)(panels++ * PANEL_WIDTH));
    }
    bool ok = png_file_write(path, canvas.width, canvas.height, 3, canvas.pixels, true, err);
    canvas_free(&canvas);
    return ok;
}
