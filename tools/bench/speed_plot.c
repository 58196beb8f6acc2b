/* SPDX-License-Identifier: MIT
 *
 * Where the time goes: a bar per setting, a colour per stage. In milliseconds at one size; in
 * nanoseconds per texel at several, which makes them comparable. */
#include "speed.h"

#include "canvas.h"
#include "png_file.h"

#include <math.h>
#include <stdio.h>

enum {
    WIDTH = 1200,
    LEFT = 250,
    RIGHT = 130,
    TOP = 60,
    BOTTOM = 70,
    BAR = 24,
    PITCH = 36,
    HEADING = 40,
    SCALE = 2
};

static const struct rgb ink = {40, 40, 46}, faint = {226, 226, 232};

/* Colours that stay apart for colour-blind eyes (Okabe and Ito); grey is what no stage has. */
static const struct rgb colors[STAGES] = {
    [STAGE_PREPARE] = {86, 180, 233}, [STAGE_SSAO] = {0, 114, 178},
    [STAGE_BLUR] = {230, 159, 0},     [STAGE_UPSAMPLE] = {0, 158, 115},
    [STAGE_COMPOSITE] = {213, 94, 0}, [STAGE_TOTAL] = {190, 190, 198},
};

struct chart {
    struct canvas canvas;
    const struct speed *speed;
    bool per_texel;
    double most; /* at the right end */
};

static bool begins_size(const struct speed_row *rows, size_t i)
{
    return i == 0 || rows[i].extent.width != rows[i - 1].extent.width ||
           rows[i].extent.height != rows[i - 1].extent.height;
}

static double value_of(const struct chart *c, const struct speed_row *row, int stage)
{
    double texels = (double)row->extent.width * row->extent.height;
    return row->median[stage] * (c->per_texel ? 1e6 / texels : 1);
}

static double place(const struct chart *c, double value)
{
    return LEFT + value / c->most * (WIDTH - LEFT - RIGHT);
}

/* 1, 2 or 5 times a power of ten: four to ten of them in `most`. */
static double tick_step(double most)
{
    double power = pow(10, floor(log10(most / 4))), digit = most / 4 / power;
    return power * (digit >= 5 ? 5 : digit >= 2 ? 2 : 1);
}

static void draw_axis(struct chart *c)
{
    const double bottom = (double)c->canvas.height - BOTTOM, step = tick_step(c->most);
    const char *unit = c->per_texel ? "ns per texel" : "ms";
    for (int i = 0; i * step <= c->most; i++) {
        char label[32];
        double x = place(c, i * step);
        snprintf(label, sizeof label, "%g", i * step);
        canvas_line(&c->canvas, (struct point){x, TOP}, (struct point){x, bottom}, 1, 0, faint);
        canvas_text(&c->canvas, label,
                    (struct point){x - canvas_text_width(label, SCALE) / 2, bottom + 8}, SCALE,
                    ink);
    }
    canvas_text(
        &c->canvas, unit,
        (struct point){(LEFT + WIDTH - RIGHT - canvas_text_width(unit, SCALE)) / 2, bottom + 36},
        SCALE, ink);
}

static void draw_legend(struct chart *c)
{
    double x = LEFT;
    for (int s = 0; s < STAGE_TOTAL; s++) {
        const char *name = stage_name((enum stage)s);
        bool used = false;
        for (size_t i = 0; i < c->speed->count; i++)
            used = used || c->speed->rows[i].median[s] > 0;
        if (!used)
            continue;
        canvas_fill(&c->canvas, (struct point){x, 20}, (struct point){x + 18, 38}, colors[s]);
        canvas_text(&c->canvas, name, (struct point){x + 26, 22}, SCALE, ink);
        x += 26 + canvas_text_width(name, SCALE) + 30;
    }
}

static void draw_bar(struct chart *c, const struct speed_row *row, double y)
{
    char number[32];
    double sum = 0, total = value_of(c, row, STAGE_TOTAL), end = place(c, total);
    canvas_text(&c->canvas, row->name,
                (struct point){LEFT - 12 - canvas_text_width(row->name, SCALE), y + 5}, SCALE, ink);
    /* Between the stages, and all of it where the queue has no timestamps. */
    canvas_fill(&c->canvas, (struct point){LEFT, y}, (struct point){end, y + BAR},
                colors[STAGE_TOTAL]);
    for (int s = 0; s < STAGE_TOTAL; s++) {
        double x0 = place(c, sum), x1 = place(c, fmin(sum + value_of(c, row, s), total));
        canvas_fill(&c->canvas, (struct point){x0, y}, (struct point){x1, y + BAR}, colors[s]);
        sum += value_of(c, row, s);
    }
    speed_format_ms(total, number, sizeof number);
    canvas_text(&c->canvas, number, (struct point){end + 10, y + 5}, SCALE, ink);
}

static void draw_bars(struct chart *c)
{
    const struct speed_row *rows = c->speed->rows;
    double y = TOP + 8;
    for (size_t i = 0; i < c->speed->count; i++) {
        if (begins_size(rows, i)) {
            char heading[64];
            snprintf(heading, sizeof heading, "%u x %u", rows[i].extent.width,
                     rows[i].extent.height);
            canvas_text(&c->canvas, heading, (struct point){LEFT, y + 14}, SCALE, ink);
            y += HEADING;
        }
        draw_bar(c, &rows[i], y);
        y += PITCH;
    }
}

bool speed_plot(const struct speed *speed, const char *path, struct tool_error *err)
{
    struct chart chart = {.speed = speed};
    uint32_t sizes = 0, rows = (uint32_t)speed->count;
    for (size_t i = 0; i < speed->count; i++)
        sizes += begins_size(speed->rows, i);
    chart.per_texel = sizes > 1;
    for (size_t i = 0; i < speed->count; i++)
        chart.most = fmax(chart.most, value_of(&chart, &speed->rows[i], STAGE_TOTAL));
    chart.most = chart.most > 0 ? chart.most : 1;
    if (!canvas_create(&chart.canvas, WIDTH, TOP + 8 + sizes * HEADING + rows * PITCH + BOTTOM,
                       err))
        return false;
    draw_axis(&chart);
    draw_legend(&chart);
    draw_bars(&chart);
    bool ok = png_file_write(path, chart.canvas.width, chart.canvas.height, 3, chart.canvas.pixels,
                             true, err);
    canvas_free(&chart.canvas);
    return ok;
}
