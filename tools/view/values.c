/* SPDX-License-Identifier: MIT */
#include "values.h"

#include "light.h"

#include <stdlib.h>
#include <string.h>

void *download_image(struct gpu *gpu, const struct gpu_image *image, struct tool_error *err)
{
    struct gpu_image from = *image;
    uint64_t bytes =
        (uint64_t)from.extent.width * from.extent.height * gpu_format_bytes(from.format);
    void *values = malloc((size_t)bytes);
    if (!values) {
        fail(err, EXIT_MEMORY, "out of memory for a picture");
        return NULL;
    }
    if (gpu_image_download(gpu, &from, values, bytes, err))
        return values;
    free(values);
    return NULL;
}

const struct computation *last_result(const struct viewer *viewer, enum side side)
{
    /* The frame in flight before the one that comes next. */
    uint32_t last = (viewer->swapchain.frame + FRAMES_IN_FLIGHT - 1) % FRAMES_IN_FLIGHT;
    return &viewer->results[side][viewer->live ? last : 0];
}

static bool take_results(struct gpu *gpu, const struct computation *c, struct ao_result *result,
                         struct tool_error *err)
{
    result->ao = download_image(gpu, &c->ao, err);
    if (result->ao && c->shape.composite)
        result->output = download_image(gpu, &c->output, err);
    if (result->ao && c->shape.bent && err->code == EXIT_OK)
        result->bent = download_image(gpu, &c->bent, err);
    return err->code == EXIT_OK;
}

/* A copy of four floats a texel; NULL of NULL, and on errors. */
static float *copy_image(const float *image, size_t texels, struct tool_error *err)
{
    float *copy = image ? malloc(texels * 4 * sizeof *copy) : NULL;
    if (copy)
        memcpy(copy, image, texels * 4 * sizeof *copy);
    else if (image)
        fail(err, EXIT_MEMORY, "out of memory for a picture");
    return copy;
}

/* The rendered part of rows of `components` floats, in place. */
static void crop_rows(float *values, uint32_t from_width, uint32_t width, uint32_t height,
                      size_t components)
{
    for (size_t y = 0; values && y < height; y++)
        memmove(values + y * width * components, values + y * from_width * components,
                width * components * sizeof *values);
}

bool values_take(struct viewer *viewer, enum side side, struct rendered_view *r,
                 struct tool_error *err)
{
    struct viewer *v = viewer;
    const struct computation *c = last_result(v, side);
    const VkExtent2D extent = c->ao.extent;
    struct gbuffer *g = &r->gbuffer;
    memset(r, 0, sizeof *r);
    if (v->live) {
        const uint32_t last = (v->swapchain.frame + FRAMES_IN_FLIGHT - 1) % FRAMES_IN_FLIGHT;
        g->width = v->live->shown_used[last].width;
        g->height = v->live->shown_used[last].height;
        if (!take_results(&v->gpu, c, &r->result, err))
            return false;
        crop_rows(r->result.ao, extent.width, g->width, g->height, 1);
        crop_rows(r->result.output, extent.width, g->width, g->height, 4);
        crop_rows(r->result.bent, extent.width, g->width, g->height, 4);
        return true;
    }
    /* Cropping changes the colour, and so does its alpha, which goes into files. */
    const struct gbuffer *file = &v->source.now.gbuffer;
    const size_t texels = (size_t)extent.width * extent.height;
    *g = *file;
    g->color = copy_image(file->color, texels, err);
    g->specular = copy_image(file->specular, texels, err);
    if (err->code || !take_results(&v->gpu, c, &r->result, err))
        return false;
    placement_crop(&v->source.now.placement, g, &r->result);
    /* Only a composite with the colour in it has lost light. */
    struct ao_result finished = r->result;
    if (c->shape.effect.composite_mode != VKAO_COMPOSITE_MULTIPLY || v->view != VIEW_COMPOSITE)
        finished.output = NULL;
    light_finish(g, &finished);
    return true;
}

void values_free(struct rendered_view *r)
{
    free(r->gbuffer.color);
    free(r->gbuffer.specular);
    r->gbuffer.color = r->gbuffer.specular = NULL;
    ao_result_free(&r->result);
}

void values_color(const struct viewer *viewer, const struct tone *tone,
                  const struct rendered_view *r, size_t texel, double color[3])
{
    const bool is_ao = tone->mode == DISPLAY_AO || tone->mode == DISPLAY_DIFFERENCE;
    const float *reference = viewer->source.now.reference_values;
    const float ao[3] = {r->result.ao[texel], 0, 0};
    const float *value = is_ao || !r->result.output ? ao : r->result.output + texel * 4;
    tone_color(tone, value, reference ? (double)reference[texel] : 0.0, color);
}
