/* SPDX-License-Identifier: MIT
 *
 * What is counted of a picture: its distance to the reference, and how often it has which value. */
#include "png_file.h"
#include "values.h"

#include <math.h>
#include <string.h>

/* RMS difference over the image, once for each result. */
static bool measure_error(struct viewer *v, enum side side, struct tool_error *err)
{
    const struct loaded_frame *l = &v->source.now;
    struct rendered_view r;
    if (v->live || v->view != VIEW_DIFFERENCE || v->error[side] >= 0 || v->stale[side] ||
        !l->reference_values || !last_result(v, side)->frame)
        return true;
    bool ok = values_take(v, side, &r, err);
    const size_t texels = (size_t)l->gbuffer.width * l->gbuffer.height;
    size_t count = 0;
    double sum = 0;
    for (size_t i = 0; ok && i < texels; i++) {
        const double d = (double)r.result.ao[i] - (double)l->reference_values[i];
        sum += isfinite(d) ? d * d : 0;
        count += isfinite(d) ? 1 : 0;
    }
    v->error[side] = !ok ? -1 : count > 0 ? sqrt(sum / (double)count) : INFINITY;
    values_free(&r);
    return ok;
}

static bool is_grey(uint32_t mode)
{
    return mode == DISPLAY_AO || mode == DISPLAY_DEPTH;
}

/* Of the active side, at most so many texels, evenly spread. */
static bool measure_histogram(struct viewer *v, struct tool_error *err)
{
    enum { MOST_TEXELS = 1 << 18 };
    struct histogram *h = &v->histogram;
    const enum side side = v->active;
    struct rendered_view r;
    if (!h->is_wanted || (h->is_known && !v->live) || v->stale[side] ||
        !last_result(v, side)->frame)
        return true;
    const struct tone tone = viewer_tone(v, side);
    bool ok = values_take(v, side, &r, err);
    const size_t texels = (size_t)r.gbuffer.width * r.gbuffer.height;
    const size_t step = texels / MOST_TEXELS + 1;
    memset(h->bins, 0, sizeof h->bins);
    h->curves = is_grey(tone.mode) ? 1 : 3;
    h->count = 0;
    for (size_t i = 0; ok && tone.mode != DISPLAY_NOTHING && i < texels; i += step) {
        double color[3];
        values_color(v, &tone, &r, i, color);
        for (uint32_t c = 0; c < h->curves; c++)
            h->bins[c][byte_of(color[c])]++;
        h->count++;
    }
    h->is_known = ok;
    values_free(&r);
    return ok;
}

bool viewer_measure(struct viewer *viewer, struct tool_error *err)
{
    for (int s = 0; s < SIDES; s++)
        if (!measure_error(viewer, (enum side)s, err))
            return false;
    return measure_histogram(viewer, err);
}
