/* SPDX-License-Identifier: MIT */
#include "light.h"

static float add(const float *plane, size_t i)
{
    return plane ? plane[i] : 0.0f;
}

static void finish_texel(const struct gbuffer *g, size_t texel, float *rgb)
{
    const float held = add(g->holdout, texel);
    for (size_t i = texel * 4, c = 0; c < 3; i++, c++) {
        const float before = g->color[i] + add(g->kept, i) + add(g->specular, i);
        const float after = rgb[c] + add(g->kept, i);
        rgb[c] = held > 0.0f ? after + (before - after) * held : after;
    }
}

void light_finish(const struct gbuffer *gbuffer, struct ao_result *result)
{
    const size_t texels = (size_t)gbuffer->width * gbuffer->height;
    for (size_t i = 0; gbuffer->holdout && i < texels; i++)
        result->ao[i] += (1.0f - result->ao[i]) * gbuffer->holdout[i];
    if (!result->output || (!gbuffer->holdout && !gbuffer->kept))
        return;
    for (size_t i = 0; i < texels; i++)
        finish_texel(gbuffer, i, result->output + i * 4);
}
