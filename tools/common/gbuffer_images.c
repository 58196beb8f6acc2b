/* SPDX-License-Identifier: MIT
 *
 * Images of roles: each lies in the window of its own part, and is wanted in that of the depth. */
#include "gbuffer_internal.h"

#include <stdlib.h>
#include <string.h>

float *gbuffer_allocate(size_t texels, size_t components, const char *path, struct tool_error *err)
{
    size_t count, bytes;
    float *values = NULL;
    if (size_multiply(texels, components, &count) && size_multiply(count, sizeof *values, &bytes))
        values = malloc(bytes);
    if (!values)
        fail(err, EXIT_MEMORY, "%s: out of memory for %zu texels", path, texels);
    return values;
}

bool gbuffer_same_box(const struct exr_box *a, const struct exr_box *b)
{
    return a->x_min == b->x_min && a->y_min == b->y_min && a->x_max == b->x_max &&
           a->y_max == b->y_max;
}

/* Copies where the boxes overlap; the rest of dst stays. */
static void copy_overlap(float *dst, const struct exr_box *dst_box, const float *src,
                         const struct exr_box *src_box, size_t components)
{
    int64_t x0 = dst_box->x_min > src_box->x_min ? dst_box->x_min : src_box->x_min;
    int64_t x1 = dst_box->x_max < src_box->x_max ? dst_box->x_max : src_box->x_max;
    int64_t y0 = dst_box->y_min > src_box->y_min ? dst_box->y_min : src_box->y_min;
    int64_t y1 = dst_box->y_max < src_box->y_max ? dst_box->y_max : src_box->y_max;
    int64_t dst_width = (int64_t)dst_box->x_max - dst_box->x_min + 1;
    int64_t src_width = (int64_t)src_box->x_max - src_box->x_min + 1;
    for (int64_t y = y0; x0 <= x1 && y <= y1; y++) {
        int64_t to = (y - dst_box->y_min) * dst_width + (x0 - dst_box->x_min);
        int64_t from = (y - src_box->y_min) * src_width + (x0 - src_box->x_min);
        memcpy(dst + (size_t)to * components, src + (size_t)from * components,
               (size_t)(x1 - x0 + 1) * components * sizeof *dst);
    }
}

static void fill(float *values, size_t count, float value)
{
    for (size_t i = 0; i < count; i++)
        values[i] = value;
}

size_t gbuffer_box_texels(const struct exr_box *box)
{
    const size_t width = (size_t)((int64_t)box->x_max - box->x_min + 1);
    const size_t height = (size_t)((int64_t)box->y_max - box->y_min + 1);
    size_t texels;
    return size_multiply(width, height, &texels) ? texels : SIZE_MAX;
}

/* A role with so many floats per texel in the window of its own part; missing: a fourth component
 * that is not there. */
static float *read_own_window(const struct role *role, size_t components, float missing,
                              struct tool_error *err)
{
    const size_t texels = gbuffer_box_texels(&role->info->parts[role->part].data_window);
    float *values = gbuffer_allocate(texels, components, role->info->path, err);
    if (!values)
        return NULL;
    fill(values, texels * components, missing);
    struct exr_read reads[4];
    size_t count = 0;
    for (size_t i = 0; i < components; i++)
        if (role->channels[i])
            reads[count++] = (struct exr_read){role->channels[i]->name, values + i, components};
    if (exr_read_channels(role->info, role->part, reads, count, err))
        return values;
    free(values);
    return NULL;
}

float *gbuffer_read_role(const struct gbuffer *g, const struct role *role, size_t components,
                         float missing, struct tool_error *err)
{
    const struct exr_box *box = &role->info->parts[role->part].data_window;
    float *values = read_own_window(role, components, missing, err);
    if (!values || gbuffer_same_box(box, &g->data_window))
        return values;
    float *aligned = gbuffer_allocate(gbuffer_texels(g), components, role->info->path, err);
    if (aligned) {
        fill(aligned, gbuffer_texels(g) * components, missing);
        copy_overlap(aligned, &g->data_window, values, box, components);
    }
    free(values);
    return aligned;
}

void gbuffer_complete_alpha(const struct gbuffer *g, float *color, size_t texels)
{
    for (size_t i = 0; !g->color_has_alpha && i < texels; i++)
        color[i * 4 + 3] = 1.0f;
}

float *gbuffer_read_color(const struct gbuffer *gbuffer, struct exr_box *window,
                          struct tool_error *err)
{
    const struct role *role = &gbuffer->roles.kind[ROLE_COLOR];
    *window = role->info->parts[role->part].data_window;
    float *color = read_own_window(role, 4, 0.0f, err);
    if (color)
        gbuffer_complete_alpha(gbuffer, color, gbuffer_box_texels(window));
    return color;
}
