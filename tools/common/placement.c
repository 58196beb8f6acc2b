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

/* The noise repeats after 4 columns, and after 820 rows all but: 820 steps of 1/g, g being the
 * plastic number, are 619 turns less .0003. At half resolution a texel is two. */
enum { NOISE_COLUMNS = 2 * 4, NOISE_ROWS = 2 * 820 };

struct placement placement_of(const struct exr_box *data, const struct exr_box *display)
{
    if (!inside(data, display))
        return (struct placement){0, 0};
    return (struct placement){
        .left = (uint32_t)(((int64_t)data->x_min - display->x_min) % NOISE_COLUMNS),
        .top = (uint32_t)(((int64_t)data->y_min - display->y_min) % NOISE_ROWS),
    };
}

/* Replaces *image by a copy with the value on the left and on top. */
static bool pad(float **image, const struct gbuffer *g, const struct placement *p,
                size_t components, float value, struct tool_error *err)
{
    size_t width = (size_t)g->width + p->left, height = (size_t)g->height + p->top, texels, count;
    if (!*image)
        return true;
    float *padded = NULL;
    if (size_multiply(width, height, &texels) && size_multiply(texels, components, &count))
        padded = calloc(count, sizeof *padded);
    if (!padded)
        return fail(err, EXIT_MEMORY, "out of memory for %zu x %zu texels", width, height);
    for (size_t i = 0; value > 0 && i < count; i++)
        padded[i] = value;
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
    *placement = placement_of(&g->data_window, &g->display_window);
    if (placement->left == 0 && placement->top == 0)
        return true;
    if (!pad(&g->depth, g, placement, 1, g->background_depth, err) ||
        !pad(&g->normals, g, placement, 4, 0.0f, err) ||
        !pad(&g->thickness, g, placement, 1, 0.0f, err) ||
        !pad(&g->second_depth, g, placement, 1, g->background_depth, err) ||
        !pad(&g->color, g, placement, 4, 0.0f, err) ||
        !pad(&g->albedo, g, placement, 4, 0.0f, err) ||
        !pad(&g->specular, g, placement, 4, 0.0f, err))
        return false;
    /* Half resolution wants to begin at even texels: a column and a row of background do no
     * harm. */
    const uint32_t odd_x = placement->left % 2, odd_y = placement->top % 2;
    g->view.valid = (VkRect2D){
        .offset = {(int32_t)(placement->left - odd_x), (int32_t)(placement->top - odd_y)},
        .extent = {g->width + odd_x, g->height + odd_y},
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
    crop(gbuffer->specular, gbuffer, placement, 4);
}

/* Puts an image of the data window into one of the window. */
static void paste(float *wide, const struct exr_box *window, const float *image,
                  const struct gbuffer *g)
{
    const struct exr_box *from = &g->data_window;
    const int64_t width = (int64_t)window->x_max - window->x_min + 1;
    const int64_t left = from->x_min > window->x_min ? from->x_min : window->x_min;
    const int64_t right = from->x_max < window->x_max ? from->x_max : window->x_max;
    for (int64_t y = from->y_min; left <= right && y <= from->y_max; y++)
        if (y >= window->y_min && y <= window->y_max)
            memcpy(wide + ((y - window->y_min) * width + left - window->x_min) * 4,
                   image + ((y - from->y_min) * g->width + left - from->x_min) * 4,
                   (size_t)(right - left + 1) * 4 * sizeof *wide);
}

/* Replaces *image by one of the window, which is base or, without it, 0 where *image does not
 * reach. */
static bool widen(float **image, const struct exr_box *window, size_t texels, const float *base,
                  const struct gbuffer *g, struct tool_error *err)
{
    size_t count;
    if (!*image)
        return true;
    float *wide = size_multiply(texels, 4, &count) ? calloc(count, sizeof *wide) : NULL;
    if (!wide)
        return fail(err, EXIT_MEMORY, "out of memory for %zu texels", texels);
    if (base)
        memcpy(wide, base, count * sizeof *wide);
    paste(wide, window, *image, g);
    free(*image);
    *image = wide;
    return true;
}

bool placement_widen(struct gbuffer *gbuffer, struct ao_result *result, struct tool_error *err)
{
    struct gbuffer *g = gbuffer;
    const struct role *role = &g->roles.kind[ROLE_COLOR];
    const struct exr_box *own = g->color ? &role->info->parts[role->part].data_window : NULL;
    struct exr_box window;
    if (!own || memcmp(own, &g->data_window, sizeof *own) == 0)
        return true;
    float *color = gbuffer_read_color(g, &window, err);
    const size_t texels = (size_t)((int64_t)window.x_max - window.x_min + 1) *
                          (size_t)((int64_t)window.y_max - window.y_min + 1);
    if (!color || !widen(&result->output, &window, texels, color, g, err) ||
        !widen(&result->bent, &window, texels, NULL, g, err)) {
        free(color);
        return false;
    }
    free(g->color);
    g->color = color;
    g->color_window = window;
    return true;
}
