/* SPDX-License-Identifier: MIT */
#include "axis.h"

#include <math.h>
#include <stdio.h>

enum { SCALE = AXIS_TEXT_SCALE };

static const struct rgb ink = {40, 40, 46}, faint = {226, 226, 232}, grey = {120, 120, 130};

double axis_place(const struct axis *axis, double value)
{
    double t = log(value / axis->low) / log(axis->high / axis->low);
    return axis->start + t * (axis->end - axis->start);
}

void axis_include(struct axis *axis, double value)
{
    if (!(value > 0) || !isfinite(value))
        return;
    axis->low = value < axis->low ? value : axis->low;
    axis->high = value > axis->high ? value : axis->high;
}

void axis_widen(struct axis *axis, double factor)
{
    if (!(axis->low <= axis->high))
        axis->low = axis->high = 1;
    double middle = sqrt(axis->low * axis->high);
    axis->low = fmin(axis->low / factor, middle / 1.42);
    axis->high = fmax(axis->high * factor, middle * 1.42);
}

/* of: x or y */
static void draw_tick(struct canvas *canvas, const struct axis *x, const struct axis *y,
                      const struct axis *of, double value, bool labelled)
{
    char label[32];
    bool across = of == x;
    double at = axis_place(of, value);
    struct point from = {across ? at : x->start, across ? y->start : at};
    struct point to = {across ? at : x->end, across ? y->end : at};
    canvas_line(canvas, from, to, 1, labelled ? 0 : 2, faint);
    if (!labelled)
        return;
    snprintf(label, sizeof label, "%g", value);
    double width = canvas_text_width(label, SCALE);
    struct point text = {at - width / 2, y->start + 12};
    if (!across)
        text = (struct point){x->start - width - 10, at - canvas_text_height(SCALE) / 2};
    canvas_text(canvas, label, text, SCALE, ink);
}

static void draw_ticks(struct canvas *canvas, const struct axis *x, const struct axis *y,
                       const struct axis *of)
{
    double decades = log10(of->high / of->low);
    for (int exponent = (int)floor(log10(of->low)); pow(10, exponent) <= of->high; exponent++) {
        for (int digit = 1; digit <= 9; digit++) {
            double value = digit * pow(10, exponent);
            bool round = digit == 1 || digit == 2 || digit == 5;
            /* On a short axis every digit has room; on a long one the powers of ten alone. */
            bool labelled = decades < 0.6 || (decades < 2.5 ? round : digit == 1);
            if (value >= of->low && value <= of->high)
                draw_tick(canvas, x, y, of, value, labelled);
        }
    }
}

void axes_draw(struct canvas *canvas, const struct axis *x, const struct axis *y, const char *title,
               const char *across, const char *up)
{
    const struct point corner[4] = {
        {x->start, y->start}, {x->end, y->start}, {x->end, y->end}, {x->start, y->end}};
    const double centre = (x->start + x->end) / 2, middle = (y->start + y->end) / 2;
    draw_ticks(canvas, x, y, x);
    draw_ticks(canvas, x, y, y);
    for (int i = 0; i < 4; i++)
        canvas_line(canvas, corner[i], corner[(i + 1) % 4], 1.5, 0, grey);
    canvas_text(canvas, title,
                (struct point){centre - canvas_text_width(title, SCALE) / 2, y->end - 34}, SCALE,
                ink);
    canvas_text(canvas, across,
                (struct point){centre - canvas_text_width(across, SCALE) / 2, y->start + 40}, SCALE,
                ink);
    canvas_text_upwards(canvas, up,
                        (struct point){x->start - 96, middle + canvas_text_width(up, SCALE) / 2},
                        SCALE, ink);
}
