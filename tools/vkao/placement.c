/* SPDX-License-Identifier: MIT */
#include "placement.h"

#include "text.h"

#include <stdlib.h>
#include <string.h>

static bool inside(const struct exr_box *data, const struct exr_box *display)
{
    return data->x_min >= display->x_min && data->y_min >= display->y_min &&
           data->x_max <= display->x_max && data->y_max <= display->y_max;
}

/* Replaces *image by a copy with zeros on the left and on top. */
static bool pad(float **image, const struct gbuffer *g, const struct placement *p,
                size_t components, struct tool_error *err)
{
    size_t width = (size_t)g->width + p->left, height = (size_t)g->height + p->top, texels, count;
    if (!*image)
        return true;
    float *padded = NULL;
    if (size_multiply(width, height, &texels) && size_multiply(texels, components, &count))
        padded = calloc(count, sizeof *padded);
    if (!padded)
        return fail(err, EXIT_MEMORY, "out of memory for %zu x %zu texels", width, height);
    for (size_t row = 0; row < g->height; row++)
        memcpy(padded + ((row + p->top) * width + p->left) * components,
               *image + row * g->width * components, g->width * components * sizeof *padded);
    free(*image);
    *image = padded;
    return true;
}

static void crop(float *image, const struct gbuffer *g, const struct placement *p,
                 size_t components)
{
    size_t width = (size_t)g->width + p->left;
    for (size_t row = 0; image && row < g->height; row++)
        memmove(image + row * g->width * components,
                image + ((row + p->top) * width + p->left) * components,
                g->width * components * sizeof *image);
}

bool placement_expand(struct gbuffer *gbuffer, struct placement *placement, struct tool_error *err)
{
    struct gbuffer *g = gbuffer;
    *placement = (struct placement){0};
    if (!inside(&g->data_window, &g->display_window))
        return true;
    placement->left = (uint32_t)(g->data_window.x_min - g->display_window.x_min);
    placement->top = (uint32_t)(g->data_window.y_min - g->display_window.y_min);
    if (placement->left == 0 && placement->top == 0)
        return true;
    if (!pad(&g->depth, g, placement, 1, err) || !pad(&g->normals, g, placement, 4, err) ||
        !pad(&g->color, g, placement, 4, err))
        return false;
    g->view.valid = (VkRect2D){
        .offset = {(int32_t)placement->left, (int32_t)placement->top},
        .extent = {g->width, g->height},
    };
    g->view.viewport.offset.x += (int32_t)placement->left;
    g->view.viewport.offset.y += (int32_t)placement->top;
    return true;
}

void placement_crop(const struct placement *placement, struct gbuffer *gbuffer,
                    struct ao_result *result)
{
    if (placement->left == 0 && placement->top == 0)
        return;
    crop(result->ao, gbuffer, placement, 1);
    crop(result->output, gbuffer, placement, 4);
    crop(result->bent, gbuffer, placement, 4);
    crop(gbuffer->color, gbuffer, placement, 4);
}
