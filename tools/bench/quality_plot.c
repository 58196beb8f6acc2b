/* SPDX-License-Identifier: MIT
 *
 * Error over time: a point per setting, lower and further left is better. */
#include "quality.h"

#include "axis.h"
#include "canvas.h"
#include "png_file.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
    PANEL_WIDTH = 900,
    PANEL_HEIGHT = 680,
    LEFT = 110,
    RIGHT = 30,
    TOP = 70,
    BOTTOM = 90,
    RADIUS = 9,
    SCALE = AXIS_TEXT_SCALE,
    MAX_TAKEN = 4096
};

static const struct rgb grey = {120, 120, 130};

/* By vkao_ssao_method; colours that stay apart for colour-blind eyes (Okabe and Ito). */
static const struct style {
    struct rgb color;
    enum marker marker;
} styles[] = {
    [VKAO_SSAO_SPHERE] = {{204, 121, 167}, MARKER_TRIANGLE},
    [VKAO_SSAO_HEMISPHERE] = {{230, 159, 0}, MARKER_SQUARE},
    [VKAO_SSAO_HBAO] = {{0, 158, 115}, MARKER_DIAMOND},
    [VKAO_SSAO_GTAO] = {{0, 114, 178}, MARKER_SQUARE},
    [VKAO_SSAO_VBAO] = {{213, 94, 0}, MARKER_DISC},
    [VKAO_SSAO_RAYMARCH] = {{90, 90, 98}, MARKER_DIAMOND},
};

struct rect {
    double x0, y0, x1, y1;
};

struct panel {
    struct canvas *canvas;
    const struct quality *quality;
    int falloff;
    double offset; /* of its left edge */
    struct axis x, y;
    struct quality_cell means[MAX_CONFIGS];
    struct rect taken[MAX_TAKEN]; /* what labels should leave alone */
    size_t taken_count;
};

static void draw_frame(struct panel *p)
{
    char title[128];
    static const char across[] = "GPU time, ms per megatexel", up[] = "RMSE against ray-traced AO";
    snprintf(title, sizeof title, "Falloff %s, mean of %zu image%s", falloff_name(p->falloff),
             p->quality->count, p->quality->count == 1 ? "" : "s");
    axes_draw(p->canvas, &p->x, &p->y, title, across, up);
}

/* --- Points --- */

static bool overlap(const struct rect *a, const struct rect *b)
{
    return a->x0 < b->x1 && b->x0 < a->x1 && a->y0 < b->y1 && b->y0 < a->y1;
}

static void take(struct panel *p, struct rect rect)
{
    if (p->taken_count < MAX_TAKEN)
        p->taken[p->taken_count++] = rect;
}

static struct rect label_rect(struct point marker, double width, double height, unsigned place)
{
    /* Right, left, above, below, and the corners; once more further away. */
    static const signed char sides[8][2] = {{1, 0},  {-1, 0}, {0, -1}, {0, 1},
                                            {1, -1}, {1, 1},  {-1, 1}, {-1, -1}};
    double dx = sides[place % 8][0], dy = sides[place % 8][1];
    double gap = RADIUS + 6 + (place / 8) * 14;
    double x = marker.x + dx * gap + (dx < 0 ? -width : dx > 0 ? 0 : -width / 2);
    double y = marker.y + dy * (gap + height / 2) - height / 2;
    return (struct rect){x, y, x + width, y + height};
}

/* How much of what is there it would hide; a lot outside the axes. */
static size_t conflicts(const struct panel *p, const struct rect *rect)
{
    bool inside = rect->x0 > p->x.start + 3 && rect->x1 < p->x.end - 3 && rect->y0 > p->y.end + 3 &&
                  rect->y1 < p->y.start - 3;
    size_t count = inside ? 0 : MAX_TAKEN;
    for (size_t i = 0; i < p->taken_count; i++)
        count += overlap(rect, &p->taken[i]);
    return count;
}

/* Lines count by their length. */
static void take_line(struct panel *p, struct point from, struct point to)
{
    double length = hypot(to.x - from.x, to.y - from.y);
    for (double t = 0; t < length; t += 6) {
        double x = from.x + (to.x - from.x) * t / length;
        double y = from.y + (to.y - from.y) * t / length;
        take(p, (struct rect){x - 1, y - 1, x + 1, y + 1});
    }
}

static struct point point_of(const struct panel *p, size_t config)
{
    return (struct point){axis_place(&p->x, p->means[config].ms_per_megatexel),
                          axis_place(&p->y, p->means[config].truth.rmse)};
}

static void draw_label(struct panel *p, size_t config)
{
    const struct config *c = &p->quality->configs.rows[config];
    struct point at = point_of(p, config);
    double width = canvas_text_width(c->name, SCALE), height = canvas_text_height(SCALE) + 4;
    struct rect rect = {0};
    size_t fewest = SIZE_MAX;
    for (unsigned place = 0; place < 24; place++) {
        struct rect candidate = label_rect(at, width, height, place);
        size_t count = conflicts(p, &candidate);
        if (count >= fewest)
            continue;
        fewest = count;
        rect = candidate;
    }
    take(p, rect);
    canvas_text(p->canvas, c->name, (struct point){rect.x0, rect.y0 + 2}, SCALE,
                styles[c->method].color);
}

/* A level, not a point: about what the depth image gives away at any cost. */
static void draw_level(struct panel *p, size_t config)
{
    char label[64];
    snprintf(label, sizeof label, "raymarch, %u x %u rays", p->quality->passes,
             p->quality->configs.rows[config].samples);
    double y = point_of(p, config).y, width = canvas_text_width(label, SCALE);
    double height = canvas_text_height(SCALE), right = p->x.end - 10 - width;
    const struct point corners[] = {{right, y + 6},
                                    {right, y - height - 6},
                                    {p->x.start + 10, y + 6},
                                    {p->x.start + 10, y - height - 6}};
    const struct point start = {p->x.start, y}, end = {p->x.end, y};
    struct point at = corners[0];
    size_t fewest = SIZE_MAX;
    for (size_t i = 0; i < sizeof corners / sizeof corners[0]; i++) {
        const struct point c = corners[i];
        const struct rect rect = {c.x, c.y, c.x + width, c.y + height};
        size_t count = conflicts(p, &rect);
        if (count >= fewest)
            continue;
        fewest = count;
        at = c;
    }
    canvas_line(p->canvas, start, end, 1.5, 6, grey);
    take_line(p, start, end);
    canvas_text(p->canvas, label, at, SCALE, grey);
    take(p, (struct rect){at.x, at.y, at.x + width, at.y + height});
}

static struct rgb paler(struct rgb color)
{
    return (struct rgb){(uint8_t)((color.r + 255) / 2), (uint8_t)((color.g + 255) / 2),
                        (uint8_t)((color.b + 255) / 2)};
}

/* Settings of one method belong together. */
static void draw_thread(struct panel *p, size_t config)
{
    const struct config_list *configs = &p->quality->configs;
    const struct config *to = &configs->rows[config];
    for (size_t c = config; c-- > 0;) {
        const struct config *from = &configs->rows[c];
        if (from->method != to->method || from->is_yardstick)
            continue;
        canvas_line(p->canvas, point_of(p, c), point_of(p, config), 1.5, 0,
                    paler(styles[to->method].color));
        take_line(p, point_of(p, c), point_of(p, config));
        return;
    }
}

static void set_axes(struct panel *p)
{
    const struct config_list *configs = &p->quality->configs;
    p->x = p->y = (struct axis){.low = INFINITY, .high = 0};
    for (size_t c = 0; c < configs->count; c++) {
        p->means[c] = quality_mean(p->quality, p->falloff, c);
        if (!configs->rows[c].is_yardstick)
            axis_include(&p->x, p->means[c].ms_per_megatexel);
        axis_include(&p->y, p->means[c].truth.rmse);
    }
    axis_widen(&p->x, 1.3);
    axis_widen(&p->y, 1.12);
    p->x.start = p->offset + LEFT;
    p->x.end = p->offset + PANEL_WIDTH - RIGHT;
    p->y.start = PANEL_HEIGHT - BOTTOM;
    p->y.end = TOP;
}

static void draw_panel(struct panel *p)
{
    const struct config *configs = p->quality->configs.rows;
    size_t count = p->quality->configs.count;
    set_axes(p);
    draw_frame(p);
    for (size_t c = 0; c < count; c++) {
        struct point at = point_of(p, c);
        if (configs[c].is_yardstick)
            continue;
        take(p, (struct rect){at.x - RADIUS, at.y - RADIUS, at.x + RADIUS, at.y + RADIUS});
        draw_thread(p, c);
    }
    for (size_t c = 0; c < count; c++)
        if (configs[c].is_yardstick)
            draw_level(p, c);
    for (size_t c = 0; c < count; c++)
        if (!configs[c].is_yardstick)
            draw_label(p, c);
    for (size_t c = 0; c < count; c++) {
        const struct style *style = &styles[configs[c].method];
        if (!configs[c].is_yardstick)
            canvas_marker(p->canvas, style->marker, point_of(p, c), RADIUS, style->color);
    }
}

bool quality_plot(const struct quality *quality, const char *path, struct tool_error *err)
{
    struct canvas canvas;
    uint32_t panels = 0;
    for (int f = 0; f < FALLOFFS; f++)
        panels += quality->has_falloff[f];
    if (!canvas_create(&canvas, panels * PANEL_WIDTH, PANEL_HEIGHT, err))
        return false;
    panels = 0;
    for (int f = 0; f < FALLOFFS; f++) {
        if (!quality->has_falloff[f])
            continue;
        struct panel panel = {.canvas = &canvas,
                              .quality = quality,
                              .falloff = f,
                              .offset = (double)(panels++ * PANEL_WIDTH)};
        draw_panel(&panel);
    }
    bool ok = png_file_write(path, canvas.width, canvas.height, 3, canvas.pixels, true, err);
    canvas_free(&canvas);
    return ok;
}
