/* SPDX-License-Identifier: MIT */
#include "canvas.h"

#include "font.h"
#include "text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool canvas_create(struct canvas *canvas, uint32_t width, uint32_t height, struct tool_error *err)
{
    size_t pixels, bytes;
    *canvas = (struct canvas){.width = width, .height = height};
    if (size_multiply(width, height, &pixels) && size_multiply(pixels, 3, &bytes))
        canvas->pixels = malloc(bytes);
    if (!canvas->pixels)
        return fail(err, EXIT_MEMORY, "out of memory for a picture of %u x %u", width, height);
    memset(canvas->pixels, 255, bytes);
    return true;
}

void canvas_free(struct canvas *canvas)
{
    free(canvas->pixels);
    *canvas = (struct canvas){0};
}

static void blend(struct canvas *canvas, int64_t x, int64_t y, double coverage, struct rgb color)
{
    if (x < 0 || y < 0 || x >= canvas->width || y >= canvas->height || !(coverage > 0))
        return;
    uint8_t *pixel = canvas->pixels + ((size_t)y * canvas->width + (size_t)x) * 3;
    const double values[3] = {color.r, color.g, color.b};
    double part = coverage < 1 ? coverage : 1;
    for (int i = 0; i < 3; i++)
        pixel[i] = (uint8_t)lround(pixel[i] + (values[i] - pixel[i]) * part);
}

/* How much of the pixel that begins at p lies in [low,high). */
static double overlap(double p, double low, double high)
{
    return fmax(0, fmin(p + 1, high) - fmax(p, low));
}

void canvas_fill(struct canvas *canvas, struct point from, struct point to, struct rgb color)
{
    for (int64_t y = (int64_t)floor(from.y); (double)y < to.y; y++)
        for (int64_t x = (int64_t)floor(from.x); (double)x < to.x; x++)
            blend(canvas, x, y, overlap((double)x, from.x, to.x) * overlap((double)y, from.y, to.y),
                  color);
}

/* --- Lines and markers: coverage from the distance to the outline --- */

/* Distance of p to the segment from a to b; *along is how far it lies along the segment. */
static double segment_distance(struct point p, struct point a, struct point b, double *along)
{
    double dx = b.x - a.x, dy = b.y - a.y, length = hypot(dx, dy);
    double t = length > 0 ? ((p.x - a.x) * dx + (p.y - a.y) * dy) / length : 0;
    t = t < 0 ? 0 : t > length ? length : t;
    *along = t;
    double x = length > 0 ? a.x + dx * t / length : a.x;
    double y = length > 0 ? a.y + dy * t / length : a.y;
    return hypot(p.x - x, p.y - y);
}

void canvas_line(struct canvas *canvas, struct point a, struct point b, double thickness,
                 double dash, struct rgb color)
{
    double margin = thickness * 0.5 + 1;
    int64_t x0 = (int64_t)floor(fmin(a.x, b.x) - margin),
            x1 = (int64_t)ceil(fmax(a.x, b.x) + margin);
    int64_t y0 = (int64_t)floor(fmin(a.y, b.y) - margin),
            y1 = (int64_t)ceil(fmax(a.y, b.y) + margin);
    for (int64_t y = y0; y < y1; y++) {
        for (int64_t x = x0; x < x1; x++) {
            double along;
            struct point p = {(double)x + 0.5, (double)y + 0.5};
            double distance = segment_distance(p, a, b, &along);
            if (dash > 0 && fmod(along, 2 * dash) >= dash)
                continue;
            blend(canvas, x, y, thickness * 0.5 + 0.5 - distance, color);
        }
    }
}

static double disc_distance(double x, double y, double radius)
{
    return hypot(x, y) - radius;
}

static double square_distance(double x, double y, double radius)
{
    return fmax(fabs(x), fabs(y)) - radius * 0.88;
}

static double diamond_distance(double x, double y, double radius)
{
    return (fabs(x) + fabs(y)) * 0.7071 - radius * 0.88;
}

static double triangle_distance(double x, double y, double radius)
{
    return fmax(fabs(x) * 0.866 - y * 0.5, y) - radius * 0.62;
}

void canvas_marker(struct canvas *canvas, enum marker marker, struct point centre, double radius,
                   struct rgb color)
{
    static double (*const distances[MARKERS])(double, double, double) = {
        disc_distance, square_distance, diamond_distance, triangle_distance};
    static const struct rgb white = {255, 255, 255};
    double reach = radius * 2 + 3;
    for (int64_t y = (int64_t)(centre.y - reach); y < (int64_t)(centre.y + reach); y++) {
        for (int64_t x = (int64_t)(centre.x - reach); x < (int64_t)(centre.x + reach); x++) {
            double distance =
                distances[marker]((double)x + 0.5 - centre.x, (double)y + 0.5 - centre.y, radius);
            blend(canvas, x, y, 2.5 - distance, white);
            blend(canvas, x, y, 0.5 - distance, color);
        }
    }
}

/* --- Text --- */

static void fill_square(struct canvas *canvas, double x, double y, unsigned size, struct rgb color)
{
    for (unsigned j = 0; j < size; j++)
        for (unsigned i = 0; i < size; i++)
            blend(canvas, (int64_t)x + i, (int64_t)y + j, 1, color);
}

static void draw_text(struct canvas *canvas, const char *text, struct point at, unsigned scale,
                      bool upwards, struct rgb color)
{
    for (size_t c = 0; text[c]; c++) {
        const uint8_t *glyph = font_glyph(text[c]);
        for (unsigned row = 0; glyph && row < FONT_ROWS; row++) {
            for (unsigned column = 0; column < FONT_COLUMNS; column++) {
                if (!(glyph[row] >> (FONT_COLUMNS - 1 - column) & 1))
                    continue;
                double along = ((double)c * FONT_ADVANCE + column) * scale, down = row * scale;
                if (upwards)
                    fill_square(canvas, at.x + down, at.y - along - scale, scale, color);
                else
                    fill_square(canvas, at.x + along, at.y + down, scale, color);
            }
        }
    }
}

void canvas_text(struct canvas *canvas, const char *text, struct point at, unsigned scale,
                 struct rgb color)
{
    draw_text(canvas, text, at, scale, false, color);
}

void canvas_text_upwards(struct canvas *canvas, const char *text, struct point at, unsigned scale,
                         struct rgb color)
{
    draw_text(canvas, text, at, scale, true, color);
}

double canvas_text_width(const char *text, unsigned scale)
{
    size_t length = strlen(text);
    return length ? (double)(length * FONT_ADVANCE - 1) * scale : 0;
}

double canvas_text_height(unsigned scale)
{
    return (double)FONT_BASELINE * scale;
}
